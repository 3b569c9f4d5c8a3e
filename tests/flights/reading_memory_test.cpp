// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Recordings of a gigabyte, or of a hundred million events, are written and read in little memory, whatever the format.
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "edged/io/open_recording.hpp"
#include "edged/io/write_recording.hpp"
#include "edged/live/test_storm.hpp"
#include "memory_use.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

constexpr double kWantedBytes = 1e9;  // on disk
constexpr int kLongest_ms = 100'000;  // a hundred million events, 1.6 GB in memory: where packing leaves less on disk
constexpr double kMostMegabytes = 100.0;  // what readers hold: a second of the recording at most, chunks, buffers

double bytes_on_disk(const fs::path& path) {
  if (!fs::is_directory(path)) return static_cast<double>(fs::file_size(path));
  double bytes = 0.0;
  for (const auto& entry : fs::recursive_directory_iterator(path))
    if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
  return bytes;
}

class GigabyteRecordings : public ::testing::TestWithParam<WritableFormat> {
 protected:
  void TearDown() override { fs::remove_all(path_); }

  /// Peak of memory above what was used before [MB].
  double write(int duration_ms) {
    const double before = resident_mb();
    double most = before;
    EventStorm storm("events", "frames", cv::Size(640, 480), 1e6, duration_ms);
    events_ = storm.events();
    fs::remove_all(path_);
    write_recording(storm, GetParam(), path_, std::nullopt,
                    {.round = false, .progress = [&most](Timestamp) { most = std::max(most, resident_mb()); }});
    return most - before;
  }

  fs::path path_ =
      fs::temp_directory_path() / ("edged_gigabyte_" + std::to_string(getpid()) + std::string(GetParam().extension));
  std::size_t events_ = 0;
};

TEST_P(GigabyteRecordings, AreWrittenAndReadInLittleMemory) {
  spdlog::set_level(spdlog::level::off);
  constexpr int kProbe_ms = 2000;
  write(kProbe_ms);
  const int duration_ms =
      std::min(kLongest_ms, static_cast<int>(1.02 * kProbe_ms * kWantedBytes / bytes_on_disk(path_)));
  EXPECT_LT(write(duration_ms), kMostMegabytes);
  EXPECT_TRUE(duration_ms == kLongest_ms || bytes_on_disk(path_) > kWantedBytes);

  const double before = resident_mb();
  double most = before;
  const Recording recording = open_recording(path_);
  std::size_t events = 0, measurements = 0;
  while (const auto measurement = recording.dataset->next()) {
    if (const auto* batch = std::get_if<EventBatch>(&*measurement)) events += batch->events.size();
    if (++measurements % 1000 == 0) most = std::max(most, resident_mb());
  }
  EXPECT_EQ(events, events_);
  EXPECT_LT(most - before, kMostMegabytes);
}

INSTANTIATE_TEST_SUITE_P(All, GigabyteRecordings,
                         ::testing::ValuesIn(writable_formats().begin(), writable_formats().end()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace edged
