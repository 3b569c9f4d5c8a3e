// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "kind_numbers.hpp"

namespace edged {

KindNumbers numbers_of(const Step& step, Modality modality) {
  KindNumbers numbers;
  double survival_rate = 0.0;
  int cameras = 0;
  for (const CameraStep& camera : step.cameras) {
    if (camera.modality != modality) continue;
    numbers.tracks += camera.tracks.size();
    numbers.event_rate_hz += camera.event_rate_hz;
    survival_rate += camera.survival_rate;
    ++cameras;
  }
  if (cameras > 0) numbers.survival_rate = survival_rate / cameras;
  return numbers;
}

}  // namespace edged
