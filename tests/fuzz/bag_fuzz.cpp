// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ROS 1 bag or an MCAP file, behind the magic that the first byte chooses, an MCAP also with valid
// checksums: messages, and the recording with its ground truth and intrinsics.
#include "edged/io/open_recording.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "fuzz_support.hpp"

namespace {

/// Of the chunks without compression and of the summary, as far as records follow each other.
void mend_checksums(std::string& file) {
  constexpr std::size_t kHead = 9, kChunkChecksum = 24, kChunkRecords = 40, kSummaryChecksum = 16;
  const auto number_at = [&]<typename T>(T& number, std::size_t at) {
    std::memcpy(&number, file.data() + at, sizeof number);
  };
  const auto put = [&](std::size_t at, std::size_t begin, std::size_t end) {
    const std::uint32_t sum = edged::crc_of(std::string_view(file).substr(begin, end - begin));
    std::memcpy(file.data() + at, &sum, sizeof sum);
  };
  for (std::size_t at = edged::kMcapMagic.size(); at + kHead <= file.size();) {
    const char op = file[at];
    std::uint64_t bytes = 0, summary = 0;
    number_at(bytes, at + 1);
    at += kHead;
    if (bytes > file.size() - at) return;
    std::uint32_t name_bytes = 0;  // of the compression
    if (op == 6 && bytes >= kChunkRecords) number_at(name_bytes, at + kChunkChecksum + 4);
    if (op == 6 && bytes >= kChunkRecords && name_bytes == 0) put(at + kChunkChecksum, at + kChunkRecords, at + bytes);
    if (op == 2 && bytes == 20) number_at(summary, at);
    if (op == 2 && bytes == 20 && summary < at) put(at + kSummaryChecksum, summary, at + kSummaryChecksum);
    at += bytes;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  if (size == 0) return 0;
  std::string bytes(data[0] % 2 == 0 ? kBagMagic : kMcapMagic);
  bytes.append(reinterpret_cast<const char*>(data) + 1, size - 1);
  if ((data[0] & 3U) == 3U) mend_checksums(bytes);
  try {
    const Recording recording = open_recording(file_of(bytes), nullptr, {.all_cameras = true});
    while (recording.dataset->next()) {
    }
    recording.dataset->ground_truth();
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  return 0;
}
