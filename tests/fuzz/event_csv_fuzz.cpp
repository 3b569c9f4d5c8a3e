// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a plain event file: its form found, then read through in every unit that the first byte may choose.
#include "edged/io/text/event_text.hpp"
#include "fuzz_support.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  if (size < 1) return 0;
  const std::string name = file_of(as_text({data + 1, size - 1}));
  constexpr TimeUnit kUnits[] = {TimeUnit::Nanoseconds, TimeUnit::Microseconds, TimeUnit::Milliseconds,
                                 TimeUnit::Seconds};
  const cv::Size sensor(640, 480);
  try {
    const auto form = find_event_form(name);
    if (!form) return 0;
    std::ignore = guess_time_unit(form->stamps);
    const Recording recording =
        open_event_csv(name, *form, nullptr, {.geometry = sensor, .time_unit = kUnits[data[0] % 4]});
    Timestamp before = Timestamp::min();
    while (const auto measurement = recording.dataset->next())
      for (const Event& event : std::get<EventBatch>(*measurement).events) {
        if (event.x >= sensor.width || event.y >= sensor.height || event.t < before) std::abort();
        before = event.t;
      }
  } catch (const InputError&) {
    return 0;  // the one refusal that is allowed
  }
  return 0;
}
