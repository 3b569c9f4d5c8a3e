// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A yaml value that knows its file, line and key, so that every complaint about it does too. Internal to io.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/core/lie.hpp"
#include "edged/io/source_path.hpp"

namespace edged {

class YamlReader {
 public:
  /// The root of a file. Throws InputError when it is missing or no yaml.
  explicit YamlReader(const SourcePath& file);

  bool is_map() const { return node_.IsMap(); }
  std::optional<YamlReader> find(const std::string& key) const;
  YamlReader at(const std::string& key) const;  ///< InputError when it is missing
  std::vector<YamlReader> items() const;        ///< of a sequence
  std::vector<std::string> keys() const;        ///< of a map, in the order of the file

  double number() const;
  std::string text() const;
  std::vector<double> numbers() const;  ///< of a sequence, nested ones in one row

  /// A rigid transform: 4x4 or 3x4 rows, a flat row of 16 or 12, or {rows, cols, data}. InputError with the deviation
  /// when the rotation is not orthonormal to 1e-3.
  SE3 transform() const;

  /// InputError when there is a key that is not in the list.
  void allow_only(std::initializer_list<std::string_view> known) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  YamlReader(std::string file, std::string path, YAML::Node node)
      : file_(std::move(file)), path_(std::move(path)), node_(std::move(node)) {}
  void collect(const YAML::Node& node, std::vector<double>& out) const;

  std::string file_, path_;  ///< path_: keys from the root, dotted
  YAML::Node node_;
};

}  // namespace edged
