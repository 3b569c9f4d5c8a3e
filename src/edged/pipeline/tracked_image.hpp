// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What vision has made of one camera's part of a packet, as a value.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "edged/rig.hpp"
#include "edged/track.hpp"

namespace edged {

struct TrackedImage {
  std::string camera;
  CameraModel model;               ///< of the image: the ideal pinhole for undistorted event frames
  cv::Mat image = {};              ///< that features were tracked on; empty: the packet has brought none of this camera
  std::vector<Track> tracks = {};  ///< the live ones by id, in the newest image
  double survival_rate = 1.0;      ///< share of tracks that live through an image, 0 .. 1

  /// Tracks as they count: as many as are likely to be there in the next image.
  double carried() const { return survival_rate * static_cast<double>(tracks.size()); }
};

}  // namespace edged
