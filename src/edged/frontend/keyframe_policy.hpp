// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When an instant becomes a keyframe: a pure function of the changes since the last one.
#pragma once

#include <string>
#include <vector>

#include "edged/options/frontend.hpp"
#include "edged/time.hpp"

namespace edged {

/// The tracks of one camera since the last keyframe.
struct KeyframeTracks {
  int at_keyframe = 0;               ///< number of tracks at the keyframe
  std::vector<double> parallax_rad;  ///< of each live track, after rotation compensation

  int alive() const { return static_cast<int>(parallax_rad.size()); }
};

struct SinceKeyframe {
  bool any = false;  ///< false: there is no keyframe yet
  Duration time{0};
  double rotation_rad = 0.0;  ///< angle between the camera's attitude then and now
  KeyframeTracks tracks;
};

enum class KeyframeReason { None, First, FewTracks, Parallax, Rotation, Time };

/// Why the present instant should become a keyframe, or None. The first rule that holds is named, in the order of the
/// enumeration; before min_interval_s only First can hold.
KeyframeReason keyframe_reason(const SinceKeyframe& since, const KeyframeConfig& config);

std::string to_string(KeyframeReason reason);

}  // namespace edged
