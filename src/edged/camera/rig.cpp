// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/rig.hpp"

#include "edged/core/check.hpp"

namespace edged {

const RigCamera& Rig::camera(const std::string& camera_name) const {
  std::string names;
  for (const RigCamera& c : cameras) {
    if (c.name == camera_name) return c;
    names += (names.empty() ? "" : ", ") + c.name;
  }
  throw InputError::format("rig '{}' has no camera '{}'; it has: {}", name, camera_name,
                           names.empty() ? "none" : names);
}

const RigCamera* Rig::find(Modality modality) const {
  for (const RigCamera& c : cameras) {
    if (c.modality == modality) return &c;
  }
  return nullptr;
}

}  // namespace edged
