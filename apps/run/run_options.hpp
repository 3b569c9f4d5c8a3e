// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of `edged run`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/board.hpp"
#include "common/config_source.hpp"
#include "common/source.hpp"

namespace edged {

struct RunOptions {
  SourceOptions source;
  ConfigSource config;
  std::string mode = "auto";
  std::string frame = "auto";
  std::filesystem::path out;
  std::vector<std::string> more;  ///< options as key=value
  std::string archive;            ///< which file; "true" for the one beside the folder; "" for none
  bool force = false;
  bool quiet = false;
  bool json = false;
  bool live = false;
  bool localize_only = false;  ///< option map.localize_only
  Board outputs;               ///< the options of each output, by the type that it declares for them
};

}  // namespace edged
