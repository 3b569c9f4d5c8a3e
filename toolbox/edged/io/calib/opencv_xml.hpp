// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Converts the xml of FileStorage in OpenCV, which DV writes, to its yaml. Internal to io.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string_view>

namespace edged {

/// True if the text begins as xml.
bool is_xml(std::string_view text);

/// Elements become keys, elements `_` become items of a list, a sequence of numbers becomes a list. Throws Damage, with
/// the line, if the text is no xml.
YAML::Node parse_opencv_xml(std::string_view text);

}  // namespace edged
