// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One packet through vision and localization: the paper's data flow.
#pragma once

#include "edged/pipeline/input/packet.hpp"
#include "edged/pipeline/localization/localization.hpp"
#include "edged/pipeline/vision/vision.hpp"
#include "edged/step.hpp"

namespace edged {

/// The step of a packet, with the cameras as vision describes them, but without the rig.
Step process_packet(Packet packet, Localization& localization, Vision& vision);

}  // namespace edged
