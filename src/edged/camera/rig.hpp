// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cameras around the body, addressed by name, never by index.
#pragma once

#include <string>
#include <vector>

#include "edged/camera/camera_model.hpp"
#include "edged/core/lie.hpp"
#include "edged/core/time.hpp"

namespace edged {

enum class Modality { Events, Frames };

struct RigCamera {
  std::string name;
  Modality modality = Modality::Frames;
  CameraModel model;                   ///< of the raw (distorted) image
  SE3 T_B_C;                           ///< camera frame to body: p_B = T_B_C * p_C
  Duration time_offset = Duration(0);  ///< t_imu = t_cam + time_offset
};

struct Rig {
  std::string name;
  std::vector<RigCamera> cameras;

  /// Throws InputError that lists the names there are.
  const RigCamera& camera(const std::string& camera_name) const;
  /// First camera of that kind, or null.
  const RigCamera* find(Modality modality) const;
};

}  // namespace edged
