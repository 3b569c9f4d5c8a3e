// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Images of a lens as its ideal pinhole would show them.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/rig.hpp"

namespace edged {

class Rectifier {
 public:
  Rectifier(const CameraModel& lens, const CameraModel& pinhole);

  /// CV_8UC1 of the size of the lens.
  cv::Mat operator()(const cv::Mat& image) const;
  const CameraModel& lens() const { return lens_; }

 private:
  CameraModel lens_;
  cv::Mat from_;  // CV_32FC2: for each pixel of the pinhole that of the lens
};

}  // namespace edged
