// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "inspect/player_data.hpp"

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <utility>

#include "common/even_sample.hpp"
#include "common/json_text.hpp"
#include "common/pictures.hpp"
#include "edged/io/parse/image_codec.hpp"

namespace edged {
namespace {

constexpr int kWidestFrame_px = 400;
constexpr std::size_t kBesides_bytes = 100;  // times, count and names, of a picture

std::size_t text_size(const std::vector<unsigned char>& bytes) { return (bytes.size() + 2) / 3 * 4; }

}  // namespace

void PlayerData::add(const Frame& frame) { newest_frame_ = frame; }

void PlayerData::add(const EventPicture& picture) {
  if (seen_++ % every_ != 0) return;
  if (!newest_frame_.image.empty()) {
    still_ =
        std::make_shared<const Still>(Still{newest_frame_.t, track_picture(newest_frame_.image, {}, kWidestFrame_px)});
    newest_frame_.image.release();
  }
  cv::Mat both;
  cv::vconcat(picture.positive, picture.negative, both);
  Shot shot{picture.begin, picture.end, picture.events, encode_png(both, 9), still_};
  bytes_ += bytes_of(shot, shots_.empty() ? nullptr : shots_.back().frame.get());
  shots_.push_back(std::move(shot));
  while (bytes_ > limit_bytes_ && shots_.size() > 1) thin_out();
}

std::size_t PlayerData::bytes_of(const Shot& shot, const Still* before) {
  const bool has_frame = shot.frame && shot.frame.get() != before;
  return kBesides_bytes + text_size(shot.png) + (has_frame ? text_size(shot.frame->jpeg) : 0);
}

void PlayerData::thin_out() {
  keep_every_second(shots_);
  every_ *= 2;
  bytes_ = 0;
  const Still* before = nullptr;
  for (const Shot& shot : shots_) bytes_ += bytes_of(shot, std::exchange(before, shot.frame.get()));
}

nlohmann::ordered_json PlayerData::to_json() const {
  using Json = nlohmann::ordered_json;
  Json json = {{"every", every_}, {"pictures", Json::array()}, {"frames", Json::array()}};
  const auto seconds = [this](Timestamp t) { return rounded(to_seconds(t - shots_.front().begin), 6); };
  const Still* before = nullptr;
  for (const Shot& shot : shots_) {
    if (shot.frame && shot.frame.get() != before)
      json["frames"].push_back({{"t", seconds(shot.frame->t)}, {"jpeg", base64(shot.frame->jpeg)}});
    before = shot.frame.get();
    json["pictures"].push_back({{"begin", seconds(shot.begin)},
                                {"t", seconds(shot.end)},
                                {"events", shot.events},
                                {"frame", static_cast<int>(json["frames"].size()) - 1},
                                {"png", base64(shot.png)}});
  }
  return json;
}

}  // namespace edged
