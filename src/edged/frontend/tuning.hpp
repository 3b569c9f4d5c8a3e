// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the frontend that are no options: unit, effect, and where each value comes from.
#pragma once

#include <cstddef>

namespace edged {

/// Decisions are those of docs/decisions.
struct FrontendTuning {
  // Detector.
  double reference_width_px = 240.0;    ///< width of images at which lengths in the options hold (DAVIS240)
  std::size_t candidates_per_cell = 4;  ///< where the best corner is too close to one of a neighbouring cell
  int same_corner_px = 4;

  // Optical flow.
  int flow_iterations = 20;
  double flow_step_px = 0.005;        ///< convergence
  double coarse_flow_step_px = 0.03;  ///< convergence before an alignment to a reference patch
  int predicted_top_level = 1;        ///< where a search begins near its result
  int appearance_px = 11;             ///< side length of the patches that are compared with the previous image
  double border_px = 4.0;             ///< tracks end this close to the border
  double retry_share = 0.5;           ///< share of lost tracks above which the prediction counts as wrong
  double refill_share = 0.5;          ///< share of max_features below which detection is needed

  // Descriptors, in images as wide as reference_width_px.
  double predicted_search_px = 8.0;   ///< radius around the predicted position
  double search_px = 20.0;            ///< radius around the last position, without a prediction
  double candidate_cell_px = 6.0;     ///< side of a cell with one candidate
  double max_descriptor_ratio = 0.8;  ///< of the best match over the second best (Lowe, 2004)

  // Outliers (OpenGV).
  double ransac_confidence = 0.999;
  int ransac_iterations = 100;
  std::size_t min_pairs_translation = 6;  ///< pairs for two unknowns, and twice as many for five
  double rotation_preference = 0.9;       ///< share of the inliers of a full motion at which the simpler model is taken
  double fallback_share = 0.6;            ///< share of inliers below which the gyro is not relied on
  double min_inlier_share = 0.3;          ///< below it nothing is rejected

  // Keyframes.
  double starved_interval_s = 0.2;  ///< least time between keyframes for want of tracks
  double min_interval_s = 0.05;     ///< least time between any two
  double still_parallax_deg = 0.2;  ///< below it the camera stands still, and keyframes by time are left out

  // Low light (decision 012), in grey levels.
  double dark_share = 0.02;     ///< share of the pixels at each end that do not count
  double target_range = 160.0;  ///< between both ends after the stretch
  double max_gain = 12.0;
  double smoothing_px = 1.0;       ///< sigma of the blur before it
  double hold_gain = 1.3;          ///< the gain is updated when it is off by this factor
  double hold_black_share = 0.15;  ///< and the black level by this share of the target range
  double floor = 16.0;             ///< grey level of the dark end: noise below it is not clipped

  // Reference patches (decision 011).
  double max_area_ratio = 2.5;  ///< between a patch in the image and its reference, both ways
  double min_depth_m = 0.05;
  double max_feature_shift_px = 1.0;  ///< from where flow or prediction have it: farther away it is another feature
  double event_lag_px = 0.3;          ///< events of an edge appear so far behind it: the pixel fires after the change
  double gradient_noise_px2 = 0.3;    ///< squared motion that shows as much scene as noise
  double min_explained_share = 0.5;   ///< share of a motion that earlier ones explain, to predict it

  // Stereo (decision 041).
  double stereo_step_px = 1.5;             ///< between candidates: the correlation of a feature falls within two pixels
  double stereo_nearest_m = 0.3;           ///< depth from which features of unknown depth are searched
  double stereo_depth_factor = 1.3;        ///< on a known depth, both ways
  double min_candidate_correlation = 0.5;  ///< up to half a step beside the match
  int same_candidate = 3;                  ///< [candidates] from the best one: farther away it is another place
  double max_ambiguity = 0.7;              ///< what the best match lacks over what the second best lacks
  double step_loss = 0.1;                  ///< what a perfect match may lack between two candidates
  double max_return_px = 0.5;              ///< error of a match that is followed back
};
inline constexpr FrontendTuning kFrontendTuning;

}  // namespace edged
