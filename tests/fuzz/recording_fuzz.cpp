// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a recording in one file (Prophesee RAW and DAT, Event Stream, AEDAT 2.0, 3.1 and 4, zip, text): opened
// by content and read through.
#include "edged/io/open_recording.hpp"
#include "fuzz_support.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  const std::string name = file_of(as_text({data, size}));
  try {
    const Recording recording = open_recording(name, nullptr, {.geometry = cv::Size(640, 480), .all_cameras = true});
    while (recording.dataset->next()) {
    }
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  return 0;
}
