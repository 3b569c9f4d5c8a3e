// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_statistics.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "edged/core/angles.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

rusage usage() {
  rusage u = {};
  getrusage(RUSAGE_SELF, &u);
  return u;
}

double process_cpu_s() {
  const rusage u = usage();
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(u.ru_utime) + seconds(u.ru_stime);
}

/// The larger one of roll's and pitch's.
double tilt_sigma_deg_of(const Attitude& attitude) {
  const Eigen::Matrix3d R = attitude.R_W_B.toRotationMatrix(), P_W = R * attitude.covariance * R.transpose();
  return kDegreesPerRadian * std::sqrt(std::max(P_W(0, 0), P_W(1, 1)));
}

}  // namespace

void RunStatistics::add_visual(Timestamp first, Timestamp last) {
  if (!first_visual_) {
    first_visual_ = first;
    last_visual_ = last;
  }
  last_visual_ = std::max(last_visual_, last);
}

void RunStatistics::add_visual(const Measurement& measurement, const Rig& used) {
  const std::optional<Timestamp> first = first_stamp(measurement);
  const std::string* name = camera_of(measurement);
  if (!first || !name) return;
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) used_.events += batch->events.size();
  if (std::holds_alternative<Frame>(measurement)) ++used_.frames;
  const auto camera = std::ranges::find(used.cameras, *name, &RigCamera::name);
  if (camera != used.cameras.end())
    add_visual(*first + camera->time_offset, *last_stamp(measurement) + camera->time_offset);
}

void RunStatistics::add(const Step& step) {
  ++packets_;
  if (is_tracking(step.status)) ++poses_;
  if (step.keyframe) ++keyframes_;
  if (step.loop_closure) ++loops_closed_;
  if (step.status == TrackingStatus::Lost && last_status_ != TrackingStatus::Lost) ++times_lost_;
  if (step.contradicted && last_status_ != TrackingStatus::Lost) ++times_contradicted_;
  last_status_ = step.status;
  ln_depth_scale_ = step.ln_depth_scale;
  if (is_tracking(step.status)) accel_bias_ = step.state.bias_accel;
  if (is_tracking(step.status) && step.covariance) scale_.add(step.t, step.state.v_W, step.covariance->velocity);
  if (!step.waiting_for.empty()) waiting_for_ = step.waiting_for;
  if (!step.lost_because.empty()) lost_because_ = step.lost_because;
  tilt_sigma_deg_ = step.attitude ? std::optional(tilt_sigma_deg_of(*step.attitude)) : std::nullopt;
  const Timestamp begin = first_visual_.value_or(step.t);
  seconds_[static_cast<std::size_t>(step.status)] += std::max(0.0, to_seconds(step.t - last_packet_.value_or(begin)));
  last_packet_ = step.t;
  if (step.status == TrackingStatus::Good && !first_good_s_) first_good_s_ = to_seconds(step.t - begin);
}

double RunStatistics::visual_span_s() const { return first_visual_ ? to_seconds(last_visual_ - *first_visual_) : 0.0; }

RunStatistics::Overload RunStatistics::overload() const {
  const auto share = [](std::size_t dropped, std::size_t used) {
    return dropped == 0 ? 0.0 : static_cast<double>(dropped) / static_cast<double>(dropped + used);
  };
  const double events = share(dropped_.events, used_.events), frames = share(dropped_.frames, used_.frames);
  const double most = std::max(events, frames);
  const bool by_reading = events >= frames && dropped_.unread > dropped_.events / 2;
  return {most, by_reading,
          fmt::format("{:.0f} % of the {} dropped{}", 100.0 * most, frames > events ? "frames" : "events",
                      by_reading ? ", as reading is too slow" : "")};
}

double RunStatistics::coverage() const {
  const double span = visual_span_s();
  return span > 0.0 ? std::min(1.0, time_in_s(TrackingStatus::Good) / span) : 0.0;
}

double RunStatistics::lost_share() const {
  const double since = visual_span_s() - first_good_s_.value_or(0.0);
  return first_good_s_ && since > 0.0 ? std::min(1.0, time_in_s(TrackingStatus::Lost) / since) : 0.0;
}

ResourceMeter::ResourceMeter() : wall_(std::chrono::steady_clock::now()), cpu_s_(process_cpu_s()) {}

double ResourceMeter::wall_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count() - paused_wall_s_;
}

double ResourceMeter::cpu_s() const { return process_cpu_s() - cpu_s_ - paused_cpu_s_; }

double ResourceMeter::peak_rss_mb() { return static_cast<double>(usage().ru_maxrss) / 1024.0; }

}  // namespace edged
