// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whole recordings on disk: events per second read and written on one core, by format, with frames and IMU samples
// where the format holds them.
#include <benchmark/benchmark.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <filesystem>

#include "edged/io/open_recording.hpp"
#include "edged/io/write_recording.hpp"
#include "edged/live/test_storm.hpp"

namespace edged {
namespace {

/// Half a second of four million events a second at random pixels of 640 x 480, a frame every 40 ms, IMU at 1 kHz.
EventStorm generated_storm() { return {"events", "frames", cv::Size(640, 480), 4e6, 500}; }

class BenchFile {
 public:
  explicit BenchFile(const WritableFormat& format)
      : path_(std::filesystem::temp_directory_path() /
              ("edged_bench_" + std::to_string(getpid()) + std::string(format.extension))) {}
  ~BenchFile() { remove(); }
  BenchFile(const BenchFile&) = delete;
  BenchFile& operator=(const BenchFile&) = delete;
  const std::filesystem::path& path() const { return path_; }
  void remove() const {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

 private:
  std::filesystem::path path_;
};

void read_recording(benchmark::State& state, const WritableFormat& format) {
  spdlog::set_level(spdlog::level::off);
  const BenchFile file(format);
  EventStorm storm = generated_storm();
  write_recording(storm, format, file.path(), std::nullopt);
  for (auto _ : state) {
    const Recording recording = open_recording(file.path());
    std::size_t events = 0;
    while (const auto measurement = recording.dataset->next())
      if (const auto* batch = std::get_if<EventBatch>(&*measurement)) events += batch->events.size();
    if (events != storm.events()) state.SkipWithError("events are missing");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(storm.events()));
}

void write_recording_as(benchmark::State& state, const WritableFormat& format) {
  const BenchFile file(format);
  std::size_t events = 0;
  for (auto _ : state) {
    EventStorm storm = generated_storm();
    write_recording(storm, format, file.path(), std::nullopt);
    events = storm.events();
    file.remove();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(events));
}

const bool kRegistered = [] {
  for (const WritableFormat& format : writable_formats()) {
    const std::string name(format.name);
    benchmark::RegisterBenchmark(("read_recording/" + name).c_str(), read_recording, format)
        ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("write_recording/" + name).c_str(), write_recording_as, format)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace edged
