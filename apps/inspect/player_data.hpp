// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the page of `edged show` plays: pictures and frames, as many as a bounded page holds, evenly over the whole.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "edged/measurement.hpp"
#include "inspect/event_pictures.hpp"

namespace edged {

class PlayerData {
 public:
  /// limit_bytes: of all pictures, as text in the page. Beyond, every second one goes.
  explicit PlayerData(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// The newest frame stands beside the pictures that follow.
  void add(const Frame& frame);
  void add(const EventPicture& picture);

  std::size_t pictures() const { return shots_.size(); }
  /// How many pictures there would have been for one that is kept.
  std::size_t every() const { return every_; }

  /// Times [s] since the first picture; frames once each, pictures name theirs by its index.
  nlohmann::ordered_json to_json() const;

 private:
  struct Still {
    Timestamp t;
    std::vector<unsigned char> jpeg;
  };
  struct Shot {
    Timestamp begin, end;
    std::size_t events;
    std::vector<unsigned char> png;      ///< grey: positive counts above the negative ones
    std::shared_ptr<const Still> frame;  ///< null where none has come
  };

  /// What a shot takes in the page, its frame where that is another than the one before.
  static std::size_t bytes_of(const Shot& shot, const Still* before);
  void thin_out();

  std::size_t limit_bytes_, bytes_ = 0;
  std::size_t seen_ = 0, every_ = 1;
  std::vector<Shot> shots_;
  Frame newest_frame_;  ///< without an image: it is in still_, or there is none
  std::shared_ptr<const Still> still_;
};

}  // namespace edged
