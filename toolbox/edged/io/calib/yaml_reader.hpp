// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A yaml value that knows its file, line and key, so that every complaint about it does too. Internal to io.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "edged/io/source_path.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// Also reads OpenCV's dialect (`%YAML:1.0`, `!!opencv-matrix`), its xml, and json.
class YamlReader {
 public:
  /// The root of a file. Throws InputError when it is missing, no yaml, or larger than any calibration (16 MB).
  explicit YamlReader(const SourcePath& file);

  /// The root of another file, whose warnings join those of this one.
  YamlReader other_file(const SourcePath& file) const;

  bool is_map() const { return node_.IsMap(); }
  std::optional<YamlReader> find(const std::string& key) const;
  YamlReader at(const std::string& key) const;                      ///< InputError when it is missing
  std::vector<YamlReader> items() const;                            ///< of a sequence
  std::vector<std::pair<std::string, YamlReader>> entries() const;  ///< of a map, in the order of the file

  double number() const;
  double positive() const;
  std::string text() const;
  std::string text_or(const std::string& key, const std::string& otherwise) const;  ///< of a child
  /// Of a sequence, nested ones in one row, or of {rows, cols, data}, whose size is checked. At most 64.
  std::vector<double> numbers() const;
  /// At most 10 s either way: a clock's offset, to the nanosecond. unit_s: what it is counted in.
  Duration time_offset(double unit_s = 1.0) const;

  /// A rigid transform: 4x4 or 3x4 rows, a flat row of 16 or 12, or {rows, cols, data}. See `rigid`.
  SE3 transform() const;
  /// Row-major rotation (9 numbers) and translation (3) of this value's. InputError with the deviation when the
  /// rotation is not orthonormal to 1e-3 or mirrored; a warning when it is so only to 1e-5.
  SE3 rigid(std::span<const double> rotation, std::span<const double> translation) const;

  /// InputError when there is a key that is not in the list.
  void allow_only(std::initializer_list<std::string_view> known) const;

  const SourcePath& file() const { return file_; }
  [[noreturn]] void fail(const std::string& what) const;
  void warn(const std::string& what) const { warnings_->push_back(place() + what); }
  const std::vector<std::string>& warnings() const { return *warnings_; }  ///< of all values of the file

 private:
  using Warnings = std::shared_ptr<std::vector<std::string>>;
  YamlReader(SourcePath file, std::string path, YAML::Node node, Warnings warnings)
      : file_(std::move(file)), path_(std::move(path)), node_(std::move(node)), warnings_(std::move(warnings)) {}
  void collect(const YAML::Node& node, int depth, std::vector<double>& out) const;
  std::string place() const;  ///< "file:line: key: "

  SourcePath file_;
  std::string path_;  ///< keys from the root, dotted
  YAML::Node node_;
  Warnings warnings_;
};

}  // namespace edged
