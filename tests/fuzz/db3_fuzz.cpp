// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ROS 2 bag in SQLite, with the log of a recorder that was killed: the first byte counts the pages of
// the file; then follow those of the log, each behind its number and the size that ends a transaction, else zero.
#include <array>
#include <cstdio>
#include <filesystem>

#include "edged/io/open_recording.hpp"
#include "fuzz_support.hpp"

namespace {

constexpr std::size_t kPage = 512;

/// With valid checksums, each of all that precedes it.
std::string log_of(edged::ByteSpan frames) {
  using edged::big_endian;
  constexpr std::uint32_t kLittleEndianSums = 0x377f0682, kVersion = 3007000;
  std::array<std::uint32_t, 2> sum{};
  const auto summed = [&sum](const std::string& bytes) {
    for (std::size_t i = 0; i < bytes.size(); i += sizeof sum) {
      std::array<std::uint32_t, 2> words{};
      std::memcpy(words.data(), bytes.data() + i, sizeof words);
      sum[0] += words[0] + sum[1];
      sum[1] += words[1] + sum[0];
    }
    return big_endian(sum[0]) + big_endian(sum[1]);
  };
  const std::string salt(8, '\0');
  std::string log = big_endian(kLittleEndianSums) + big_endian(kVersion) + big_endian(kPage) + big_endian(0) + salt;
  log += summed(log);
  for (; frames.size() >= 2 + kPage; frames = frames.subspan(2 + kPage)) {
    const std::string head = big_endian(frames[0]) + big_endian(frames[1]);
    const std::string page(edged::as_text(frames.subspan(2, kPage)));
    log += head + salt + summed(head + page) + page;
  }
  return log;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  spdlog::set_level(spdlog::level::off);
  if (size == 0) return 0;
  const std::size_t pages = std::min(kPage * data[0], size - 1);
  const ByteSpan bytes(data + 1, size - 1);
  static const std::string file =
      std::filesystem::temp_directory_path() / ("edged_fuzz_" + std::to_string(getpid()) + ".db3");
  std::ofstream(file, std::ios::binary) << as_text(bytes.first(pages));
  std::ofstream(file + "-wal", std::ios::binary) << log_of(bytes.subspan(pages));
  try {
    const Recording recording = open_recording(file, nullptr, {.all_cameras = true});
    while (recording.dataset->next()) {
    }
    recording.dataset->ground_truth();
  } catch (const InputError&) {  // the one refusal that is allowed
  }
  std::remove(file.c_str());
  std::remove((file + "-wal").c_str());
  return 0;
}
