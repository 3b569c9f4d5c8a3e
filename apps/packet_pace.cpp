// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "packet_pace.hpp"

#include <spdlog/fmt/fmt.h>

#include <limits>

#include "edged/io/text.hpp"

namespace edged {

PaceWriter::PaceWriter(const std::filesystem::path& folder) : out_(folder / "pace.csv") {
  out_ << "t_ns,processing_ms,latency_ms\n" << std::flush;
}

void PaceWriter::add(Timestamp t, const PacketPace& pace) {
  out_ << fmt::format("{},{:.3f},{}\n", to_ns(t), pace.processing_ms,
                      pace.latency_ms ? fmt::format("{:.3f}", *pace.latency_ms) : "")
       << std::flush;
}

void read_pace(const std::filesystem::path& folder, StatesTable& states) {
  const std::filesystem::path file = folder / "pace.csv";
  if (!std::filesystem::exists(file)) return;
  std::vector<double> processing(states.t.size(), std::numeric_limits<double>::quiet_NaN()), latency = processing;
  LineReader lines(file);
  lines.next();
  for (std::size_t row = 0; row < states.t.size();) {
    const auto line = lines.next();
    if (!line) break;
    FieldReader fields(line->text);
    if (parse_nanoseconds(fields.next()) != states.t[row]) continue;  // a kill may have left half a line
    if (const auto number = parse_number(fields.next())) processing[row] = *number;
    if (const auto number = parse_number(fields.next())) latency[row] = *number;
    ++row;
  }
  states.columns["processing_ms"] = std::move(processing);
  states.columns["latency_ms"] = std::move(latency);
}

}  // namespace edged
