// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/config.hpp"

#include <spdlog/spdlog.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <ios>
#include <iterator>
#include <numeric>
#include <set>
#include <system_error>

#include "edged/core/check.hpp"

namespace edged {
namespace {

std::string range_text(const FieldDoc& doc) {
  const bool low = std::isfinite(doc.min), high = std::isfinite(doc.max);
  if (low && high) return fmt::format("{} .. {}", doc.min, doc.max);
  if (low) return fmt::format(">= {}", doc.min);
  if (high) return fmt::format("<= {}", doc.max);
  return "any";
}

/// Checks a value that is set, or that the struct holds when its list is made.
template <typename Number>
void check_range(const std::string& key, Number value, const FieldDoc& doc) {
  if (static_cast<double>(value) >= doc.min && static_cast<double>(value) <= doc.max) return;
  throw InputError::format("option '{}' is {}, outside its range {}{}{}", key, value, range_text(doc),
                           doc.unit.empty() ? "" : " ", doc.unit);
}

/// The whole text as a number, or false.
template <typename Number>
bool parse(const std::string& text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

template <typename Number>
Number parse_number(const std::string& key, const std::string& text, const char* wanted, const FieldDoc& doc,
                    const std::string& range) {
  Number value{};
  if (!parse(text, value) || std::isnan(static_cast<double>(value))) {
    throw InputError::format("option '{}' is '{}', but must be {} ({})", key, text, wanted, range);
  }
  check_range(key, value, doc);
  return value;
}

bool parse_bool(const std::string& key, const std::string& text) {
  for (const char* yes : {"true", "on", "yes", "1"}) {
    if (text == yes) return true;
  }
  for (const char* no : {"false", "off", "no", "0"}) {
    if (text == no) return false;
  }
  throw InputError::format("option '{}' is '{}', but must be true or false", key, text);
}

/// Levenshtein distance: single-letter edits that turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

std::string_view last_part(std::string_view key) { return key.substr(key.rfind('.') + 1); }

/// Calls use(key, value, line) for every scalar below node; line counts from 1.
void for_each_scalar(const YAML::Node& node, const std::string& prefix, const std::string& file,
                     const std::function<void(const std::string&, const std::string&, int)>& use) {
  const int node_line = node.Mark().line + 1;
  if (node.IsScalar()) return use(prefix, node.Scalar(), node_line);
  if (node.IsNull() && prefix.empty()) return;
  if (!node.IsMap()) {
    throw InputError::format("{}:{}: '{}' must be a single value or a map of options", file, node_line, prefix);
  }
  for (const auto& entry : node) {
    const std::string name = entry.first.Scalar();
    for_each_scalar(entry.second, prefix.empty() ? name : fmt::format("{}.{}", prefix, name), file, use);
  }
}

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t dot; (dot = key.find('.', begin)) != std::string::npos; begin = dot + 1) {
    parts.push_back(key.substr(begin, dot - begin));
  }
  parts.push_back(key.substr(begin));
  return parts;
}

std::string yaml_scalar(const ConfigField& field) {
  std::string value = field.get();
  if (field.type != "text") return value;
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '\n') {
      quoted += "\\n";
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string yaml_comment(const ConfigField& field) {
  std::string comment;
  const auto append = [&comment](const std::string& text) {
    if (text.empty() || text == "any") return;
    if (!comment.empty()) comment += "; ";
    comment += text;
  };
  append(field.unit.empty() ? field.range
                            : fmt::format("[{}] {}", field.unit, field.range == "any" ? "" : field.range));
  if (field.get() != field.default_value) append("default " + field.default_value);
  append(field.effect);
  return comment;
}

/// A function of its own: the yaml library leaks its buffer if the path is a folder.
std::string read_text(const std::filesystem::path& file) try {
  std::ifstream in(file);
  if (!in) throw std::ios_base::failure("open", std::error_code(errno, std::generic_category()));
  return {std::istreambuf_iterator<char>(in), {}};
} catch (const std::ios_base::failure& e) {
  throw InputError::format("{}: cannot be read: {}; check the path given to --config", file.string(),
                           e.code().message());
}

}  // namespace

std::string nearest_name(std::span<const std::string> known, const std::string& name, std::size_t most_edits) {
  constexpr std::size_t kTypingErrors = 2;
  std::string nearest;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : known) {
    const std::size_t whole = edit_distance(name, candidate);
    const std::size_t last = edit_distance(last_part(name), last_part(candidate));
    const std::size_t edits = last <= kTypingErrors ? std::min(whole, last + 1) : whole;
    if (edits >= fewest || edits > most_edits) continue;
    nearest = candidate;
    fewest = edits;
  }
  return nearest;
}

void ConfigFields::expert_but(std::span<const std::string_view> names, const std::function<void()>& declare) {
  audience_ = Audience{names, prefix_.size()};
  declare();
  audience_.reset();
}

bool ConfigFields::is_separate(std::string_view name) const {
  return pair_ &&
         std::ranges::find(pair_->separate, prefix_.substr(pair_->prefix) + std::string(name)) != pair_->separate.end();
}

std::string ConfigFields::path_of(std::string_view name) const {
  std::string path = prefix_ + std::string(name);
  if (is_separate(name)) path.insert(pair_->prefix, std::string(pair_->kind) + ".");
  return path;
}

bool ConfigFields::is_expert(std::string_view name) const {
  if (!audience_) return false;
  return std::ranges::find(audience_->everyone, path_of(name).substr(audience_->prefix)) == audience_->everyone.end();
}

