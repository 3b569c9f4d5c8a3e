// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a calibration of any format; what is read can be shown, and written and read again.
#include "edged/io/calibration.hpp"
#include "fuzz_support.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  Calibration calibration;
  try {
    calibration = load_calibration(file_of(as_text({data, size})), {.otherwise = Sees::Both});
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  if (describe(calibration).empty()) std::abort();
  if (!calibration.has_extrinsics) return 0;
  const Calibration again = load_calibration(file_of(to_yaml(calibration)));
  if (again.rig.cameras.size() != calibration.rig.cameras.size()) std::abort();
  return 0;
}
