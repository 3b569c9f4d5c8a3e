// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/calib/yaml_reader.hpp"

#include <spdlog/fmt/ranges.h>
#include <tinyxml2.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr double kRotationTolerance = 1e-3;  // beyond it: an error
constexpr double kRotationRounding = 1e-5;   // beyond it: a warning; six digits are accurate enough
constexpr std::size_t kMaxFileBytes = 16 << 20;
constexpr std::size_t kMaxNumbers = 64;  // no value of any format has more
constexpr int kMaxNesting = 4;           // of lists: by an anchor, a list can contain itself
constexpr double kMaxLength = 1e6;       // [m] of a translation
constexpr double kMaxOffset = 10.0;      // [s]

std::string read_small_file(const SourcePath& file) try {
  return std::string(as_text(file.read(kMaxFileBytes)));
} catch (const Damage& damage) {
  throw InputError::format("{}: {}", file.string(), damage.what());
}

/// The explanation of a frequent mistake: the rows of a matrix without brackets around all of them.
std::string hint(const std::string& text, int line) {
  std::size_t begin = 0;
  for (int i = 0; i < line && begin != std::string::npos; ++i) begin = text.find('\n', begin + (i > 0));
  begin = begin == std::string::npos ? begin : text.find_first_not_of(" \t\n", begin);
  if (begin == std::string::npos || text[begin] != '[') return "";
  return "; a list begins here where a key should: the rows of a matrix need one pair of brackets around them all";
}

/// The key of a line of yaml; "" of a row of a matrix.
std::string_view key_of(std::string_view line) {
  const std::string_view key = line.substr(0, line.find(':'));
  const std::size_t begin = key.find_first_not_of(" -");
  return key.size() == line.size() || begin == std::string_view::npos ? "" : key.substr(begin);
}

/// Refuses a template with all lines, and their keys, that are still to be filled in.
void check_filled_in(const SourcePath& file, const std::string& text) {
  std::vector<std::size_t> lines;
  std::vector<std::string_view> keys;
  std::string_view key;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line = std::string_view(text).substr(begin, end - begin);
    line = line.substr(0, line.find('#'));
    if (const std::string_view own = key_of(line); !own.empty()) key = own;
    if (line.find("FILL_IN") != std::string_view::npos) {
      lines.push_back(number + 1);
      if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
    }
    begin = end + 1;
  }
  if (lines.empty()) return;
  const std::string all = lines.size() == 1 ? "reads FILL_IN; write your number there"
                                            : fmt::format("{} lines read FILL_IN: {}; write your numbers there",
                                                          lines.size(), fmt::join(lines, ", "));
  throw InputError::format("{}:{}: {} ({})", file.string(), lines.front(), all, fmt::join(keys, ", "));
}

/// A text in quotes is one item.
YAML::Node leaf(std::string_view text) {
  const std::size_t quote = text.find('"'), end = text.rfind('"');
  if (quote != end) return YAML::Node(std::string(text.substr(quote + 1, end - quote - 1)));
  std::string words(text);
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  FieldReader fields(words);
  const std::string first(fields.next());
  std::string_view next = fields.next();
  if (next.empty()) return YAML::Node(first);
  YAML::Node list(YAML::NodeType::Sequence);
  list.push_back(first);
  for (; !next.empty(); next = fields.next()) list.push_back(std::string(next));
  return list;
}

YAML::Node value_of(const tinyxml2::XMLElement& element) {
  const tinyxml2::XMLElement* child = element.FirstChildElement();
  if (!child) return leaf(element.GetText() ? element.GetText() : "");
  const bool is_list = std::string_view(child->Name()) == "_";
  YAML::Node node(is_list ? YAML::NodeType::Sequence : YAML::NodeType::Map);
  for (; child; child = child->NextSiblingElement())
    is_list ? node.push_back(value_of(*child)) : node.force_insert(std::string(child->Name()), value_of(*child));
  return node;
}

/// True if the text begins as xml.
bool is_xml(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return begin != std::string_view::npos && text[begin] == '<';
}

/// Elements become keys, elements `_` become items of a list, a sequence of numbers becomes a list. Throws Damage, with
/// the line, if the text is no xml.
YAML::Node parse_opencv_xml(std::string_view text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw Damage(fmt::format("not readable as xml from line {} on", document.ErrorLineNum()));
  const tinyxml2::XMLElement* root = document.FirstChildElement("opencv_storage");
  if (!root) throw Damage("xml, but not of OpenCV: it has no element opencv_storage");
  return value_of(*root);
}

YAML::Node parse_file(const SourcePath& file) {
  const std::string text = read_small_file(file);
  check_filled_in(file, text);
  try {
    return is_xml(text) ? parse_opencv_xml(text) : YAML::Load(text);
  } catch (const Damage& damage) {
    throw InputError::format("{}: {}", file.string(), damage.what());
  } catch (const YAML::Exception& e) {
    throw InputError::format("{}:{}: not readable as yaml: {}{}", file.string(), e.mark.line + 1, e.msg,
                             hint(text, e.mark.line));
  }
}

}  // namespace

YamlReader::YamlReader(const SourcePath& file)
    : YamlReader(file, "", parse_file(file), std::make_shared<std::vector<std::string>>()) {}

YamlReader YamlReader::other_file(const SourcePath& file) const { return {file, "", parse_file(file), warnings_}; }

std::string YamlReader::place() const {
  const int line = node_.Mark().line;
  return fmt::format("{}{}: {}{}", file_.string(), line >= 0 ? fmt::format(":{}", line + 1) : "", path_,
                     path_.empty() ? "" : ": ");
}

