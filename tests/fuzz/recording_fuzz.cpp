// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a recording in one file (Prophesee RAW and DAT, AEDAT 2.0, 3.1 and 4, zip, text): opened by content and
// read through.
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>

#include "edged/core/check.hpp"
#include "edged/io/open_recording.hpp"

namespace {

/// A file in memory, with a name to open it by.
int file_of(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("recording", 0);
  if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  spdlog::set_level(spdlog::level::off);
  const std::string name = "/proc/self/fd/" + std::to_string(file_of(data, size));
  try {
    const Recording recording = open_recording(name, nullptr, {.geometry = cv::Size(640, 480), .all_cameras = true});
    while (recording.dataset->next()) {
    }
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  return 0;
}
