// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "external_log.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "edged/core/measurement_stamps.hpp"
#include "edged/io/text.hpp"

namespace edged {

void ExternalLog::add(const Measurement& measurement) {
  const auto* sample = std::get_if<ExternalSample>(&measurement);
  if (sample == nullptr) return;
  const ExternalSensor& sensor = sensor_of(*sample);
  if (!out_.is_open()) {
    out_.open(file_);
    out_ << "sensor,t_ns,values,sigmas\n";
  }
  const ExternalNumbers numbers = sensor.numbers(*sample);
  out_ << fmt::format("{},{},{},{}\n", sensor.name, to_ns(time_of(*sample)), fmt::join(numbers.values, ","),
                      fmt::join(numbers.sigmas, ","));
  ++counts_[std::string(sensor.name)];
}

nlohmann::ordered_json external_json(const std::filesystem::path& folder, Timestamp origin, std::size_t most) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const std::filesystem::path file = folder / "external.csv";
  if (!std::filesystem::exists(file)) return json;
  std::map<std::string, std::vector<std::pair<double, double>>> samples;
  LineReader lines(file);
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    const ExternalSensor* sensor = find_external_sensor(fields.next());
    const auto t = parse_nanoseconds(fields.next());
    if (!sensor || !t) continue;  // the heading, or half a line that a kill has left
    double first = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < sensor->columns.size(); ++i) {
      const double value = parse_number(fields.next()).value_or(0.0);
      if (i == 0) first = value;
      squares += value * value;
    }
    samples[std::string(sensor->name)].emplace_back(to_seconds(*t - origin),
                                                    sensor->columns.size() == 1 ? first : std::sqrt(squares));
  }
  for (const auto& [sensor, all] : samples) {
    const std::size_t stride = all.size() / std::max<std::size_t>(1, most) + 1;
    for (std::size_t i = 0; i < all.size(); i += stride) {
      json[sensor]["t"].push_back(std::round(1e4 * all[i].first) / 1e4);
      json[sensor]["y"].push_back(std::round(1e4 * all[i].second) / 1e4);
    }
  }
  return json;
}

}  // namespace edged
