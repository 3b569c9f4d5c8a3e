// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Images of event counts per pixel, each over a time or a number of events.
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "edged/measurement.hpp"

namespace edged {

/// The events of one image.
struct PictureRule {
  Duration length;         ///< from one picture to the next, counted from the first event
  std::size_t events = 0;  ///< number of events per image; 0: by time
};

struct EventPicture {
  Timestamp begin, end;  ///< of its time, the sensor's clock
  std::size_t events = 0;
  cv::Mat positive, negative;  ///< events of each pixel, CV_8UC1, 255 at most
};

/// Cuts a stream of events into pictures. A time without events has no image.
class EventPictures {
 public:
  /// binning: side length of the square of sensor pixels that form one image pixel.
  EventPictures(cv::Size sensor, int binning, const PictureRule& rule);

  using Show = std::function<void(const EventPicture&)>;
  /// Passes on complete images. Throws InputError for an event outside the sensor.
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

/// CV_8UC3 on white: more events are darker. Polarity: blue for mostly positive events, red for negative ones; Counts:
/// grey.
cv::Mat draw_event_picture(const EventPicture& picture, PictureStyle style);

}  // namespace edged
