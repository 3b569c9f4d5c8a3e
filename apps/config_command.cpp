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

#include "common/config_source.hpp"
#include "edged/core/check.hpp"
#include "program/commands.hpp"
#include "program/program.hpp"

namespace edged {
namespace {

struct ConfigOptions {
  std::string filter;
  bool yaml = false;
  bool json = false;
};

void print_text(const ConfigField& field) {
  std::string kind = field.type;
  if (field.range != "any") kind += ", " + field.range;
  if (!field.unit.empty()) kind += " " + field.unit;
  fmt::print("{} = {}\n    {}\n    {}\n", field.key, field.default_value, kind, field.effect);
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
  const std::string nearest = nearest_name(words_of_keys(fields), filter, typing_errors(filter));
  throw InputError::format("no option's key contains '{}'{}; `edged config` without a word lists them", filter,
                           did_you_mean(nearest));
}

int run_config(const ConfigOptions& options) {
  RunConfig config;
  const ConfigFields fields = ConfigFields::of(config);
  if (options.yaml) {
    fmt::print("{}", fields.to_yaml());
    return kExitOk;
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::size_t passed_over = 0;
  for (const ConfigField& field : fields.all()) {
    if (field.key.find(options.filter) == std::string::npos) continue;
    const bool shown = !options.filter.empty() || !field.expert;
    if (!options.json && shown) print_text(field);
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
  if (options.json) {
    fmt::print("{}\n", list.dump(2));
  } else if (passed_over > 0) {
    fmt::print("and {} for developers of the method: edged config expert\n", passed_over);
  }
  return kExitOk;
}

}  // namespace

void add_config_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ConfigOptions>();
  CLI::App* config = app.add_subcommand("config", "List the options: key, default, type, range, unit and effect");
  config->add_option("FILTER", options->filter,
                     "Show all options whose key contains this text; `expert` shows the expert options");
  CLI::Option* yaml = config->add_flag("--yaml", options->yaml, "Print a complete options file for --config");
  config->add_flag("--json", options->json, "Print JSON")->excludes(yaml);
  config->footer("Example:\n  edged config --yaml > mine.yaml   # edit, then: edged run RECORDING --config mine.yaml");
  config->callback([options, &chosen] { chosen = [options] { return run_config(*options); }; });
}

}  // namespace edged
