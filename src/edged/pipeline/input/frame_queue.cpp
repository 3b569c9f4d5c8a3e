// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/frame_queue.hpp"

#include <algorithm>
#include <utility>

#include "edged/pipeline/tuning.hpp"

namespace edged {

FrameQueue::FrameQueue(const Rig& cameras) {
  for (const RigCamera& camera : cameras.cameras) {
    if (camera.modality == Modality::Frames) cameras_.push_back({camera.name, camera.time_offset});
  }
  if (cameras_.size() > 1) wait_ = kPipelineTuning.synchronized;
}

std::optional<Duration> FrameQueue::offset(const std::string& camera) const {
  const auto found = std::ranges::find(cameras_, camera, &Camera::name);
  return found == cameras_.end() ? std::nullopt : std::optional(found->offset);
}

bool FrameQueue::add(Frame frame, Timestamp last_cut) {
  Camera& camera = *std::ranges::find(cameras_, frame.camera, &Camera::name);
  if (frame.t <= std::max(last_cut, camera.newest.value_or(last_cut))) return false;
  camera.newest = frame.t;
  const auto after = std::ranges::upper_bound(frames_, frame.t, {}, &Frame::t);
  frames_.insert(after, std::move(frame));
  return true;
}

Timestamp FrameQueue::yield(Timestamp t, Duration spacing) const {
  if (!frames_.empty()) return first() - t < spacing ? std::max(t, first()) : t;
  for (const Camera& camera : cameras_) {
    if (!camera.expected) continue;
    const Timestamp given_up = *camera.expected + camera.period / 10;
    if (t > *camera.expected - spacing && t < given_up) t = given_up;
  }
  return t;
}

void FrameQueue::take(Packet& packet) {
  while (!frames_.empty() && first() <= packet.t + wait_) {
    const Timestamp t = first();
    Camera& camera = *std::ranges::find(cameras_, frames_.front().camera, &Camera::name);
    if (camera.cut >= packet.t) return;  // has a frame already: this one cuts the next packet
    if (camera.cut) {
      camera.period = t - *camera.cut;
      camera.expected.reset();
      if (camera.period <= kPipelineTuning.max_frame_period) camera.expected = t + camera.period;
    }
    camera.cut = t;
    packet.frames.push_back(std::move(frames_.front()));
    frames_.pop_front();
  }
}

}  // namespace edged
