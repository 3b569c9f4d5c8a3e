// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Decoding of the Prophesee formats: events per second on one core, from memory in blocks of 256 KiB.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "edged/io/parse/evt_test_support.hpp"

namespace edged {
namespace {

/// Argument: the EvtFormat. Generated events, in rows of up to 20 neighbours.
void decode_evt(benchmark::State& state) {
  constexpr std::size_t kStreamEvents = 1'000'000, kBlock = 262144;
  const auto format = static_cast<EvtFormat>(state.range(0));
  const std::string bytes = AnyEvtEncoder(format).encode(generated_events(kStreamEvents, 1280, 720, 2));
  std::vector<Event> events;
  for (auto _ : state) {
    EvtDecoder decoder(format, 1280, 720);
    std::size_t count = 0;
    for (std::size_t at = 0; at < bytes.size(); at += kBlock) {
      events.clear();
      decoder.decode(as_bytes(bytes).subspan(at, std::min(kBlock, bytes.size() - at)), events);
      count += events.size();
    }
    if (count != kStreamEvents) state.SkipWithError("events are missing");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kStreamEvents));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes.size()));
}
BENCHMARK(decode_evt)->DenseRange(0, 5)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace edged
