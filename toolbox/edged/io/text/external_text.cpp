// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/external_text.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/text/dataset_with_lines.hpp"

namespace edged {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::infinity();

/// The columns of a line, and the factors to SI units.
struct ExternalForm {
  std::size_t t = 0;
  std::optional<TimeUnit> unit = std::nullopt;  ///< of the stamps, if known
  std::vector<std::size_t> values;
  std::vector<double> scales;
  std::vector<std::size_t> sigmas;  ///< none, one for all values, or one each
  bool open_end = false;            ///< all numbers after the values are sigmas
};

/// The factor to the unit of the sensor. Nothing for an unknown unit.
std::optional<double> external_scale(std::string_view unit, std::string_view wanted) {
  static const std::map<std::string_view, double> lengths = {{"m", 1.0},     {"cm", 0.01},   {"mm", 0.001},
                                                             {"km", 1000.0}, {"ft", 0.3048}, {"feet", 0.3048}};
  static const std::map<std::string_view, double> speeds = {
      {"m/s", 1.0}, {"cm/s", 0.01}, {"mm/s", 0.001}, {"ft/s", 0.3048}, {"km/h", 1.0 / 3.6}, {"kn", 1852.0 / 3600.0}};
  const auto& known = wanted == "m" ? lengths : speeds;
  const auto found = known.find(unit);
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

/// Splits "vx [m/s]" into "vx" and "m/s".
std::pair<std::string, std::string> name_and_unit(const std::string& column) {
  const std::string lower = lower_case(column);
  const std::size_t open = lower.find_first_of("[("), close = lower.find_first_of("])");
  std::string name = lower.substr(0, open);
  std::erase_if(name, [](char c) { return c == ' ' || c == '"' || c == '#' || c == '%'; });
  if (open == std::string::npos || close == std::string::npos || close < open) return {name, ""};
  return {name, lower.substr(open + 1, close - open - 1)};
}

bool is_time(const std::string& name) {
  return name == "t" || name == "time" || name == "timestamp" || name == "stamp" || name == "ts";
}

/// The unit of stamps without a named one: seconds, since 1970 or since the start, have at most ten digits.
TimeUnit unit_by_size(double stamp) {
  if (std::abs(stamp) < 1e11) return TimeUnit::Seconds;
  if (std::abs(stamp) < 1e14) return TimeUnit::Milliseconds;
  return std::abs(stamp) < 1e17 ? TimeUnit::Microseconds : TimeUnit::Nanoseconds;
}

std::string heading_wanted(const ExternalSensor& sensor) {
  std::string heading = "t[s]";
  for (const std::string_view column : sensor.columns) heading += fmt::format(",{}[{}]", column, sensor.unit);
  return heading + ",sigma";
}

/// The first line that is not empty, and the first that begins with a number.
std::pair<std::string, std::string> external_head(const SourcePath& file) {
  std::pair<std::string, std::string> head;
  BlockReader blocks(file, 64 * 1024);
  std::string_view block = blocks.next();
  for (std::size_t end; (end = block.find('\n')) != std::string_view::npos; block.remove_prefix(end + 1)) {
    const std::string_view line = block.substr(0, end);
    FieldReader fields(line);
    const std::string_view first = fields.next();
    if (first.empty()) continue;
    if (parse_number(first)) {
      head.second = line;
      return head;
    }
    if (head.first.empty() || !line.starts_with('#')) head.first = line;
  }
  return head;
}

/// Nothing if the line is a comment that names no column.
std::optional<ExternalForm> form_by_heading(const std::string& heading, const ExternalSensor& sensor,
                                            const SourcePath& file) {
  const auto refuse = [&](const std::string& what) {
    return InputError::format("{}: line 1: `{}` {}; name the columns, such as `{}`", file.string(), heading, what,
                              heading_wanted(sensor));
  };
  ExternalForm form;
  std::optional<std::size_t> t;
  std::map<std::string, std::pair<std::size_t, std::string>> places;
  std::size_t place = 0;
  for (const std::string& column : heading_fields(heading)) {
    auto [name, column_unit] = name_and_unit(column);
    if (name.empty()) continue;  // a '#' by itself
    if (is_time(name) && !t) {
      t = place;
      form.unit = parse_time_unit(column_unit);
    }
    places.try_emplace(name, place++, column_unit);
  }
  const bool comment = heading.starts_with('#');
  for (const std::string_view column : sensor.columns) {
    const auto found = places.find(std::string(column));
    if (found == places.end()) {
      if (comment) return std::nullopt;
      throw refuse(fmt::format("has no column {}", column));
    }
    const std::string& said = found->second.second;
    const auto scale = said.empty() ? 1.0 : external_scale(said, sensor.unit);
    if (!scale) throw refuse(fmt::format("has {} in {}, which is not known", column, said));
    form.values.push_back(found->second.first);
    form.scales.push_back(*scale);
    const auto own = places.find("sigma_" + std::string(column));
    if (own != places.end()) form.sigmas.push_back(own->second.first);
  }
  if (!t) {
    if (comment) return std::nullopt;
    throw refuse("has no column t");
  }
  if (form.sigmas.size() != form.values.size()) form.sigmas.clear();
  if (const auto one = places.find("sigma"); form.sigmas.empty() && one != places.end())
    form.sigmas = {one->second.first};
  form.t = *t;
  return form;
}

ExternalForm external_form(const ExternalSensor& sensor, const SourcePath& file) {
  const auto [heading, first] = external_head(file);
  std::optional<ExternalForm> named = heading.empty() ? std::nullopt : form_by_heading(heading, sensor, file);
  if (!named) {
    named.emplace();
    for (std::size_t i = 0; i < sensor.columns.size(); ++i) named->values.push_back(i + 1);
    named->scales.assign(sensor.columns.size(), 1.0);
    named->open_end = true;
  }
  FieldReader fields(first);
  for (std::size_t i = 0; i < named->t; ++i) fields.next();
  if (!named->unit) named->unit = unit_by_size(parse_number(fields.next()).value_or(0.0));
  return *named;
}

/// A finite number, 0 for an empty field, infinity for a value that is not measured.
std::optional<double> sigma_of(std::string_view field) {
  if (field.empty()) return 0.0;
  if (lower_case(field) == "inf" || lower_case(field) == "infinity") return kNotMeasured;
  const auto sigma = parse_number(field);
  return sigma && *sigma >= 0.0 ? sigma : std::nullopt;
}

std::optional<ExternalSample> parse_external(std::string_view line, const ExternalSensor& sensor,
                                             const ExternalForm& form) {
  std::vector<std::string_view> fields;
  for (FieldReader reader(line); !reader.rest().empty();) fields.push_back(reader.next());
  const std::size_t n = form.values.size();
  std::vector<std::size_t> sigmas = form.sigmas;
  if (form.open_end)
    for (std::size_t i = n + 1; i < fields.size(); ++i) sigmas.push_back(i);
  if (!sigmas.empty() && sigmas.size() != 1 && sigmas.size() != n) return std::nullopt;
  const auto field = [&fields](std::size_t i) { return i < fields.size() ? fields[i] : std::string_view(); };
  const std::optional<Timestamp> t = parse_stamp(field(form.t), form.unit.value_or(TimeUnit::Seconds));
  if (!t) return std::nullopt;
  ExternalNumbers numbers{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    const std::string_view text = field(form.values[i]);
    const auto value = parse_number(text);
    if (!value && lower_case(text) != "nan") return std::nullopt;
    const auto sigma = sigmas.empty() ? 0.0 : sigma_of(field(sigmas.size() == 1 ? sigmas[0] : sigmas[i]));
    if (!sigma) return std::nullopt;
    numbers.values[i] = form.scales[i] * value.value_or(0.0);
    numbers.sigmas[i] = value ? form.scales[i] * *sigma : kNotMeasured;
  }
  ExternalSample sample = sensor.sample(*t, numbers);
  return is_plausible(sample) ? std::optional(std::move(sample)) : std::nullopt;
}

bool is_sample_of(const Measurement& measurement, const ExternalSensor& sensor) {
  const auto* sample = std::get_if<ExternalSample>(&measurement);
  return sample != nullptr && &sensor_of(*sample) == &sensor;
}

}  // namespace

std::unique_ptr<Dataset> with_external_file(std::unique_ptr<Dataset> recording, const ExternalSensor& sensor,
                                            const SourcePath& file) {
  const ExternalForm form = external_form(sensor, file);
  const std::string name(sensor.name);
  const auto parse = [form, &sensor](std::string_view line) { return parse_external(line, sensor, form); };
  DatasetInfo info = recording->info();
  if (std::ranges::count(info.external, name) > 0)
    spdlog::warn(fmt::format("{}: its own {} samples are left out for {}", info.name, name, file.string()));
  else
    info.external.push_back(name);
  std::erase_if(info.streams, [&name](const StreamInfo& stream) { return stream.role == name; });
  info.streams.push_back({file.string(), layout_of(sensor), 0, name});
  const StampedLines<ExternalSample>::Spec lines{file, name, layout_of(sensor), LastLine::MustEnd, parse};
  return std::make_unique<DatasetWithLines<ExternalSample>>(
      std::move(recording), lines, std::move(info),
      [&sensor](const Measurement& measurement) { return is_sample_of(measurement, sensor); });
}

std::unique_ptr<Dataset> with_external_files(std::unique_ptr<Dataset> recording, const SourcePath& folder) {
  for (const ExternalSensor& sensor : external_sensors()) {
    const std::string name(sensor.name);
    for (const SourcePath& file :
         {folder / (name + ".txt"), folder / (name + ".csv"), folder / (name + "0") / "data.csv"}) {
      if (!file.is_file()) continue;
      recording = with_external_file(std::move(recording), sensor, file);
      break;
    }
  }
  return recording;
}

std::set<std::string> external_file_names() {
  std::set<std::string> names;
  for (const ExternalSensor& sensor : external_sensors())
    for (const char* ending : {".txt", ".csv", "0"}) names.insert(std::string(sensor.name) + ending);
  return names;
}

}  // namespace edged
