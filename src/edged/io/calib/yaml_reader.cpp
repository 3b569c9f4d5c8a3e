// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Access to yaml with good complaints.
#include "edged/io/calib/yaml_reader.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/text.hpp"

namespace edged {
namespace {

constexpr double kRotationTolerance = 1e-3;
constexpr std::size_t kMostBytes = 1 << 24;

YAML::Node parse_file(const SourcePath& file) {
  try {
    return YAML::Load(std::string(as_text(file.read(kMostBytes))));
  } catch (const YAML::Exception& e) {
    throw InputError::format("{}:{}: not readable as yaml: {}", file.string(), e.mark.line + 1, e.msg);
  } catch (const Damage& damage) {
    throw InputError::format("{}: {}", file.string(), damage.what());
  }
}

}  // namespace

YamlReader::YamlReader(const SourcePath& file) : YamlReader(file.string(), "", parse_file(file)) {}

void YamlReader::fail(const std::string& what) const {
  const int line = node_.Mark().line;
  const std::string place = line >= 0 ? fmt::format("{}:{}", file_, line + 1) : file_;
  throw InputError::format("{}: {}{}{}", place, path_, path_.empty() ? "" : ": ", what);
}

std::optional<YamlReader> YamlReader::find(const std::string& key) const {
  if (!node_.IsMap()) return std::nullopt;
  const YAML::Node child = node_[key];
  if (!child) return std::nullopt;
  return YamlReader(file_, path_.empty() ? key : path_ + "." + key, child);
}

YamlReader YamlReader::at(const std::string& key) const {
  if (auto child = find(key)) return *child;
  fail("the key " + key + " is missing");
}

std::vector<YamlReader> YamlReader::items() const {
  if (!node_.IsSequence()) fail("must be a list");
  std::vector<YamlReader> out;
  for (std::size_t i = 0; i < node_.size(); ++i) out.push_back({file_, fmt::format("{}[{}]", path_, i), node_[i]});
  return out;
}

std::vector<std::string> YamlReader::keys() const {
  if (!node_.IsMap()) fail("must be a map of keys and values");
  std::vector<std::string> out;
  for (const auto& entry : node_) out.push_back(entry.first.Scalar());
  return out;
}

std::string YamlReader::text() const {
  if (!node_.IsScalar()) fail("must be one word");
  return node_.Scalar();
}

double YamlReader::number() const {
  const auto value = node_.IsScalar() ? parse_number(node_.Scalar()) : std::nullopt;
  if (!value) fail("must be a finite number");
  return *value;
}

void YamlReader::collect(const YAML::Node& node, std::vector<double>& out) const {
  if (node.IsSequence()) {
    for (const auto& item : node) collect(item, out);
    return;
  }
  const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
  if (!value) fail("must be a list of finite numbers");
  out.push_back(*value);
}

std::vector<double> YamlReader::numbers() const {
  if (!node_.IsSequence()) fail("must be a list of numbers");
  std::vector<double> out;
  collect(node_, out);
  return out;
}

SE3 YamlReader::transform() const {
  const auto data = find("data");
  std::vector<double> v = data ? data->numbers() : numbers();
  if (v.size() != 12 && v.size() != 16) fail(fmt::format("must have 4 rows of 4 numbers, has {} numbers", v.size()));
  if (v.size() == 16 && (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1)) fail("the last row must be 0 0 0 1");
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(v.data());
  const Eigen::Matrix3d R = T.leftCols<3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (deviation > kRotationTolerance)
    fail(fmt::format("the rotation is not orthonormal: R^T R differs from 1 by {:.3g} (at most {:g})", deviation,
                     kRotationTolerance));
  if (R.determinant() < 0) fail("the rotation is mirrored (determinant -1): check the signs of its columns");
  return SE3(R, T.col(3));
}

void YamlReader::allow_only(std::initializer_list<std::string_view> known) const {
  for (const std::string& key : keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string list;
    for (const std::string_view k : known) list += (list.empty() ? "" : ", ") + std::string(k);
    find(key)->fail("unknown key; known here: " + list);
  }
}

}  // namespace edged
