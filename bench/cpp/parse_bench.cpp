// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reading of events.txt: events per second on one core, the file being in the page cache.
#include <benchmark/benchmark.h>
#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "edged/io/text/event_text.hpp"

namespace edged {
namespace {

constexpr int kEvents = 1'000'000;

/// A generated events.txt with stamps of 9 decimals, removed at the end of the program.
class EventFile {
 public:
  explicit EventFile(std::int64_t start_s)
      : path_(std::filesystem::temp_directory_path() / fmt::format("edged_bench_{}_{}.txt", start_s, ::getpid())) {
    std::mt19937_64 random(1);
    fmt::memory_buffer text;
    std::int64_t ns = 0;
    for (int i = 0; i < kEvents; ++i) {
      ns += static_cast<std::int64_t>(random() % 2000);
      fmt::format_to(std::back_inserter(text), "{}.{:09} {} {} {}\n", start_s + ns / 1'000'000'000, ns % 1'000'000'000,
                     random() % 240, random() % 180, random() % 2);
    }
    std::ofstream(path_, std::ios::binary).write(text.data(), static_cast<std::streamsize>(text.size()));
    bytes_ = static_cast<std::int64_t>(text.size());
  }
  ~EventFile() { std::filesystem::remove(path_); }
  EventFile(const EventFile&) = delete;
  EventFile& operator=(const EventFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::int64_t bytes() const { return bytes_; }

 private:
  std::filesystem::path path_;
  std::int64_t bytes_ = 0;
};

/// Argument: the second at which the recording starts (0, or Unix time). Batches of 1 ms, as an IMU at 1 kHz cuts them.
void read_events_text(benchmark::State& state) {
  const EventFile file(state.range(0));
  for (auto _ : state) {
    Repairs repairs;
    EventTextStream stream(file.path(), {}, 240, 180, repairs);
    std::size_t events = 0;
    while (const Event* first = stream.peek())
      events += stream.take_before(first->t + std::chrono::milliseconds(1)).size();
    if (events != kEvents) state.SkipWithError("events are missing");
  }
  state.SetItemsProcessed(state.iterations() * kEvents);
  state.SetBytesProcessed(state.iterations() * file.bytes());
}
BENCHMARK(read_events_text)->Arg(0)->Arg(1'468'939'993)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace edged