std::string ConfigFields::key_of(std::string_view name) const {
  std::string key = path_of(name);
  if (is_expert(name)) key.insert(audience_->prefix, "expert.");
  return key;
}

void ConfigFields::experts_last() {
  // Not of std::ranges: clang 14, which builds the fuzzers, does not compile that of libstdc++ 12.
  std::stable_partition(fields_.begin(), fields_.end(), [](const ConfigField& field) { return !field.expert; });
}

void ConfigFields::add_field(std::string_view name, std::string type, const FieldDoc& doc, bool numeric,
                             std::function<std::string()> get, std::function<void(const std::string&)> set) {
  if (pair_ && pair_->second && !is_separate(name)) {
    const auto shared = std::ranges::find(fields_, key_of(name), &ConfigField::key);
    shared->set = [first = std::move(shared->set), second = std::move(set)](const std::string& text) {
      first(text);
      second(text);
    };
    return;
  }
  const std::string default_value = get();
  ConfigField field{.key = key_of(name),
                    .expert = is_expert(name),
                    .type = std::move(type),
                    .unit = std::string(doc.unit),
                    .range = numeric ? range_text(doc) : "any",
                    .default_value = default_value,
                    .effect = std::string(doc.effect),
                    .get = std::move(get),
                    .set = std::move(set)};
  for (const ConfigField& other : fields_) EDGED_CHECK(other.key != field.key, "option '{}' declared twice", field.key);
  fields_.push_back(std::move(field));
}

void ConfigFields::add(std::string_view name, bool& value, const FieldDoc& doc) {
  const std::string key = key_of(name);
  add_field(
      name, "bool", doc, false, [&value] { return value ? "true" : "false"; },
      [&value, key](const std::string& text) { value = parse_bool(key, text); });
}

void ConfigFields::add(std::string_view name, int& value, const FieldDoc& doc) {
  const std::string key = key_of(name);
  check_range(key, value, doc);
  add_field(
      name, "int", doc, true, [&value] { return fmt::format("{}", value); },
      [&value, key, doc, range = range_text(doc)](const std::string& text) {
        value = parse_number<int>(key, text, "a whole number", doc, range);
      });
}

void ConfigFields::add(std::string_view name, double& value, const FieldDoc& doc) {
  const std::string key = key_of(name);
  check_range(key, value, doc);
  add_field(
      name, "number", doc, true,
      [&value] { return fmt::format("{}", value); },  // shortest text that reads back exactly
      [&value, key, doc, range = range_text(doc)](const std::string& text) {
        value = parse_number<double>(key, text, "a number", doc, range);
      });
}

void ConfigFields::add(std::string_view name, std::string& value, const FieldDoc& doc) {
  add_field(
      name, "text", doc, false, [&value] { return value; }, [&value](const std::string& text) { value = text; });
}

void ConfigFields::add_choice(std::string_view name, const std::vector<std::string>& names,
                              std::function<std::size_t()> get, std::function<void(std::size_t)> set,
                              const FieldDoc& doc) {
  const std::string key = key_of(name);
  const std::string choices = fmt::format("{}", fmt::join(names, " | "));
  add_field(
      name, choices, doc, false, [get = std::move(get), names] { return names[get()]; },
      [set = std::move(set), names, key, choices](const std::string& text) {
        const auto found = std::find(names.begin(), names.end(), text);
        if (found == names.end()) throw InputError::format("option '{}' is '{}', but must be {}", key, text, choices);
        set(static_cast<std::size_t>(found - names.begin()));
      });
}

void ConfigFields::set(const std::string& key, const std::string& value) {
  const auto known = std::ranges::find(fields_, key, &ConfigField::key);
  if (known != fields_.end()) return known->set(value);
  std::vector<std::string> keys;
  for (const ConfigField& field : fields_) keys.push_back(field.key);
  throw InputError::format(
      "unknown option '{}'; did you mean '{}'? (`edged config` lists those of a run, `edged simulate --list` those of "
      "the simulator)",
      key, nearest_name(keys, key));
}

void ConfigFields::set(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError::format("'{}' is not an assignment; write key=value", assignment);
  }
  set(assignment.substr(0, equals), assignment.substr(equals + 1));
}

void ConfigFields::load(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& e) {
    throw InputError::format("{}:{}: not valid yaml: {}", file.string(), e.mark.line + 1, e.msg);
  }
  std::set<std::string> seen;
  for_each_scalar(root, "", file.string(), [&](const std::string& key, const std::string& value, int line) {
    if (!seen.insert(key).second) {
      throw InputError::format("{}:{}: option '{}' is given twice; keep one", file.string(), line, key);
    }
    try {
      set(key, value);
    } catch (const InputError& e) {
      throw InputError::format("{}:{}: {}", file.string(), line, e.what());
    }
  });
}

std::string ConfigFields::to_yaml() const {
  std::string yaml;
  std::vector<std::string> open;  // groups that enclose the last line
  for (const ConfigField& field : fields_) {
    std::vector<std::string> groups = split_key(field.key);
    const std::string name = groups.back();
    groups.pop_back();
    const auto [differs, unused] = std::mismatch(groups.begin(), groups.end(), open.begin(), open.end());
    for (auto group = differs; group != groups.end(); ++group) {
      yaml += fmt::format("{:{}}{}:\n", "", 2 * (group - groups.begin()), *group);
    }
    open = groups;
    const std::string comment = yaml_comment(field);
    yaml += fmt::format("{:{}}{}: {}{}{}\n", "", 2 * groups.size(), name, yaml_scalar(field),
                        comment.empty() ? "" : "  # ", comment);
  }
  return yaml;
}

}  // namespace edged
