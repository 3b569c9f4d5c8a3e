// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "program/program.hpp"

#include <malloc.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <span>
#include <system_error>
#include <vector>

#include "common/command.hpp"
#include "common/json_text.hpp"
#include "common/log.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

/// The error that ended the program.
struct Failure {
  int exit_code;
  const char* kind;  ///< the kind in the json output
  std::string text;
};

/// One line for the user; with --json also the documented json object on stdout.
int tell(const CLI::App& app, const Failure& failure, bool json) {
  std::fprintf(stderr, "%s: %s\n", app.get_name().c_str(), failure.text.c_str());
  if (json) {
    const nlohmann::ordered_json error = {
        {"kind", failure.kind}, {"exit_code", failure.exit_code}, {"message", failure.text}};
    std::fprintf(stdout, "%s\n", json_text({{"error", error}}).c_str());
  }
  return failure.exit_code;
}

std::vector<std::string> commands_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* inner : command.get_subcommands([](const CLI::App*) { return true; }))
    if (!inner->get_group().empty()) names.push_back(inner->get_name());
  return names;
}

std::vector<std::string> flags_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// The error in the command line, with its command.
Failure usage_failure(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  std::string called = app.get_name();
  for (auto inner = app.get_subcommands(); !inner.empty(); inner = command->get_subcommands()) {
    command = inner.front();
    called += " " + command->get_name();
  }
  const std::string see = fmt::format("see `{} --help`", called);
  for (const std::string& word : command->remaining()) {
    const bool flag = word.starts_with('-');
    const std::vector<std::string> known = flag ? flags_of(*command) : commands_of(*command);
    if (!flag && word.find(":=") != std::string::npos && command->get_option_no_throw("--remap"))
      return {kExitUsage, "usage", fmt::format("'{}': write `-r {}` for another topic; {}", word, word, see)};
    if (known.empty()) continue;
    const std::string name = word.substr(0, word.find('='));
    const std::string hint = name == "slam" ? "; did you mean 'run'?" : did_you_mean(known, name);
    return {kExitUsage, "usage", fmt::format("unknown {} '{}'{}; {}", flag ? "flag" : "command", name, hint, see)};
  }
  return {kExitUsage, "usage", fmt::format("{}; {}", error.what(), see)};
}

/// What the parser takes for a value: another option, "nan" despite bounds, and on one side of them "inf".
void refuse_odd_values(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0) continue;  // a flag
    option->check([&app](const std::string& text) {
      const bool is_option = text.starts_with("--") && app.get_option_no_throw(text) != nullptr;
      return is_option ? fmt::format("a value is missing before {}", text) : "";
    });
    if (!option->get_type_name().starts_with("FLOAT")) continue;
    option->check([](const std::string& text) {
      double value = 0.0;
      const bool infinite = CLI::detail::lexical_cast(text, value) && !std::isfinite(value);
      return infinite ? fmt::format("'{}' is not a finite number", text) : "";
    });
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) refuse_odd_values(*command);
}

/// A folder without permission, a name that is too long, a full disk: no bugs of ours.
std::string text_of(const std::filesystem::filesystem_error& error) {
  return fmt::format("{}: {}; check the path and your permissions", error.path1().string(), error.code().message());
}

/// Packets of a wide sensor are megabytes, allocated and freed thirty times a second: if returned to the system, it
/// would clear their pages each time.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
#endif
}

/// stdout is buffered: write errors show at the latest now.
void end_output() {
  if (std::fflush(stdout) != 0)
    throw InputError::format("the output cannot be written: {}", std::generic_category().message(errno));
}

/// By the standard library or by OpenCV.
bool lacks_memory(const std::exception& e) {
  const auto* image = dynamic_cast<const cv::Exception*>(&e);
  return dynamic_cast<const std::bad_alloc*>(&e) || (image && image->code == cv::Error::StsNoMem);
}

}  // namespace

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  const bool json = std::ranges::count(words, std::string_view("--json")) > 0;
  try {
    keep_freed_memory();
    cv::setNumThreads(
        1);  // one packet is too little work for several threads, and one thread keeps results reproducible
    start_logging();
    refuse_odd_values(app);
    app.parse(argc, argv);
    const int code = run();
    end_output();
    return code;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // help, version
    return tell(app, usage_failure(app, e), json);
  } catch (const InputError& e) {
    return tell(app, {kExitInput, "input", e.what()}, json);
  } catch (const std::filesystem::filesystem_error& e) {
    return tell(app, {kExitInput, "input", text_of(e)}, json);
  } catch (const std::system_error& e) {
    return tell(app, {kExitInput, "input", fmt::format("system error: {}", e.what())}, json);
  } catch (const spdlog::spdlog_ex& e) {
    return tell(app, {kExitInput, "input", fmt::format("{}; is the disk full?", e.what())}, json);
  } catch (const std::exception& e) {
    if (lacks_memory(e))
      return tell(
          app,
          {kExitInput, "input", "there is too little memory: close other programs, or raise the limit (ulimit -v)"},
          json);
    return tell(app, {kExitBug, "bug", fmt::format("internal error, please report this line: {}", e.what())}, json);
  }
}

}  // namespace edged
