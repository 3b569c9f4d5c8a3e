// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of the scene depth: the source of a run, and the parameters of each source.
#pragma once

#include <string>

#include "edged/config.hpp"

namespace edged {

struct DepthFilterConfig {
  double min_m = 0.15;  ///< measurements outside (min, max) are rejected; the previous estimate is kept
  double max_m = 30.0;
  double time_constant_s = 0.25;  ///< of the smoothing; 0: none
  double max_age_s = 1.0;         ///< an estimate is held that long
  double drift = 0.3;             ///< growth of sigma_ln [1/sqrt(s)]

  void visit(ConfigFields& fields);
};

struct LandmarkDepthConfig {
  static constexpr int min_landmarks = 5;  ///< in the region, for a measurement
};

/// The statistic of the depths of the region. The paper uses the mean, which a far background biases.
enum class RegionValue { Median, Mean };

struct NetworkDepthConfig {
  std::string model = "small";  ///< of config/depth, or the path of an ONNX file
  int margin_px = 16;           ///< the network sees that much more than the region on each side
  RegionValue region_value = RegionValue::Median;
  static constexpr double min_events_per_pixel = 0.05;  ///< in what the network sees, for a measurement
  double time_constant_s = 0.5;  ///< of the smoothing, in place of the filter's: best on held-out scenes

  void visit(ConfigFields& fields);
};

/// Where the network runs: within add_events, every window (the same events give the same bits), or in a thread of its
/// own, the newest window only, so that add_events never waits for it.
enum class Inference { Synchronous, OwnThread };

/// The scale s of a depth source, as ln s: a Kalman filter over one number with a prior and a slow random walk.
struct ScaleConfig {
  static constexpr double prior_sigma = 0.5;  ///< of ln s around 0
  static constexpr double walk = 0.05;        ///< random walk of ln s [1/sqrt(s)]
  static constexpr double measurement_sigma =
      0.35;  ///< of one window's ln ratio: error of the network that changes with time
};

enum class DepthSource { Constant, Landmarks, Network, Fused };

struct DepthConfig {
  DepthSource source = DepthSource::Landmarks;
  double constant_m = 2.0;
  static constexpr double constant_sigma_ln = 0.7;
  double region_share = 0.5;  ///< of each side of the image, around its middle
  DepthFilterConfig filter;
  LandmarkDepthConfig landmarks;
  NetworkDepthConfig network;
  ScaleConfig scale;

  void visit(ConfigFields& fields);
};

}  // namespace edged
