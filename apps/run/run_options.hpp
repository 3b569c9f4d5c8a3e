// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of `edged run`.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <typeindex>
#include <vector>

#include "common/config_source.hpp"
#include "common/source.hpp"

namespace edged {

/// Values by their types: how parts of a run share what they know without knowing each other. Each is made when it is
/// first asked for, and stays where it is. Not for several threads; the values may be.
class Board {
 public:
  template <typename T>
  T& get() {
    std::shared_ptr<void>& value = values_[typeid(T)];
    if (!value) value = std::make_shared<T>();
    return *static_cast<T*>(value.get());
  }
  /// The value must be there.
  template <typename T>
  const T& get() const {
    return *static_cast<const T*>(values_.at(typeid(T)).get());
  }

 private:
  std::map<std::type_index, std::shared_ptr<void>> values_;
};

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
