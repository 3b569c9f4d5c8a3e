// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of event frames: how events are warped, rendered and enhanced.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "edged/config.hpp"

namespace edged {

/// How the camera's pose is read between the knots of a CameraMotion.
enum class WarpInterpolation {
  None,         ///< the camera stands still: events are only undistorted
  SingleTwist,  ///< one constant twist from the first knot to the last (paper Eq. 1)
  Piecewise,    ///< a constant twist per pair of neighbouring knots
};

/// The d_i of Eq. 2.
enum class EventDepth {
  Scene,      ///< one depth for all events
  Landmarks,  ///< per event that of the nearest landmark
};

struct EventFrameConfig {
  WarpInterpolation interpolation = WarpInterpolation::Piecewise;
  double saturation_events = 4.0;  ///< b_max: this many events on one pixel (before the blur) are white
  EventDepth depth = EventDepth::Landmarks;
  double blur_sigma_px = 0.8;  ///< Gaussian on the sum, before the scaling; 0: none

  void visit(ConfigFields& fields);
};

/// I_edge of Algorithm 1.
enum class EdgeMethod {
  None,       ///< no enhancement at all: the event frame passes unchanged
  Clahe,      ///< I_edge = I_enh, the equalised frame itself (the paper tests it, its algorithm leaves it out)
  Canny,      ///< one pixel wide, 0 or 255
  Laplacian,  ///< magnitude of the second derivative, four neighbours
  Sobel,      ///< magnitude of the slope, 3x3
  Scharr,     ///< as Sobel, with a kernel of better rotational symmetry
};

enum class Sharpening {
  None,
  Paper,    ///< I_clahe + lambda (I_clahe - I_blur): amplifies what the equalisation did, not the detail
  Unsharp,  ///< I_clahe + lambda (I_clahe - G * I_clahe): unsharp masking
};

enum class MagnitudeNorm {
  L2,  ///< sqrt(gx^2 + gy^2): the same for edges of every direction
  L1,  ///< |gx| + |gy|: up to 1.41 times stronger on diagonals
};

struct EnhanceConfig {
  EdgeMethod method = EdgeMethod::None;
  double blur_sigma_px = 0.8;
  double clahe_clip = 2.0;
  Sharpening sharpening = Sharpening::None;
  double sharpen_lambda = 0.5;
  double edge_gain = 2.0;
  MagnitudeNorm norm = MagnitudeNorm::L2;
  double canny_low = 8.0;
  double canny_high = 20.0;
  int erosion_px = 0;
  double event_weight = 0.7;  ///< alpha of Algorithm 1
  double edge_weight = 0.3;   ///< beta

  void visit(ConfigFields& fields);

  /// Throws InputError with the reason when options contradict each other. key: of an option, by its name.
  void validate(const std::function<std::string(std::string_view)>& key) const;
};

}  // namespace edged
