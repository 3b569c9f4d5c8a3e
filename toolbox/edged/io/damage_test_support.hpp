// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads recordings that are cut or have flipped bits, for the tests of all formats.
#pragma once

#include <algorithm>
#include <map>

#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"

namespace edged {

/// What is read of a damaged recording, up to its refusal if it is refused.
struct DamagedRead {
  std::vector<Event> events;
  std::map<std::string, std::size_t> repairs;
  std::string refusal;  ///< "" for none
};

/// Reads a file of these bytes as a recording, with its ground truth. A refusal must be one line.
inline DamagedRead read_damaged(const TempFolder& folder, const std::string& bytes,
                                const RecordingOptions& options = {}) {
  const auto file = folder.write("damaged", bytes);
  DamagedRead read;
  read.refusal = input_error([&] {
    const Recording recording = open_recording(file, nullptr, options);
    read.events = read_all(*recording.dataset).events;
    read.repairs = recording.dataset->repairs();
    recording.dataset->ground_truth();
  });
  EXPECT_EQ(read.refusal.find('\n'), std::string::npos) << read.refusal;
  return read;
}

inline std::string cut_at(const std::string& bytes, std::size_t percent) {
  return bytes.substr(0, bytes.size() * percent / 100);
}

/// The bytes with flipped bits in [from, to).
inline std::string flip_bits(std::string bytes, std::mt19937& random, std::size_t from, std::size_t to, int count = 1) {
  for (int i = 0; i < count; ++i) bytes[from + random() % (to - from)] ^= static_cast<char>(1U << random() % 8);
  return bytes;
}

/// Cuts a recording at 0 to 99 %. Each time, what is read must be the beginning of its events, the longer the later the
/// cut. Returns how many are read in the end.
inline std::size_t expect_beginnings(const TempFolder& folder, const std::string& whole,
                                     const std::vector<Event>& events) {
  std::size_t before = 0;
  for (std::size_t percent = 0; percent < 100; ++percent) {
    const DamagedRead read = read_damaged(folder, cut_at(whole, percent));
    EXPECT_TRUE(read.events.size() <= events.size() &&
                std::equal(read.events.begin(), read.events.end(), events.begin()))
        << percent;
    EXPECT_GE(read.events.size(), before) << percent << " %: " << read.refusal;
    before = read.events.size();
  }
  return before;
}

}  // namespace edged