void YamlReader::fail(const std::string& what) const { throw InputError(place() + what); }

std::optional<YamlReader> YamlReader::find(const std::string& key) const {
  if (!node_.IsMap()) return std::nullopt;
  const YAML::Node child = node_[key];
  if (!child) return std::nullopt;
  return YamlReader(file_, path_.empty() ? key : path_ + "." + key, child, warnings_);
}

YamlReader YamlReader::at(const std::string& key) const {
  if (auto child = find(key)) return *child;
  fail("the key " + key + " is missing");
}

std::vector<YamlReader> YamlReader::items() const {
  if (!node_.IsSequence()) fail("must be a list");
  std::vector<YamlReader> out;
  for (std::size_t i = 0; i < node_.size(); ++i)
    out.push_back({file_, fmt::format("{}[{}]", path_, i), node_[i], warnings_});
  return out;
}

std::vector<std::pair<std::string, YamlReader>> YamlReader::entries() const {
  if (!node_.IsMap()) fail("must be a map of keys and values");
  std::vector<std::pair<std::string, YamlReader>> out;
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    out.emplace_back(key, YamlReader(file_, path_.empty() ? key : path_ + "." + key, entry.second, warnings_));
  }
  return out;
}

std::string YamlReader::text() const {
  if (!node_.IsScalar()) fail("must be one word");
  return node_.Scalar();
}

std::string YamlReader::text_or(const std::string& key, const std::string& otherwise) const {
  const auto child = find(key);
  return child ? child->text() : otherwise;
}

double YamlReader::number() const {
  const auto value = node_.IsScalar() ? parse_number(node_.Scalar()) : std::nullopt;
  if (!value) fail("must be a finite number" + (node_.IsScalar() ? ", but is '" + node_.Scalar() + "'" : ""));
  return *value;
}

double YamlReader::positive() const {
  const double x = number();
  if (x <= 0) fail("must be above 0");
  return x;
}

Duration YamlReader::time_offset(double unit_s) const {
  const double seconds = number() * unit_s;
  if (std::abs(seconds) > kMaxOffset)
    fail(fmt::format("a clock off by {:g} s; at most {:g} s is accepted: is it in seconds?", seconds, kMaxOffset));
  return duration_from_seconds(seconds);
}

void YamlReader::collect(const YAML::Node& node, int depth, std::vector<double>& out) const {
  if (node.IsSequence() && depth < kMaxNesting) {
    for (const auto& item : node) collect(item, depth + 1, out);
    return;
  }
  const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
  if (!value) fail("must be a list of finite numbers");
  if (out.size() == kMaxNumbers) fail(fmt::format("must have at most {} numbers", kMaxNumbers));
  out.push_back(*value);
}

std::vector<double> YamlReader::numbers() const {
  const auto data = find("data");
  if (!node_.IsSequence() && !data) fail("must be a list of numbers");
  std::vector<double> out;
  collect(data ? data->node_ : node_, 0, out);
  if (!data) return out;
  const auto rows = find("rows"), cols = find("cols");
  // Files often state one row fewer than there are distortion coefficients.
  if (rows && cols && rows->number() * cols->number() > static_cast<double>(out.size()))
    fail(fmt::format("{} rows of {} need more than the {} numbers of data", rows->text(), cols->text(), out.size()));
  return out;
}

std::vector<double> YamlReader::numbers(std::size_t count, std::string_view form) const {
  std::vector<double> out = numbers();
  if (out.size() != count) fail(fmt::format("must be {}", form));
  return out;
}

SE3 YamlReader::transform() const {
  const std::vector<double> v = numbers();
  if (v.size() != 12 && v.size() != 16) fail(fmt::format("must have 4 rows of 4 numbers, has {} numbers", v.size()));
  if (v.size() == 16 && (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1)) fail("the last row must be 0 0 0 1");
  return rigid(std::array{v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10]}, std::array{v[3], v[7], v[11]});
}

SE3 YamlReader::rigid(std::span<const double> rotation, std::span<const double> translation) const {
  if (rotation.size() != 9 || translation.size() != 3) fail("a rotation has 9 numbers and a translation 3");
  const Eigen::Vector3d t = Eigen::Map<const Eigen::Vector3d>(translation.data());
  if (!(t.norm() <= kMaxLength)) fail(fmt::format("a translation of {:g} m is impossible", t.norm()));
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= kRotationTolerance))
    fail(fmt::format("the rotation is not orthonormal: R^T R differs from 1 by {:.3g} (at most {:g})", deviation,
                     kRotationTolerance));
  if (R.determinant() < 0) fail("the rotation is mirrored (determinant -1): check the signs of its columns");
  if (deviation > kRotationRounding)
    warn(
        fmt::format("the rotation is orthonormal only to {:.2g} (R^T R against 1); a rotation near it is used: "
                    "give more digits",
                    deviation));
  return SE3(R, t);
}

void YamlReader::allow_only(const std::vector<std::string_view>& known) const {
  for (const auto& [key, value] : entries()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    value.fail(fmt::format("unknown key; known here: {}", fmt::join(known, ", ")));
  }
}

std::string yaml_rows(const SE3& T, std::string_view indent) {
  std::string out;
  const Eigen::Matrix4d M = T.matrix();
  for (int row = 0; row < 4; ++row)
    out += fmt::format("{}- [{}, {}, {}, {}]\n", indent, M(row, 0), M(row, 1), M(row, 2), M(row, 3));
  return out;
}

}  // namespace edged
