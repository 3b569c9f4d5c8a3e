// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/sample_files.hpp"

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
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/core/replaced_streams.hpp"
#include "edged/io/parse/imu_table.hpp"

namespace edged {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::infinity();

/// A recording with the samples of a text file.
template <typename T>
class WithTextSamples final : public WithSamples {
 public:
  WithTextSamples(std::unique_ptr<Dataset> recording, const typename StampedLines<T>::Spec& lines, DatasetInfo info,
                  Predicate replaced)
      : WithSamples(std::move(recording), std::move(replaced)), info_(std::move(info)), samples_(lines, text_repairs_) {
    if (!samples_.peek())
      throw InputError::format("{}: holds no readable line; a line is `{}`", lines.file.string(), lines.layout);
  }

  /// Throws InputError if the two do not overlap. what_to_do: the end of the message.
  void check_clock(const typename StampedLines<T>::Spec& lines, std::string_view what_to_do) {
    if (const Measurement* other = info_.begin ? nullptr : peek_recording()) info_.begin = first_stamp(*other);
    if (!info_.begin) return;
    const std::optional<Timestamp> end = lines.last_stamp();
    const Timestamp first = time_of(*samples_.peek());
    if ((end && *end < *info_.begin) || (info_.end && first > *info_.end))
      throw InputError::format("{}: is on another clock: it holds {} to {} s, the recording {} to {} s; {}",
                               lines.file.string(), format_seconds(first), end ? format_seconds(*end) : "?",
                               format_seconds(*info_.begin), info_.end ? format_seconds(*info_.end) : "?", what_to_do);
  }

  const DatasetInfo& info() const override { return info_; }

  std::map<std::string, std::size_t> repairs() const override {
    auto all = recording_->repairs();
    for (const auto& [kind, count] : text_repairs_.counts()) all[kind] += count;
    return all;
  }

 private:
  std::optional<Timestamp> next_stamp() override {
    return samples_.peek() ? std::optional(time_of(*samples_.peek())) : std::nullopt;
  }
  Measurement pop_sample() override { return samples_.pop(); }

  DatasetInfo info_;
  Repairs text_repairs_;
  StampedLines<T> samples_;
};

/// The columns of a line: time and values, and those of the sigmas.
struct ExternalTable {
  TextTable columns;
  std::vector<std::size_t> sigmas = {};  ///< none, one for all values, or one each
  bool sigmas_follow = false;            ///< all numbers after the values are sigmas
};

/// The factor to the unit of the sensor, 1 for no unit. Nothing for an unknown one.
std::optional<double> external_scale(std::string_view unit, const ExternalSensor& sensor) {
  if (unit.empty() || unit == sensor.unit) return 1.0;
  const auto found = std::ranges::find(sensor.other_units, unit, &std::pair<std::string_view, double>::first);
  return found == sensor.other_units.end() ? std::nullopt : std::optional(found->second);
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

/// Places of the columns with these words in their names.
class Places {
 public:
  explicit Places(const HeadingLine& heading) {
    for (const std::string& field : heading_fields(heading.text)) names_.push_back(column_name(field));
  }

  const ColumnName& operator[](std::size_t place) const { return names_[place]; }
  std::optional<std::size_t> of(const std::function<bool(const ColumnName&)>& fits) const {
    const auto found = std::ranges::find_if(names_, fits);
    return found == names_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - names_.begin()));
  }
  std::optional<std::size_t> of(const std::vector<std::string>& words) const {
    return of([&words](const ColumnName& name) { return name.words == words; });
  }

 private:
  std::vector<ColumnName> names_;
};

/// Nothing if the line is a comment that does not name all columns.
std::optional<ExternalTable> table_by_heading(const HeadingLine& heading, const ExternalSensor& sensor,
                                              const SourcePath& file, std::optional<TimeUnit>& unit) {
  const auto refuse = [&](const std::string& what) {
    return InputError::format("{}:{}: `{}` {}; name the columns, such as `{}`", file.string(), heading.number,
                              heading.text, what, heading_wanted(sensor));
  };
  const Places places(heading);
  ExternalTable table;
  const auto t = places.of(names_time);
  if (t) unit = time_unit_of(places[*t]);
  table.columns.at = {t.value_or(0)};
  for (const std::string_view column : sensor.columns) {
    const std::string name(column);
    const auto value = places.of({name});
    if (!value && heading.comment) return std::nullopt;
    if (!value) throw refuse("has no column " + name);
    const std::string& said = places[*value].unit;
    const auto scale = external_scale(said, sensor);
    if (!scale) throw refuse(fmt::format("has {} in {}, which is not known", column, said));
    table.columns.at.push_back(*value);
    table.columns.scales.push_back(*scale);
    if (const auto own = places.of({"sigma", name})) table.sigmas.push_back(*own);
  }
  if (!t && heading.comment) return std::nullopt;
  if (!t) throw refuse("has no column t");
  if (table.sigmas.size() != sensor.columns.size()) table.sigmas.clear();
  if (const auto one = places.of({"sigma"}); table.sigmas.empty() && one) table.sigmas = {*one};
  return table;
}

