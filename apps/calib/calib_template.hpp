// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib --new`: a calibration to fill in, with what is known of a camera.
#pragma once

#include <string>
#include <vector>

namespace edged {

/// Cameras of which there is a template.
std::vector<std::string> template_names();

std::string calibration_template(const std::string& camera);

}  // namespace edged
