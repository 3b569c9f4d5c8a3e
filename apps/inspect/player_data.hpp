// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The data of the page of `edged show`: event images and frames, a bounded number, spread evenly over the recording.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "edged/measurement.hpp"
#include "inspect/event_pictures.hpp"

namespace edged {

class PlayerData {
 public:
  /// limit_bytes: of all pictures, as text in the page. Beyond it every second image is removed.
  explicit PlayerData(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// The newest frame is shown beside the following event images.
  void add(const Frame& frame);
  void add(const EventPicture& picture);

  std::size_t pictures() const { return shots_.size(); }
  /// Number of original images per kept image.
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
    std::shared_ptr<const Still> frame;  ///< null without one
  };

  /// Size of an image in the page, with its frame if that is a new one.
  static std::size_t bytes_of(const Shot& shot, const Still* before);
  void thin_out();

  std::size_t limit_bytes_, bytes_ = 0;
  std::size_t seen_ = 0, every_ = 1;
  std::vector<Shot> shots_;
  Frame newest_frame_;  ///< without an image: it is in still_, or there is none
  std::shared_ptr<const Still> still_;
};

}  // namespace edged
