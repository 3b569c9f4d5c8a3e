// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The result of vision for one camera in a packet, as a value.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/track.hpp"

namespace edged {

struct TrackedImage {
  std::string camera;
  CameraModel
      model;  ///< lens of the image: the ideal pinhole for undistorted event frames; the map's with online calibration
  cv::Mat image = {};              ///< that features were tracked on; empty: the packet has none of this camera
  std::vector<Track> tracks = {};  ///< the live ones by id, in the newest image
  double survival_rate = 1.0;      ///< share of tracks that survive an image, 0 .. 1

  /// Effective number of tracks: the number that likely survives the next image.
  double effective_tracks() const { return survival_rate * static_cast<double>(tracks.size()); }
};

/// An image of the packet, at the pose of its camera.
struct PosedImage {
  TrackedImage image;
  SE3 T_O_C;
};

}  // namespace edged
