// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When an instant becomes a keyframe, by the changes since the last one.
#pragma once

#include <vector>

#include "edged/options/frontend.hpp"
#include "edged/time.hpp"

namespace edged {

/// The tracks of one camera since the last keyframe.
struct KeyframeTracks {
  int at_keyframe = 0;               ///< number of tracks at the keyframe
  std::vector<double> parallax_rad;  ///< one per live track, after rotation compensation

  int alive() const { return static_cast<int>(parallax_rad.size()); }
};

struct SinceKeyframe {
  bool any = false;  ///< false: there is no keyframe yet
  Duration time{0};
  double rotation_rad = 0.0;  ///< angle between the camera's attitude then and now
  KeyframeTracks tracks;
};

/// Whether the present instant should become a keyframe.
bool keyframe_due(const SinceKeyframe& since, const KeyframeConfig& config);

}  // namespace edged
