// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_many.hpp"

#include <spawn.h>
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>
#include <utility>

#include "commands.hpp"
#include "common/interrupt.hpp"
#include "common/json_text.hpp"
#include "common/status_line.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

using nlohmann::ordered_json;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TemporaryFile = std::unique_ptr<std::FILE, CloseFile>;

/// The process of one recording and its result.
struct Job {
  std::string recording, name;
  TemporaryFile output = {}, errors = {};
  pid_t process = 0;  ///< 0: not begun
  bool ended = false;
  int exit_code = 0;
  ordered_json result = {};  ///< output of --json
};

/// A folder name: "flight" of data/flight.bag, "sim_room_1" of sim:room:1.
std::string name_of(const std::string& recording) {
  const std::filesystem::path path = std::filesystem::path(recording).lexically_normal();
  std::string name = (path.has_filename() ? path : path.parent_path()).filename().string();
  if (std::filesystem::is_regular_file(path)) name = path.stem().string();
  std::ranges::replace_if(
      name, [](char c) { return c == ':' || c == ','; }, '_');
  return name;
}

std::string content_of(std::FILE* file) {
  std::rewind(file);
  std::string text;
  char block[4096];
  while (const std::size_t got = std::fread(block, 1, sizeof block, file)) text.append(block, got);
  return text;
}

void begin(Job& job, const ManyRuns& runs) {
  std::vector<std::string> words = {"edged", "run", job.recording, "--json", "--quiet"};
  words.insert(words.end(), runs.arguments.begin(), runs.arguments.end());
  if (!runs.out.empty()) words.insert(words.end(), {"--out", (runs.out / job.name).string()});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  job.output.reset(std::tmpfile());
  job.errors.reset(std::tmpfile());
  if (!job.output || !job.errors)
    throw InputError::format("no temporary file can be made: {}", std::generic_category().message(errno));
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, fileno(job.output.get()), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, fileno(job.errors.get()), STDERR_FILENO);
  const int error = posix_spawn(&job.process, "/proc/self/exe", &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw InputError::format("no process can be begun: {}", std::generic_category().message(error));
}

/// Collects its result; passes its lines on stderr on, with the recording's name.
void finish(Job& job, int status, StatusLine& line) {
  job.ended = true;
  job.exit_code = WIFSIGNALED(status) ? kExitSignalBase + WTERMSIG(status) : WEXITSTATUS(status);
  job.result = ordered_json::parse(content_of(job.output.get()), nullptr, false);
  if (!job.result.is_object())
    job.result = {{"error",
                   {{"kind", "bug"},
                    {"exit_code", job.exit_code},
                    {"message", fmt::format("ended with code {} and without a summary", job.exit_code)}}}};
  job.result["recording_path"] = job.recording;
  line.clear();
  std::string errors = content_of(job.errors.get());
  for (std::size_t end; (end = errors.find('\n')) != std::string::npos; errors.erase(0, end + 1))
    std::fprintf(stderr, "%s: %s\n", job.name.c_str(), errors.substr(0, end).c_str());
}

/// Ends all running processes, with complete files. A process that also received our signal must not get a second one.
void pass_on(int signal, const std::vector<Job>& jobs) {
  for (const Job& job : jobs)
    if (job.process != 0 && !job.ended) kill(job.process, signal == SIGINT ? SIGTERM : SIGINT);
}