/// The columns of the last line above the data that is no comment, else of the first comment, else of layout_of().
ExternalTable external_table(const ExternalSensor& sensor, const SourcePath& file) {
  const FileHead head = read_head(file);
  auto heading = std::ranges::find(head.lines.rbegin(), head.lines.rend(), false, &HeadingLine::comment);
  if (heading == head.lines.rend() && !head.lines.empty()) --heading;
  std::optional<TimeUnit> unit;
  std::optional<ExternalTable> table;
  if (!head.lines.empty()) table = table_by_heading(*heading, sensor, file, unit);
  if (!table) {
    unit.reset();
    table = ExternalTable{.columns = {.at = {0}, .scales = std::vector<double>(sensor.columns.size(), 1.0)},
                          .sigmas_follow = true};
    for (std::size_t i = 1; i <= sensor.columns.size(); ++i) table->columns.at.push_back(i);
  }
  FieldReader fields(head.data);
  for (std::size_t i = 0; i < table->columns.at[0]; ++i) fields.next();
  table->columns.unit = unit ? *unit : unit_by_size(parse_number(fields.next()).value_or(0.0));
  return *table;
}

/// A finite number, 0 for an empty field, infinity for a value that is not measured.
std::optional<double> sigma_of(std::string_view field) {
  if (field.empty()) return 0.0;
  if (lower_case(field) == "inf" || lower_case(field) == "infinity") return kNotMeasured;
  const auto sigma = parse_number(field);
  return sigma && *sigma >= 0.0 ? sigma : std::nullopt;
}

/// The field with the sigma of each value, in a line of so many fields; empty without sigmas. Nothing if their number
/// fits neither one value nor all.
std::optional<std::vector<std::size_t>> sigma_fields(const ExternalTable& form, std::size_t values,
                                                     std::size_t fields) {
  std::vector<std::size_t> sigmas = form.sigmas;
  if (form.sigmas_follow)
    for (std::size_t i = values + 1; i < fields; ++i) sigmas.push_back(i);
  if (sigmas.size() == 1) return std::vector<std::size_t>(values, sigmas[0]);
  return sigmas.empty() || sigmas.size() == values ? std::optional(std::move(sigmas)) : std::nullopt;
}

std::optional<ExternalSample> parse_external(std::string_view line, const ExternalSensor& sensor,
                                             const ExternalTable& form) {
  std::vector<std::string_view> fields;
  for (FieldReader reader(line); !reader.rest().empty();) fields.push_back(reader.next());
  const std::size_t n = sensor.columns.size();
  const auto sigmas = sigma_fields(form, n, fields.size());
  if (!sigmas) return std::nullopt;
  const auto field = [&fields](std::size_t i) { return i < fields.size() ? fields[i] : std::string_view(); };
  const std::optional<Timestamp> t = parse_stamp(field(form.columns.at[0]), form.columns.unit);
  if (!t) return std::nullopt;
  ExternalNumbers numbers{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  for (std::size_t i = 0; i < n; ++i) {
    const std::string_view text = field(form.columns.at[1 + i]);
    const auto value = parse_number(text);
    if (!value && lower_case(text) != "nan") return std::nullopt;
    const auto sigma = sigmas->empty() ? 0.0 : sigma_of(field((*sigmas)[i]));
    if (!sigma) return std::nullopt;
    numbers.values[i] = form.columns.scales[i] * value.value_or(0.0);
    numbers.sigmas[i] = value ? form.columns.scales[i] * *sigma : kNotMeasured;
  }
  ExternalSample sample = sensor.sample(*t, numbers);
  return is_plausible(sample) ? std::optional(std::move(sample)) : std::nullopt;
}

bool is_sample_of(const Measurement& measurement, const ExternalSensor& sensor) {
  const auto* sample = std::get_if<ExternalSample>(&measurement);
  return sample != nullptr && &sensor_of(*sample) == &sensor;
}

/// Adds the file to the streams of a recording, instead of those of the same role.
void set_stream(DatasetInfo& info, const std::string& role, const SourcePath& file, const std::string& layout) {
  std::erase_if(info.streams, [&role](const StreamInfo& stream) { return stream.role == role; });
  info.streams.push_back({file.string(), layout, 0, role});
}

}  // namespace

std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file, bool own_clock) {
  const TextTable table = find_imu_table(file);
  spdlog::log(table.guessed ? spdlog::level::warn : spdlog::level::info, "{}: {}", file.string(), table.said);
  DatasetInfo info = recording->info();
  if (info.has_imu) spdlog::warn(fmt::format("{}: its own IMU is left out for {}", info.name, file.string()));
  set_stream(info, "imu", file, table.said);
  info.has_imu = true;
  const auto lines = imu_lines(file, table);
  auto joined = std::make_unique<WithTextSamples<ImuSample>>(
      std::move(recording), lines, std::move(info),
      [](const Measurement& measurement) { return std::holds_alternative<ImuSample>(measurement); });
  if (!own_clock) joined->check_clock(lines, "give --imu-time-offset auto, or the seconds to add to its stamps");
  return joined;
}

std::unique_ptr<Dataset> with_external_file(std::unique_ptr<Dataset> recording, const ExternalSensor& sensor,
                                            const SourcePath& file) {
  const auto parse = [table = external_table(sensor, file), &sensor](std::string_view line) {
    return parse_external(line, sensor, table);
  };
  const std::string name(sensor.name), layout = layout_of(sensor);
  DatasetInfo info = recording->info();
  if (std::ranges::count(info.external, name) > 0)
    spdlog::warn(fmt::format("{}: its own {} samples are left out for {}", info.name, name, file.string()));
  else
    info.external.push_back(name);
  set_stream(info, name, file, layout);
  const StampedLines<ExternalSample>::Spec lines{file, name, layout, LastLine::MustEnd, parse};
  auto joined = std::make_unique<WithTextSamples<ExternalSample>>(
      std::move(recording), lines, std::move(info),
      [&sensor](const Measurement& measurement) { return is_sample_of(measurement, sensor); });
  joined->check_clock(lines, "shift the stamps of one of them");
  return joined;
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
