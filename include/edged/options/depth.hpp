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
  double time_constant_s = 0.25;  ///< memory of the smoothing; 0: none
  double max_age_s = 1.0;         ///< an estimate is held that long
  double drift = 0.3;             ///< growth of sigma_ln [1/sqrt(s)]

  void visit(ConfigFields& fields);
};

/// The statistic of the depths of the region. The paper uses the mean, which a far background biases.
enum class RegionValue { Median, Mean };

struct NetworkDepthConfig {
  std::string model = "small";  ///< a network in config/depth, or the path of an ONNX file
  int margin_px = 16;           ///< the network sees that much more than the region on each side
  RegionValue region_value = RegionValue::Median;
  double time_constant_s = 0.5;  ///< memory of the smoothing, in place of the filter's: best on held-out scenes

  void visit(ConfigFields& fields);
};

/// Where the network runs: within add_events, every window (the same events give the same bits), or in a thread of its
/// own, the newest window only, so that add_events never waits for it.
enum class Inference { Synchronous, OwnThread };

enum class DepthSource { Constant, Landmarks, Network, Fused };

struct DepthConfig {
  DepthSource source = DepthSource::Landmarks;
  double constant_m = 2.0;
  double region_share = 0.5;  ///< share of each side of the image, around its middle
  DepthFilterConfig filter;
  NetworkDepthConfig network;

  void visit(ConfigFields& fields);
};

}  // namespace edged
