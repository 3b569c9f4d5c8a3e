// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How the images have moved over a short window: what distinguishes rest, dynamic objects and motion of the body.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/time.hpp"

namespace edged {

class ImageMotion {
 public:
  explicit ImageMotion(double window_s) : window_s_(window_s) {}

  /// The features of a packet at t, and whether its events are no more than noise. Packets come in time order.
  void add(Timestamp t, const std::vector<CameraObservations>& observations, bool events_quiet);

  /// Features that were followed over the window, or half of it.
  std::size_t features() { return travels().size(); }
  /// Median length of their ways over the window, on the unit plane [rad]; nothing with too few features.
  std::optional<double> median_travel();
  /// The mean way of the half of the features that agree best: noise cancels in it, a slow motion does not.
  struct Common {
    double travel = 0.0, sigma = 0.0;  ///< [rad] its length; by the scatter of these features
  };
  Common common_travel();
  /// Whether nearly all features move alike: so they do in uniform motion, which an IMU cannot measure; on dynamic
  /// objects seldom.
  bool glides();
  /// Whether there were no events but noise in the whole window.
  bool events_quiet() const;

 private:
  struct View {
    Timestamp t;
    std::map<std::string, std::map<FeatureId, Eigen::Vector2d>> points;  ///< of each camera
    bool events_quiet = false;
  };
  /// Ways of the features over the window, on the unit plane.
  const std::vector<Eigen::Vector2d>& travels();

  double window_s_;
  std::deque<View> views_;                               ///< one of them at or before the begin of the window
  std::optional<std::vector<Eigen::Vector2d>> travels_;  ///< of these views, where they have been asked for
};

}  // namespace edged
