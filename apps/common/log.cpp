// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/log.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <mutex>
#include <utility>

#include "common/status_line.hpp"

namespace edged {
namespace {

constexpr std::size_t kKeptLines = 1000;

std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt>& kept_lines() {
  static auto sink = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(kKeptLines);
  return sink;
}

}  // namespace

void start_logging() {
  const auto to_stderr = std::make_shared<StderrSink>();
  to_stderr->set_level(spdlog::level::warn);
  const spdlog::sinks_init_list sinks = {to_stderr, kept_lines()};
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("edged", sinks));
  spdlog::set_level(spdlog::level::info);
}

void show_progress_in_log() { spdlog::default_logger()->sinks().front()->set_level(spdlog::level::info); }

void attach_log_file(const std::filesystem::path& file) {
  const auto to_file = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string(), true);
  to_file->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
  for (const auto& line : kept_lines()->last_raw()) to_file->log(line);
  spdlog::set_error_handler([](const std::string&) {});  // such as a full disk, which the writers of results report
  auto& sinks = spdlog::default_logger()->sinks();
  std::erase(sinks, std::static_pointer_cast<spdlog::sinks::sink>(kept_lines()));
  sinks.push_back(to_file);
  spdlog::flush_on(spdlog::level::info);
}

class HeldWarnings::Sink : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(lines_, {});
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    lines_.emplace_back(message.payload.data(), message.payload.size());
  }
  void flush_() override {}

 private:
  std::vector<std::string> lines_;
};

HeldWarnings::HeldWarnings() : sink_(std::make_shared<Sink>()), before_(spdlog::default_logger()->sinks()) {
  sink_->set_level(spdlog::level::warn);
  spdlog::default_logger()->sinks() = {sink_};
}

HeldWarnings::~HeldWarnings() {
  spdlog::default_logger()->sinks() = before_;
  for (const std::string& line : sink_->take()) spdlog::warn(line);
}

std::vector<std::string> HeldWarnings::take() { return sink_->take(); }

}  // namespace edged
