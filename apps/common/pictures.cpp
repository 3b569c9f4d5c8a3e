// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/pictures.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "edged/io/parse/image_codec.hpp"

namespace edged {
namespace {

constexpr int kQuality = 70;  // of JPEG
const cv::Scalar kTrackColour(60, 200, 60), kNewTrackColour(60, 160, 255);

}  // namespace

std::vector<unsigned char> track_picture(const cv::Mat& image, const std::vector<Track>& tracks, int widest_px) {
  const double scale = std::min(1.0, static_cast<double>(widest_px) / image.cols);
  cv::Mat sized, colour;
  cv::resize(image, sized, {}, scale, scale, cv::INTER_AREA);
  if (sized.depth() != CV_8U) sized.convertTo(sized, CV_8U, 1.0 / 256.0);
  if (sized.channels() == 1) {
    cv::cvtColor(sized, colour, cv::COLOR_GRAY2BGR);
  } else {
    colour = sized.clone();
  }
  for (const Track& track : tracks) {
    const cv::Point2d now(scale * track.pixel.x(), scale * track.pixel.y());
    const cv::Point2d before(scale * track.previous_pixel.x(), scale * track.previous_pixel.y());
    const cv::Scalar& ink = track.age > 5 ? kTrackColour : kNewTrackColour;
    if (track.age > 0) cv::line(colour, before, now, ink, 1, cv::LINE_AA);
    cv::circle(colour, now, 2, ink, 1, cv::LINE_AA);
  }
  return encode_jpeg(colour, kQuality);
}

}  // namespace edged
