// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the tables of a run say of all event cameras together, or of all frame cameras.
#pragma once

#include <cstddef>
#include <optional>

#include "edged/step.hpp"

namespace edged {

struct KindNumbers {
  std::size_t tracks = 0;               ///< of all cameras
  std::optional<double> survival_rate;  ///< the mean; nothing where the run has no such camera
  double event_rate_hz = 0.0;           ///< of all cameras
};

KindNumbers numbers_of(const Step& step, Modality modality);

}  // namespace edged
