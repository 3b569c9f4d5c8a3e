// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The xml of OpenCV's FileStorage, which DV writes, as the yaml that FileStorage would have written. Internal to io.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string_view>

namespace edged {

/// By its beginning.
bool is_xml(std::string_view text);

/// Elements are keys, those called `_` items of a list; numbers side by side are a list. Throws Damage with the line
/// where the text is no xml.
YAML::Node parse_opencv_xml(std::string_view text);

}  // namespace edged
