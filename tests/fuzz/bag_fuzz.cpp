// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ROS 1 bag or an MCAP file, behind the magic that the first byte chooses, an MCAP also with a valid
// footer, so that its end is read as an index: messages, and the recording with its ground truth and intrinsics.
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>

#include "edged/core/check.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/ros/bag/open_messages.hpp"

namespace {

/// A footer, for a summary of the last `bytes`, with its checksum.
void append_footer(std::string& file, std::size_t bytes) {
  const std::size_t begin = file.size() - std::min(bytes, file.size() - edged::kMcapMagic.size());
  edged::append_number(file, std::uint8_t{2});
  edged::append_number(file, std::uint64_t{20});
  edged::append_number(file, std::uint64_t{begin});
  edged::append_number(file, std::uint64_t{0});
  const auto* summary = reinterpret_cast<const std::uint8_t*>(file.data()) + begin;
  edged::append_number(file, static_cast<std::uint32_t>(crc32_z(0, summary, file.size() - begin)));
  file += edged::kMcapMagic;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  if (size == 0) return 0;
  spdlog::set_level(spdlog::level::off);
  static const int file = memfd_create("bag", 0);
  std::string bytes(data[0] % 2 == 0 ? kBagMagic : kMcapMagic);
  bytes.append(reinterpret_cast<const char*>(data) + 1, size - 1);
  if ((data[0] & 2U) != 0 && data[0] % 2 != 0) append_footer(bytes, std::size_t{data[0]} * 8);
  const auto length = static_cast<ssize_t>(bytes.size());
  if (ftruncate(file, 0) != 0 || pwrite(file, bytes.data(), bytes.size(), 0) != length) std::abort();
  try {
    const Recording recording = open_recording("/proc/self/fd/" + std::to_string(file), nullptr, {.all_cameras = true});
    while (recording.dataset->next()) {
    }
    recording.dataset->ground_truth();
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  return 0;
}
