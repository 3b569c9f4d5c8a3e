// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/config_source.hpp"
#include "edged/io/calibration.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

/// The commands that help shows.
std::vector<const CLI::App*> shown_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

/// The options that help shows.
std::vector<const CLI::Option*> shown_options(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

/// Text escaped for troff.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (safe.empty() || safe.back() == '\n')) safe += "\\&";
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string roff_verbatim(const std::string& text) {
  return text.empty() ? "" : fmt::format(".PP\n.EX\n{}\n.EE\n", roff(text));
}

std::string roff_options(const CLI::App& command) {
  const CLI::Formatter formatter;
  std::string text;
  for (const CLI::Option* option : shown_options(command)) {
    const std::string name = option->get_positional() ? option->get_name(true) : option->get_name(false, true);
    text += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(name), roff(formatter.make_option_opts(option)),
                        roff(option->get_description()));
  }
  return text;
}

/// The content of `edged COMMAND --help`, also for its sub-commands.
std::string roff_command(const CLI::App& command, const std::string& name) {
  std::string text = fmt::format(".SS {}\n{}.\n", roff(name), roff(command.get_description()));
  text += roff_verbatim(CLI::Formatter().make_usage(&command, name));
  text += roff_options(command) + roff_verbatim(command.get_footer());
  for (const CLI::App* inner : shown_commands(command)) text += roff_command(*inner, name + " " + inner->get_name());
  return text;
}

std::string man_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  std::string text = fmt::format(".TH EDGED 1 \"\" \"edged {}\" \"User Commands\"\n.ad l\n.nh\n.SH NAME\n{} \\- {}\n",
                                 roff(kVersion), name, roff(app.get_description()));
  text += fmt::format(".SH SYNOPSIS\n\\fB{}\\fR \\fICOMMAND\\fR ...\n", name);
  text += ".SH OPTIONS\n" + roff_options(app) + ".SH COMMANDS\n";
  for (const CLI::App* command : shown_commands(app)) text += roff_command(*command, name + " " + command->get_name());
  return text + ".SH EXAMPLES AND EXIT STATUS\n" + roff_verbatim(app.get_footer());
}

/// The option keys for --set of a command, as KEY=.
template <typename Config>
std::string assignments() {
  Config config;
  const ConfigFields fields = ConfigFields::of(config);
  std::string words;
  for (const ConfigField& field : fields.all()) words += field.key + "= ";
  return words;
}

/// The possible values of an option; "" for a file or any text. rigs: the shell code that lists their names.
std::string choices(const CLI::App& command, const CLI::Option& option, const std::string& rigs) {
  if (option.check_name("--rig")) return rigs;
  if (option.check_name("--preset")) return fmt::format("{}", fmt::join(simulator_presets(), " "));
  if (option.check_name("--set"))
    return command.get_name() == "simulate" ? assignments<SimulatorConfig>() : assignments<RunConfig>();
  // The format of CLI::IsMember in the help: TEXT:{a,b,c}
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  if (open == std::string::npos) return "";
  std::string words = type.substr(open + 1, type.find('}') - open - 1);
  std::ranges::replace(words, ',', ' ');
  return words;
}

/// The syntax of bash or zsh for an array variable and for the names of the rigs.
struct ShellWords {
  const char *begin, *end, *rigs;
};

/// For `case "COMMAND OPTION" in`: the values of each option, and all other words.
std::string completion_cases(const CLI::App& command, const ShellWords& shell) {
  std::string cases;
  std::string names;
  const auto add = [&](const std::string& pattern, const std::string& words) {
    cases += fmt::format("    {}) {}{}{} ;;\n", pattern, shell.begin, words, shell.end);
  };
  for (const CLI::App* inner : shown_commands(command)) names += inner->get_name() + " ";
  for (const CLI::Option* option : shown_options(command)) {
    for (const std::string& long_name : option->get_lnames()) {
      names += "--" + long_name + " ";
      if (option->get_items_expected_max() > 0)
        add(fmt::format("\"{} --{}\"", command.get_name(), long_name), choices(command, *option, shell.rigs));
    }
  }
  add(fmt::format("\"{} \"*", command.get_name()), names);
  return cases;
}

std::string all_cases(const CLI::App& app, const ShellWords& shell) {
  std::string cases = completion_cases(app, shell);
  for (const CLI::App* command : shown_commands(app)) cases += completion_cases(*command, shell);
  return cases;
}

