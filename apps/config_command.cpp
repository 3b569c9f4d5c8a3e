// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/config_source.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

struct ConfigOptions {
  std::string filter;
  bool yaml = false;
  bool json = false;
};

std::string text_of(const ConfigField& field) {
  std::string kind = field.type;
  if (field.range != "any") kind += ", " + field.range;
  if (!field.unit.empty()) kind += " " + field.unit;
  return fmt::format("{} = {}\n    {}\n    {}\n", field.key, field.default_value, kind, field.effect);
}

/// Words of the keys, separated by dots and underscores: the terms of a search.
std::vector<std::string> words_of_keys(const ConfigFields& fields) {
  std::set<std::string> words;
  for (const ConfigField& field : fields.all()) {
    for (std::size_t begin = 0; begin < field.key.size();) {
      const std::size_t end = std::min(field.key.find_first_of("._", begin), field.key.size());
      words.insert(field.key.substr(begin, end - begin));
      begin = end + 1;
    }
    words.insert(field.key.substr(field.key.rfind('.') + 1));
    words.insert(field.key);
  }
  return {words.begin(), words.end()};
}

[[noreturn]] void refuse_filter(const ConfigFields& fields, const std::string& filter) {
  throw InputError::format("no option's key contains '{}'{}; `edged config` without a word lists them", filter,
                           did_you_mean(words_of_keys(fields), filter));
}

int run_config(const ConfigOptions& options) {
  RunConfig config;
  const ConfigFields fields = ConfigFields::of(config);
  if (options.yaml) {
    fmt::print("{}", fields.to_yaml());
    return kExitOk;
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::string text;
  std::size_t passed_over = 0;
  for (const ConfigField& field : fields.all()) {
    if (field.key.find(options.filter) == std::string::npos) continue;
    const bool shown = !options.filter.empty() || !field.expert;
    if (shown) text += text_of(field);
    passed_over += shown ? 0 : 1;
    list.push_back({{"key", field.key},
                    {"type", field.type},
                    {"unit", field.unit},
                    {"range", field.range},
                    {"default", field.default_value},
                    {"effect", field.effect},
                    {"expert", field.expert}});
  }
  if (list.empty()) refuse_filter(fields, options.filter);
  if (passed_over > 0) text += fmt::format("and {} for developers of the method: edged config expert\n", passed_over);
  print_result(options.json, list, text);
  return kExitOk;
}

}  // namespace

void add_config_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ConfigOptions>();
  CLI::App* config = app.add_subcommand("config", "List the options: key, default, type, range, unit and effect");
  config->add_option("FILTER", options->filter,
                     "Show all options whose key contains this text; `expert` shows the expert options");
  CLI::Option* yaml = config->add_flag("--yaml", options->yaml, "Print a complete options file for --config");
  finish_command(*config, options,
                 "Example:\n  edged config --yaml > mine.yaml   # edit, then: edged run RECORDING --config mine.yaml",
                 chosen, run_config);
  config->get_option("--json")->excludes(yaml);
}

}  // namespace edged
