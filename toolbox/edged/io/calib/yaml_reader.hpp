// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A yaml value with its file, line and key, which each of its errors names. Internal to io.
#pragma once

#include <yaml-cpp/yaml.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/archive/source_path.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// Also reads OpenCV's dialect (`%YAML:1.0`, `!!opencv-matrix`), its xml, and json.
class YamlReader {
 public:
  /// The root of a file. Throws InputError for a file that is missing, no yaml, or larger than any calibration (16 MB).
  explicit YamlReader(const SourcePath& file);

  /// The root of another file. Its warnings are added to those of this file.
  YamlReader other_file(const SourcePath& file) const;

  bool is_map() const { return node_.IsMap(); }
  std::optional<YamlReader> find(const std::string& key) const;
  YamlReader at(const std::string& key) const;                      ///< throws InputError if it is missing
  std::vector<YamlReader> items() const;                            ///< items of a sequence
  std::vector<std::pair<std::string, YamlReader>> entries() const;  ///< entries of a map, in the order of the file

  double number() const;
  double positive() const;
  std::string text() const;
  std::string text_or(const std::string& key, const std::string& otherwise) const;  ///< text of a child
  /// The numbers of a sequence, also a nested one, or of {rows, cols, data}, whose size is checked. At most 64.
  std::vector<double> numbers() const;
  /// So many numbers; `form` shows them in the refusal, as in "[width, height]".
  std::vector<double> numbers(std::size_t count, std::string_view form) const;
  /// A time offset of at most 10 s either way, exact to the nanosecond. unit_s: its unit in seconds.
  Duration time_offset(double unit_s = 1.0) const;

  /// A rigid transform: 4x4 or 3x4 rows, a flat row of 16 or 12, or {rows, cols, data}. See `rigid`.
  SE3 transform() const;
  /// A rigid transform from a row-major rotation (9 numbers) and a translation (3). Throws InputError, with the
  /// deviation, if the rotation is mirrored or not orthonormal to 1e-3. Warns if it is not orthonormal to 1e-5.
  SE3 rigid(std::span<const double> rotation, std::span<const double> translation) const;

  /// Throws InputError for a key that is not in the list.
  void allow_only(const std::vector<std::string_view>& known) const;

  const SourcePath& file() const { return file_; }
  [[noreturn]] void fail(const std::string& what) const;
  /// What make() returns. If it throws InputError, that becomes one about this value.
  template <typename Make>
  auto checked(const Make& make) const try {
    return make();
  } catch (const InputError& e) {
    fail(e.what());
  }
  void warn(const std::string& what) const { warnings_->push_back(place() + what); }
  const std::vector<std::string>& warnings() const { return *warnings_; }  ///< about all values of the file

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

/// The matrix of T for YamlReader::transform(), a line for each row.
std::string yaml_rows(const SE3& T, std::string_view indent);

}  // namespace edged
