// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Every option of a run, grouped by the part that owns it.
#pragma once

#include "edged/core/config.hpp"
#include "edged/pipeline/packetizer.hpp"

namespace edged {

struct OdometryConfig {
  PacketizerConfig packets;
  // events (warp), frontend (detector, tracker, ransac, keyframes), estimator follow as their parts land

  void visit(ConfigFields& fields);
};

}  // namespace edged
