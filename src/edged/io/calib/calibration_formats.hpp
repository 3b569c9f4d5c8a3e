// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration formats behind load_calibration. Internal to io.
#pragma once

#include "edged/io/calibration.hpp"
#include "edged/io/calib/yaml_reader.hpp"

namespace edged {

Calibration read_own_yaml(const YamlReader& root);
Calibration read_kalibr(const YamlReader& root);
/// file: a sensor.yaml of a camera; imu0/sensor.yaml is looked for two folders up.
Calibration read_euroc(const SourcePath& file);
Calibration read_ecd_calib(const SourcePath& file);

/// Noise keys of EuRoC and Kalibr, which agree; also below `imu0`.
ImuNoise read_kalibr_noise(const YamlReader& root);

}  // namespace edged