/// If no word fits, bash offers files.
std::string bash_completion(const CLI::App& app) {
  const ShellWords bash{"words=\"", "\"", "$(\"${COMP_WORDS[0]}\" manual rigs 2>/dev/null)"};
  return fmt::format(R"(# Completion of bash for {0}, written by `{0} manual bash`.
_{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} option=${{COMP_WORDS[COMP_CWORD - 1]}} command=${{COMP_WORDS[1]}} words=
  # bash cuts --option=word into three
  [ "$option" = "=" ] && option=${{COMP_WORDS[COMP_CWORD - 2]}}
  [ "$word" = "=" ] && word=
  [ "$COMP_CWORD" = 1 ] && command={0} option=
  case "$command $option" in
{1}  esac
  # files before options, until a dash asks for these
  [[ -z $word && $words == --* ]] && words=
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  [[ ${{COMPREPLY[*]}} == *= ]] && compopt -o nospace
}}
complete -o default -F _{0} {0}
)",
                     app.get_name(), all_cases(app, bash));
}

std::string zsh_completion(const CLI::App& app) {
  const ShellWords zsh{"choices=(", ")", "${(f)\"$(${words[1]} manual rigs 2>/dev/null)\"}"};
  return fmt::format(R"(#compdef {0}
# Completion of zsh for {0}, written by `{0} manual zsh`.
_{0}() {{
  local option=${{words[CURRENT-1]}} command=${{words[2]}}
  local -a choices
  # --option=word
  [[ $PREFIX == --*=* ]] && option=${{PREFIX%%=*}} && compset -P '--*='
  (( CURRENT == 2 )) && command={0} option=
  case "$command $option" in
{1}  esac
  # files before options, until a dash asks for these
  if [[ ${{choices[1]}} == --* && $PREFIX != -* ]] || (( $#choices == 0 )); then
    _files
    return
  fi
  compadd -S '' -- ${{(M)choices:#*=}}
  compadd -- ${{choices:#*=}}
}}
_{0} "$@"
)",
                     app.get_name(), all_cases(app, zsh));
}

/// Within single quotes.
std::string fish_quoted(const std::string& text) {
  std::string safe;
  for (const char c : text) safe += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  return "'" + safe + "'";
}

/// Files are offered for positional words, and for options with any text.
std::string fish_options(const CLI::App& command, const std::string& where) {
  std::string text;
  for (const CLI::Option* option : shown_options(command)) {
    std::string line;
    for (const std::string& name : option->get_lnames()) line += " -l " + name;
    if (line.empty()) continue;
    for (const std::string& name : option->get_snames()) line += " -s " + name;
    const std::string words = choices(command, *option, "(edged manual rigs 2>/dev/null)");
    if (option->get_items_expected_max() > 0) line += words.empty() ? " -r" : " -x -a " + fish_quoted(words);
    text += fmt::format("{}{} -d {}\n", where, line, fish_quoted(option->get_description()));
  }
  return text;
}

std::string fish_completion(const CLI::App& app) {
  const std::string begin = "complete -c " + app.get_name();
  std::string text = fmt::format("# Completion of fish for {0}, written by `{0} manual fish`.\n", app.get_name());
  const std::string first = begin + " -n __fish_use_subcommand";
  text += fish_options(app, first);
  for (const CLI::App* command : shown_commands(app)) {
    text += fmt::format("{} -f -a {} -d {}\n", first, command->get_name(), fish_quoted(command->get_description()));
    const std::string where = fmt::format("{} -n '__fish_seen_subcommand_from {}'", begin, command->get_name());
    for (const CLI::App* inner : shown_commands(*command))
      text += fmt::format("{} -a {} -d {}\n", where, inner->get_name(), fish_quoted(inner->get_description()));
    text += fish_options(*command, where);
  }
  return text;
}

int print_manual(const CLI::App& app, const std::string& kind) {
  if (kind == "rigs") {
    fmt::print("{}\n", fmt::join(known_rigs(), "\n"));
  } else {
    fmt::print("{}", kind == "man"    ? man_page(app)
                     : kind == "bash" ? bash_completion(app)
                     : kind == "zsh"  ? zsh_completion(app)
                                      : fish_completion(app));
  }
  return kExitOk;
}

}  // namespace

void add_manual_command(CLI::App& app, std::function<int()>& chosen) {
  const auto kind = std::make_shared<std::string>();
  CLI::App* manual =
      app.add_subcommand("manual", "Print the man page, the completion of a shell, or the names of the rigs");
  manual->group("");
  manual->add_option("KIND", *kind, "What to print")
      ->required()
      ->check(CLI::IsMember({"man", "bash", "zsh", "fish", "rigs"}));
  manual->callback([&app, kind, &chosen] { chosen = [&app, kind] { return print_manual(app, *kind); }; });
}

}  // namespace edged
