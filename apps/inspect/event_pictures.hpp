// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events as they fell, counted by pixel: picture after picture, of a length of time or of a number of events.
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "edged/measurement.hpp"

namespace edged {

/// What one picture is made of.
struct PictureRule {
  Duration length;         ///< from one picture to the next, counted from the first event
  std::size_t events = 0;  ///< so many each, however long they take; 0: by length
};

struct EventPicture {
  Timestamp begin, end;  ///< of its time, the sensor's clock
  std::size_t events = 0;
  cv::Mat positive, negative;  ///< events of each pixel, CV_8UC1, 255 at most
};

/// Cuts a stream of events into pictures. A length of time without an event makes none.
class EventPictures {
 public:
  /// binning: so many pixels of the sensor, across and down, are one of the picture.
  EventPictures(cv::Size sensor, int binning, const PictureRule& rule);

  using Show = std::function<void(const EventPicture&)>;
  /// Those that are complete are shown. Throws InputError for an event outside the sensor.
  void add(std::span<const Event> events, const Show& show);
  /// The last one, if it is not empty.
  void finish(const Show& show);

 private:
  void begin_at(Timestamp t);
  void count(const Event& event);

  cv::Size sensor_;
  int binning_;
  PictureRule rule_;
  EventPicture picture_;
  std::optional<Timestamp> origin_;  ///< of the pictures of equal length
  Timestamp last_;
};

enum class PictureStyle { Polarity, Counts };

/// CV_8UC3 on white: more events give more ink. Polarity: blue where most grew brighter, red where darker; Counts:
/// grey.
cv::Mat draw_event_picture(const EventPicture& picture, PictureStyle style);

}  // namespace edged
