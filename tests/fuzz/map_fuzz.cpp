// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a saved map, behind a head that fits them: what is refused is refused in one line, what is taken is
// written again as it was.
#include <cstdlib>
#include <string>

#include "edged/core/check.hpp"
#include "edged/map/saved_map.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  const std::string body(reinterpret_cast<const char*>(data), size);
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (std::size_t i = 0; i < size; ++i) sum = (sum ^ data[i]) * 0x100000001b3U;
  std::string bytes = "edged map\n";
  const std::uint32_t version = 1;
  bytes.append(reinterpret_cast<const char*>(&version), sizeof version);
  bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
  try {
    const SavedMap map = saved_map_from_bytes(bytes + body);
    if (saved_map_from_bytes(to_bytes(map)).keyframes.size() != map.keyframes.size()) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