void run_all(std::vector<Job>& jobs, const ManyRuns& runs) {
  StatusLine line(runs.quiet);
  bool told = false;
  while (true) {
    std::size_t ended = 0, running = 0;
    std::vector<std::string> names;
    for (Job& job : jobs) {
      int status = 0;
      if (job.process != 0 && !job.ended && waitpid(job.process, &status, WNOHANG) == job.process)
        finish(job, status, line);
      ended += job.ended ? 1 : 0;
      running += job.process != 0 && !job.ended ? 1 : 0;
      if (job.process != 0 && !job.ended) names.push_back(job.name);
    }
    const bool stop = interrupt_signal() != 0;
    if (stop && !std::exchange(told, true)) pass_on(interrupt_signal(), jobs);
    if (ended == jobs.size() || (stop && running == 0)) return;
    const auto next = std::ranges::find(jobs, 0, &Job::process);
    if (!stop && running < static_cast<std::size_t>(runs.jobs) && next != jobs.end()) {
      begin(*next, runs);
      continue;
    }
    if (line.due()) line.show(fmt::format("{} of {} done, running: {}", ended, jobs.size(), fmt::join(names, ", ")));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::string number_text(const ordered_json& value, double factor, int digits) {
  return value.is_number() ? fmt::format("{:.{}f}", factor * value.get<double>(), digits) : "-";
}

/// At most 80 columns. Errors are on stderr already.
std::string to_table(const std::vector<Job>& jobs) {
  constexpr const char* kRow = "{:<24}  {:<18}  {:>9}  {:>9}  {:>9}\n";
  std::string table = fmt::format(kRow, "recording", "status", "ATE [mm]", "path [m]", "CPU s/s");
  for (const Job& job : jobs) {
    const ordered_json& r = job.result;
    const std::string name = fit_columns(job.name, 24);
    if (!job.ended) {
      table += fmt::format(kRow, name, "not begun", "-", "-", "-");
    } else if (r.contains("error")) {
      table += fmt::format(kRow, name, "error", "-", "-", "-");
    } else {
      const ordered_json& evaluation = r["evaluation"];
      table += fmt::format(kRow, name, fit_columns(r["status"], 18), number_text(r["ate_rmse_m"], 1e3, 1),
                           number_text(evaluation.is_object() ? evaluation["path_length_m"] : evaluation, 1.0, 1),
                           number_text(r["cpu_s_per_s"], 1.0, 2));
    }
  }
  return table;
}

}  // namespace

std::vector<std::string> arguments_for_each(const CLI::App& run, const std::vector<std::string>& assignments) {
  std::vector<std::string> words;
  for (const CLI::Option* option : run.get_options()) {
    if (option->count() == 0 || option->get_lnames().empty()) continue;
    const std::string name = "--" + option->get_lnames().front();
    if (name == "--out" || name == "--jobs" || name == "--json" || name == "--quiet") continue;
    for (const std::string& value : option->results()) {
      words.push_back(name);
      if (option->get_items_expected_max() > 0) words.push_back(value);
    }
  }
  words.insert(words.end(), assignments.begin(), assignments.end());
  return words;
}

int run_many(const ManyRuns& runs) {
  std::vector<Job> jobs;
  std::set<std::string> names;
  for (const std::string& recording : runs.recordings) {
    std::error_code ignored;
    if (recording.find(':') == std::string::npos && !std::filesystem::exists(recording, ignored))
      throw InputError::format("{}: no such file or folder, and no KEY=VALUE; nothing has been run", recording);
    jobs.push_back({.recording = recording, .name = name_of(recording)});
    if (!names.insert(jobs.back().name).second && runs.force)
      throw InputError::format("two recordings are called {}: with --force one's run would replace the other's",
                               jobs.back().name);
  }
  catch_interrupts();
  run_all(jobs, runs);
  if (runs.json) {
    ordered_json list = ordered_json::array();
    for (const Job& job : jobs)
      if (job.ended) list.push_back(job.result);
    fmt::print("{}\n", json_text({{"runs", list}}));
  } else {
    fmt::print("{}", to_table(jobs));
  }
  if (interrupt_signal() != 0) return kExitSignalBase + interrupt_signal();
  const auto failed = std::ranges::find_if(jobs, [](const Job& job) { return job.exit_code != 0; });
  return failed == jobs.end() ? kExitOk : failed->exit_code;
}

}  // namespace edged
