// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Options of the frontend: corners, optical flow, outlier rejection, keyframes, low-light normalization.
#pragma once

#include "edged/config.hpp"

namespace edged {

enum class CornerKind {
  /// FAST-9 candidates ranked by the Harris score: the detector of ORB (Rublee et al., 2011), so there is no kind Orb
  /// beside it. What ORB adds are scales (DetectorConfig::levels), a cut to the strongest of the whole image, which
  /// would come before the grid and defeat it, and descriptors, which tracking by optical flow does not use.
  FastHarris,
  Fast,       ///< FAST-9 ranked by its own score: the detector of USLAM
  ShiTomasi,  ///< local maxima of the smaller eigenvalue of the structure tensor (Shi and Tomasi, 1994)
};

struct DetectorConfig {
  CornerKind corners = CornerKind::FastHarris;
  int max_features = 120;
  double cell_px = 20.0;
  int levels = 1;  ///< scales the corners are found at, each 1.2 times coarser than the one before (as in ORB)
  double separation_px = 8.0;
  int border_px = 8;
  int fast_threshold = 20;
  int fast_threshold_low = 8;
  double min_gradient = 2.0;
  bool subpixel = false;

  void visit(ConfigFields& fields);
};

struct KltConfig {
  int window_px = 11;
  int levels = 3;
  double min_gradient = 1.0;

  void visit(ConfigFields& fields);
};

struct OutlierConfig {
  double threshold_px = 2.0;
  double rotation_only_px = 1.0;
  double rotation_gate_px = 6.0;

  void visit(ConfigFields& fields);
};

/// When a patch in an image matches the stored one.
struct PatchConfig {
  double min_similarity = 0.8;  ///< normalised cross correlation
  void visit(ConfigFields& fields);
};

/// The reference patch of a corner, which images are aligned to.
struct ReferencePatchConfig {
  bool enabled = true;
  PatchConfig patch;

  void visit(ConfigFields& fields);
};

/// Landmarks that several cameras share.
struct StereoConfig {
  bool enabled = true;
  double max_epipolar_px = 2.0;  ///< on the axis of the lens

  void visit(ConfigFields& fields);
};

/// How features are found in the next image: a row of frontend/tracker_table.cpp each.
enum class TrackerKind {
  Klt,          ///< optical flow, and alignment to reference patches
  Descriptors,  ///< ORB descriptors of corners near the predicted position
};

struct TrackerConfig {
  TrackerKind kind = TrackerKind::Klt;
  DetectorConfig detector;
  KltConfig klt;
  OutlierConfig outliers;
  ReferencePatchConfig reference_patches;
  double forward_backward_px = 1.0;
  // The appearance of an event frame depends on the motion: at 0.7 its tracks last a third as long.
  double min_correlation = 0.3;
  double merge_px = 3.0;
  double sigma_px = 1.0;

  void visit(ConfigFields& fields);
};

struct KeyframeConfig {
  double min_tracked_share = 0.6;
  double parallax_deg = 1.5;
  double rotation_deg = 10.0;
  int min_tracks = 15;
  double max_interval_s = 0.5;

  void visit(ConfigFields& fields);
};

struct LowLightConfig {
  double below_range = 80.0;  ///< images with fewer grey levels between dark and bright quantiles are stretched
  void visit(ConfigFields& fields);
};

}  // namespace edged
