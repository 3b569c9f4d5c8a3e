// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a calibration of any format; what is read can be shown, and written and read again.
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"

namespace {

/// A file in memory, with a name to open it by.
std::string file_of(const void* data, std::size_t size) {
  static const int file = memfd_create("calibration", 0);
  if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  return "/proc/self/fd/" + std::to_string(file);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  spdlog::set_level(spdlog::level::off);
  Calibration calibration;
  try {
    calibration = load_calibration(file_of(data, size), {.otherwise = Sees::Both});
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  if (describe(calibration).empty()) std::abort();
  if (!calibration.has_extrinsics) return 0;
  const std::string text = to_yaml(calibration);
  const Calibration again = load_calibration(file_of(text.data(), text.size()));
  if (again.rig.cameras.size() != calibration.rig.cameras.size()) std::abort();
  return 0;
}
