// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Options: each is declared once, in the `visit` function of the struct that owns it, with unit, range and effect.
// Loading, --set, the resolved dump and the printed reference all walk the same list.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace edged {

/// The known name that the user most likely meant: one close to the whole name, or one with almost the same last dotted
/// part, if the group is missing or wrong. "" if none is within that many single-letter edits.
std::string nearest_name(std::span<const std::string> known, const std::string& name,
                         std::size_t most_edits = std::numeric_limits<std::size_t>::max());

/// The documentation of an option. min and max bound numbers, both inclusive.
struct FieldDoc {
  std::string_view unit = "";
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  std::string_view effect = "";
};

/// One option of a config struct, bound to its variable.
struct ConfigField {
  std::string key;            ///< dotted, e.g. "estimator.keyframes"
  bool expert = false;        ///< its key begins with "expert.": may change with any version
  std::string type;           ///< "bool", "int", "number", "text" or "a | b | c"
  std::string unit;           ///< "" where it has none
  std::string range;          ///< e.g. "0.1 .. 10"
  std::string default_value;  ///< value of the struct when the list was made
  std::string effect;
  std::function<std::string()> get;
  std::function<void(const std::string&)> set;  ///< throws InputError naming the key and the range
};

/// The list of all options of a config struct, made by its `void visit(ConfigFields&)`; InputError where a number is
/// out of its range. The struct must outlive the list.
class ConfigFields {
 public:
  template <typename Config>
  static ConfigFields of(Config& config) {
    ConfigFields fields;
    config.visit(fields);
    fields.experts_last();
    return fields;
  }

  /// Makes `declare` declare options for experts, their keys prefixed with "expert.", but for those named.
  void expert_but(std::span<const std::string_view> names, const std::function<void()>& declare);

  void add(std::string_view name, bool& value, const FieldDoc& doc);
  void add(std::string_view name, int& value, const FieldDoc& doc);
  void add(std::string_view name, double& value, const FieldDoc& doc);
  void add(std::string_view name, std::string& value, const FieldDoc& doc);

  /// An option that takes one of a few names.
  template <typename Enum>
  void choice(std::string_view name, Enum& value, const std::vector<std::pair<std::string_view, Enum>>& choices,
              const FieldDoc& doc) {
    std::vector<std::string> names;
    std::vector<Enum> values;
    for (const auto& [text, v] : choices) names.emplace_back(text), values.push_back(v);
    add_choice(
        name, names,
        [&value, values] {
          std::size_t i = 0;
          while (i + 1 < values.size() && values[i] != value) ++i;
          return i;
        },
        [&value, values](std::size_t i) { value = values[i]; }, doc);
  }

  /// All options of a nested struct, their keys prefixed with name and a dot.
  template <typename Config>
  void group(std::string_view name, Config& nested) {
    const std::string outer = prefix_;
    prefix_ += std::string(name) + ".";
    nested.visit(*this);
    prefix_ = outer;
  }

  /// Two structs of one type as one group. One option sets both, but those named in `separate` have a key for each:
  /// group.kind.name.
  template <typename Config>
  void pair(std::string_view name, std::string_view first_kind, Config& first, std::string_view second_kind,
            Config& second, std::span<const std::string_view> separate) {
    const std::size_t prefix = prefix_.size() + name.size() + 1;
    pair_ = Pair{separate, first_kind, prefix, false};
    group(name, first);
    pair_ = Pair{separate, second_kind, prefix, true};
    group(name, second);
    pair_.reset();
  }

  const std::vector<ConfigField>& all() const { return fields_; }

  /// Sets one option from text. Throws InputError that names the key, with the nearest known one for a typing error.
  void set(const std::string& key, const std::string& value);

  /// "key=value", as given to --set.
  void set(const std::string& assignment);

  /// Reads a yaml file of nested maps or dotted keys. Throws InputError naming file, line and key.
  void load(const std::filesystem::path& file);

  /// Nested yaml with every option, unit and effect as comments: loads back to the same values.
  std::string to_yaml() const;

 private:
  void add_field(std::string_view name, std::string type, const FieldDoc& doc, bool numeric,
                 std::function<std::string()> get, std::function<void(const std::string&)> set);
  void add_choice(std::string_view name, const std::vector<std::string>& names, std::function<std::size_t()> get,
                  std::function<void(std::size_t)> set, const FieldDoc& doc);

  /// What is declared within expert_but.
  struct Audience {
    std::span<const std::string_view> everyone;  ///< names of options that are not for experts
    std::size_t prefix;                          ///< length of the prefix outside
  };
  /// What is declared within pair.
  struct Pair {
    std::span<const std::string_view> separate;  ///< names of options that each struct has for itself
    std::string_view kind;
    std::size_t prefix;  ///< length of the prefix inside
    bool second;         ///< its shared options are declared already
  };
  bool is_separate(std::string_view name) const;
  /// Below all groups, without "expert.".
  std::string path_of(std::string_view name) const;
  bool is_expert(std::string_view name) const;
  std::string key_of(std::string_view name) const;
  void experts_last();

  std::string prefix_;
  std::optional<Audience> audience_;
  std::optional<Pair> pair_;
  std::vector<ConfigField> fields_;
};

}  // namespace edged
