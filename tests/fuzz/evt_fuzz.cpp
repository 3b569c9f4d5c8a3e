// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes through the Prophesee decoders: the first byte chooses the format, the second the length of the chunks.
#include <algorithm>
#include <cstdlib>

#include "edged/io/parse/evt.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  if (size < 2) return 0;
  constexpr int kWidth = 640, kHeight = 480;
  EvtDecoder decoder(static_cast<EvtFormat>(data[0] % 6), kWidth, kHeight);
  const std::size_t chunk = 1 + std::size_t{data[1]};
  std::vector<Event> events;
  for (std::size_t at = 2; at < size; at += chunk) decoder.decode({data + at, std::min(chunk, size - at)}, events);
  for (const Event& event : events)
    if (event.x >= kWidth || event.y >= kHeight) std::abort();
  return 0;
}
