// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the stamps of estimate and ground truth differ by a constant.
#pragma once

#include "edged/eval/association.hpp"

namespace edged {

struct TimeOffset {
  double offset_s = 0.0;     ///< that fits best: t_truth = t_estimate + offset
  double ate_rmse_m = 0.0;   ///< with it, after SE(3) alignment
  double ate_given_m = 0.0;  ///< without it
  double compared_s = 0.0;   ///< time in which both have poses
  double spread_s = 0.0;     ///< largest difference of the offsets of three equal pieces that move

  /// Whether the stamps are what is wrong: by milliseconds any estimate fits better somewhere else, by more where it
  /// drifts, as pieces of it then show, or where it is so short that its errors fit an offset by chance.
  bool matters() const;
};

/// Offsets of up to half a second are tried. Zeros where nothing can be compared.
TimeOffset fit_time_offset(const Trajectory& truth, const Trajectory& estimate,
                           Duration max_gap = duration_from_seconds(kDefaultMaxGap_s));

}  // namespace edged
