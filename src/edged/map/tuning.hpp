// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the map that are no options: unit, effect, and where each value comes from.
#pragma once

#include <cstddef>

#include "edged/core/angles.hpp"

namespace edged {

/// The random walk of the odometry's pose: sigmas after 1 s.
struct Drift {
  double position = 0.0;         ///< of each axis [m]
  double yaw = 0.0, tilt = 0.0;  ///< [rad]
};

/// Decisions are those of docs/decisions.
struct MapTuning {
  // Keyframes and points that are added (decision 027).
  double keyframe_interval_s = 0.3;             ///< between keyframes that the map keeps
  double max_depth_error = 0.1;                 ///< sigma of a point's inverse depth, as a share of it
  int coverage_columns = 6, coverage_rows = 4;  ///< cells of an image, by which the map's share of a view is measured

  // Keyframes and points that should be in view. Farther away, or from another side, they have another appearance.
  double max_distance = 1.5;         ///< from a keyframe [scene depths]
  double max_axis_angle_deg = 60.0;  ///< between the optical axes of a keyframe and the image
  double max_view_angle_deg = 35.0;  ///< between the rays of a point now and then
  double max_scale = 1.5;            ///< a point is at most so much nearer or farther than then
  int nearest_keyframes = 30;        ///< whose points are searched for in an image
  int cell_px = 16;                  ///< one point is searched for in each cell of an image
  double margin_px = 9.0;            ///< rim of an image without points: half a patch and its search
  int reliable_searches = 10;        ///< after these a point must have been matched in its share of them
  double min_matched_share = 0.3;
  double gate_sigmas = 3.0;    ///< bound of a prediction: of a search, and of the drift along a loop
  double min_search_px = 2.0;  ///< radius
  /// Median motion of the matched points since the last match. Patches that move less are off by the same amount again
  /// (decision 027): nothing changes from 1 to 10 px.
  double new_view_px = 3.0;

  // Places by appearance (decision 029).
  std::size_t compared_keyframes = 100;  ///< point by point; of a larger map those with most votes of the index
  double agreement_px = 3.0;             ///< between a feature and its point at the recognized pose
  std::size_t min_inliers = 8;           ///< that must agree with one pose
  double min_inlier_share = 0.3;         ///< share of the features with a similar point
  double min_ray_slope = 0.05;           ///< against the horizon, to derive a distance from a height
  double min_upright = 0.42;  ///< sine of 25 deg: of a ray against gravity, which gives its feature a direction
  double same_place_m = 0.1, same_place_rad = 0.05;  ///< sigmas of a recognized pose, or of a start after a loss
  double confirmed_m = 0.05, confirmed_rad = 0.02;   ///< sigmas of a pose on which several images agree
  std::size_t confirming = 3;  ///< images or keyframes that agree on a loop, or on the place of another map

  // Filter (decisions 027, 048, 050).
  double velocity_time_s = 0.12, gyro_bias_time_s = 4.0;  ///< for which errors of the odometry last: its drift
  int active_keyframes = 100;                             ///< time and memory grow with the square
  std::size_t parents = 3;  ///< that a deactivated keyframe depends on: with one, what it shares with others is lost
  std::size_t parent_candidates = 10;  ///< for the next parent, after the first
  double cauchy_sigmas = 2.0;          ///< scale of the robust loss of map matches
  double tilt_deg = 0.3;               ///< sigma of the odometry's roll and pitch, where it is not known
  double least_tilt_deg = 0.05;        ///< and where it is, at least: with good IMUs
  double tilt_time_s = 10.0;           ///< after which the error of the tilt is another one

  // Final trajectory (decision 028).
  Drift final_drift = {0.004, 0.4 * kDegree, 0.8 * kDegree};  ///< matches on both sides bound it
  int final_iterations = 15;                                  ///< steps of the joint optimization, at most
  double start_tilt_deg = 0.2;                                ///< sigma of the tilt between two starts
  std::size_t joint_images =
      500;  ///< matched images that are optimized with the keyframes: time grows faster than they

  // After a loss (decisions 026, 029, 045). Dead reckoning is off by at most this, and this more per second.
  double dead_reckoning_m = 0.5, dead_reckoning_mps = 0.5;
  double dead_reckoning_radps = 0.01;
  double gap_mps = 2.0, gap_radps = 1.5;    ///< the same of a gap of all sensors
  double max_turn_rad = 0.1;                ///< bound on the rotation error of the odometry at any time; grows with it
  double relocalization_interval_s = 0.09;  ///< between images, after a loss
  double max_unmatched_s = 5.0;             ///< with localize_only: in motion without a map match, until it is lost

  // Loop closure (decision 049).
  double loop_interval_s = 0.5;       ///< between images that are compared with old places
  double loop_age_s = 20.0;           ///< keyframes so old, and not matched for half of it, may close one
  double loop_drift_m = 0.3;          ///< bound on the drift of the odometry; places that far apart are two
  double loop_drift_per_path = 0.02;  ///< more of it per metre of path
  double loop_drift_radpm = 5e-4;     ///< drift of the heading per metre of drift's path
  std::size_t loop_inliers = 12;
  double loop_rival_share = 0.6;                              ///< share of the inliers that no other place may have
  double loop_step_m = 0.25, loop_gap_m = 4.0;                ///< path between two of them
  double loop_agreement_m = 0.15, loop_agreement_rad = 0.03;  ///< between two of them

  // Merging of maps (decision 030).
  double merge_share = 0.5;        ///< share of the recognized keyframes
  double same_focal_share = 0.02;  ///< difference of two calibrations of one lens
};
inline constexpr MapTuning kMapTuning;

}  // namespace edged
