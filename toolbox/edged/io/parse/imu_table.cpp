// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/imu_table.hpp"

#include <algorithm>
#include <cmath>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kGyro = 1, kAccel = 4;  // the first of three roles each
constexpr std::size_t kRoles = 7;
constexpr const char* kWanted = "t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]";

/// kGyro, kAccel, or 0 for another word.
std::size_t imu_sensor_of(std::string_view word) {
  if (is_one_of(word,
                {"g", "gyr", "gyro", "gyroscope", "w", "omega", "ang", "angular", "angvel", "rotationrate", "rate"}))
    return kGyro;
  return is_one_of(word, {"a", "acc", "accel", "accelerometer", "acceleration", "linear"}) ? kAccel : 0;
}

std::optional<std::size_t> imu_role(const ColumnName& column) {
  if (has_word(column, {"bias", "covariance", "cov", "std", "sigma", "orientation", "raw"})) return std::nullopt;
  if (names_time(column)) return 0;
  std::size_t sensor = 0;
  std::optional<std::size_t> axis;
  for (const std::string& word : column.words) {
    const char last = word.back();
    const bool ends_with_axis = last >= 'x' && last <= 'z';
    const std::size_t whole = imu_sensor_of(word);
    const std::size_t stem = ends_with_axis ? imu_sensor_of(word.substr(0, word.size() - 1)) : 0;
    if (sensor == 0) sensor = whole != 0 ? whole : stem;
    if (!axis && ends_with_axis && (word.size() == 1 || stem != 0)) axis = static_cast<std::size_t>(last - 'x');
  }
  const bool velocity = has_word(column, {"vel", "velocity"});  // "lin_vel_x" is not of the accelerometer
  if (!axis || sensor == 0 || (sensor == kAccel && velocity)) return std::nullopt;
  return sensor + *axis;
}

const TableKind& imu_kind() {
  static const TableKind kind{{"t", "gx", "gy", "gz", "ax", "ay", "az"}, imu_role, kWanted};
  return kind;
}

/// Stamps that are a counter of 32 bits, which begins again at zero. Of seconds there is none: it would last for ever.
class Counter32 {
 public:
  explicit Counter32(TimeUnit unit)
      : period_(unit == TimeUnit::Seconds ? Duration(0) : duration_from_seconds(4294967296.0 * seconds_of(unit))) {}

  /// The stamp, continued if it steps back by about the whole range of the counter. Nothing if it is out of range.
  std::optional<Timestamp> continued(Timestamp t) {
    constexpr Duration kLongestStep = std::chrono::milliseconds(100);
    t += turns_;
    if (before_ && t + period_ > *before_ - kLongestStep && t + period_ < *before_ + kLongestStep) {
      turns_ += period_;
      t += period_;
    }
    if (to_ns(t) > kMaxStampNs) return std::nullopt;
    before_ = t;
    return t;
  }

 private:
  Duration period_, turns_{0};
  std::optional<Timestamp> before_;
};

/// A unit in the names of columns, as a whole or by its beginning.
struct ImuUnit {
  std::size_t sensor;
  std::string_view name;
  bool begins;
  double scale;  ///< to SI units
};

constexpr ImuUnit kImuUnits[] = {{kGyro, "deg", true, kDegree},
                                 {kGyro, "dps", false, kDegree},
                                 {kGyro, "\xc2\xb0", true, kDegree},
                                 {kGyro, "rad", true, 1.0},
                                 {kAccel, "mg", false, 1e-3 * kStandardGravity},
                                 {kAccel, "g", false, kStandardGravity},
                                 {kAccel, "g0", false, kStandardGravity},
                                 {kAccel, "m/s", true, 1.0},
                                 {kAccel, "ms^", true, 1.0},
                                 {kAccel, "ms-", true, 1.0},
                                 {kAccel, "mps2", false, 1.0},
                                 {kAccel, "ms2", false, 1.0}};

/// By brackets or a last word such as `dps`. Nothing if the name has no unit.
std::optional<double> imu_scale_of(const ColumnName& column, std::size_t sensor) {
  const std::string last = column.words.size() > 1 ? column.words.back() : "";
  for (const std::string& unit : {column.unit, last})
    for (const ImuUnit& known : kImuUnits)
      if (known.sensor == sensor && (known.begins ? unit.starts_with(known.name) : unit == known.name))
        return known.scale;
  return std::nullopt;
}

/// What a heading says.
struct NamedImu {
  TextTable table;
  std::optional<TimeUnit> unit;
  std::optional<double> gyro_scale, accel_scale;
};

std::optional<NamedImu> named_imu(const SourcePath& file) {
  const auto heading = find_heading(file, imu_kind());
  if (!heading) return std::nullopt;
  NamedImu named{{.at = heading->at, .named = true}, heading->time_unit(), {}, {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (const auto scale = imu_scale_of(heading->name_of(kGyro + axis), kGyro)) named.gyro_scale = scale;
    if (const auto scale = imu_scale_of(heading->name_of(kAccel + axis), kAccel)) named.accel_scale = scale;
  }
  return named;
}

void set_units(TextTable& table, TimeUnit unit, double gyro_scale, double accel_scale) {
  table.unit = unit;
  table.scales = {gyro_scale, gyro_scale, gyro_scale, accel_scale, accel_scale, accel_scale};
}

/// Norms of the vectors in the columns of that sensor.
std::vector<double> norms(const RowSample& sample, const TextTable& table, std::size_t sensor) {
  std::vector<double> out;
  for (const auto& row : sample.rows)
    out.push_back(Eigen::Vector3d(row[table.at[sensor]], row[table.at[sensor + 1]], row[table.at[sensor + 2]]).norm());
  return out;
}

RowSample sample_imu(const SourcePath& file, const TextTable& table, bool named) {
  constexpr std::size_t kMostRows = 4000;
  RowSample sample = sample_rows(file, kMostRows, table.at);
  if (!named)
    std::erase_if(sample.rows, [](const std::vector<double>& row) {
      return std::ranges::any_of(row, [](double x) { return !std::isfinite(x); });
    });
  if (sample.rows.size() < 3)
    throw InputError::format("{}: holds no lines of at least 7 numbers; an IMU file has a first line such as `{}`",
                             file.string(), kWanted);
  return sample;
}

/// Unit of an accelerometer with this median, which is mainly gravity.
std::optional<double> gravity_scale(double median) {
  if (median > 7.0 && median < 13.0) return 1.0;
  if (median > 0.7 && median < 1.3) return kStandardGravity;
  return median > 700.0 && median < 1300.0 ? std::optional(1e-3 * kStandardGravity) : std::nullopt;
}

TextTable table_by_gravity(const SourcePath& file, const RowSample& sample) {
  const TextTable order = gyro_first(TimeUnit::Seconds);
  const bool first = gravity_scale(median(norms(sample, order, kGyro))).has_value();
  const bool second = gravity_scale(median(norms(sample, order, kAccel))).has_value();
  if (first == second)
    throw InputError::format(
        "{}: no first line names the columns, and gravity does not identify those of the accelerometer; write one such "
        "as `{}`",
        file.string(), kWanted);
  return first ? accel_first(TimeUnit::Seconds) : order;
}

/// The only unit that gives a rate of 25 to 10,000 Hz.
TimeUnit unit_by_rate(const SourcePath& file, double step) {
  for (const TimeUnit unit : kTimeUnits)
    if (const double step_s = step * seconds_of(unit); step_s >= 1e-4 && step_s <= 0.04) return unit;
  throw InputError::format("{}: the unit of its stamps is not certain (they are {:g} apart); name it: `{}`",
                           file.string(), step, kWanted);
}

double accel_scale_by_gravity(const SourcePath& file, double median) {
  if (const auto scale = gravity_scale(median)) return *scale;
  throw InputError::format("{}: the unit of the accelerometer is not certain (its median is {:g}); name it: `{}`",
                           file.string(), median, kWanted);
}

std::string said_of(const TextTable& table, const NamedImu& named) {
  const auto place = [&table](std::size_t sensor) {
    return fmt::format("{},{},{}", table.at[sensor] + 1, table.at[sensor + 1] + 1, table.at[sensor + 2] + 1);
  };
  const auto guess = [](const auto& name) { return name ? "" : " (guessed)"; };
  const double accel = table.scales[kAccel - 1];
  return fmt::format("columns {}: t {} [{}]{}, gyro {} [{}]{}, accelerometer {} [{}]{}",
                     table.named ? "by name" : "by gravity (guessed)", table.at[0] + 1, unit_name(table.unit),
                     guess(named.unit), place(kGyro), table.scales[kGyro - 1] == 1.0 ? "rad/s" : "deg/s",
                     guess(named.gyro_scale), place(kAccel),
                     accel == 1.0                ? "m/s^2"
                     : accel == kStandardGravity ? "g"
                                                 : "mg",
                     guess(named.accel_scale));
}

}  // namespace

TextTable gyro_first(TimeUnit unit) {
  return {.at = {0, 1, 2, 3, 4, 5, 6}, .unit = unit, .said = "t gx gy gz ax ay az"};
}

TextTable accel_first(TimeUnit unit) {
  return {.at = {0, 4, 5, 6, 1, 2, 3}, .unit = unit, .said = "t ax ay az gx gy gz"};
}

TextTable find_imu_table(const SourcePath& file) {
  constexpr double kFastest_radps = 35.0;  // 2000 deg/s, the range of MEMS gyros
  const std::optional<NamedImu> by_name = named_imu(file);
  const RowSample sample =
      sample_imu(file, by_name ? by_name->table : gyro_first(TimeUnit::Seconds), by_name.has_value());
  const NamedImu named = by_name ? *by_name : NamedImu{table_by_gravity(file, sample), {}, {}, {}};
  TextTable table = named.table;
  const double fastest = std::ranges::max(norms(sample, table, kGyro));
  const TimeUnit unit = named.unit ? *named.unit : unit_by_rate(file, *median_step(sample, table.at[0]));
  const double accel_scale =
      named.accel_scale ? *named.accel_scale : accel_scale_by_gravity(file, median(norms(sample, table, kAccel)));
  set_units(table, unit, named.gyro_scale.value_or(fastest > kFastest_radps ? kDegree : 1.0), accel_scale);
  table.guessed = !by_name || !named.unit || !named.gyro_scale || !named.accel_scale;
  table.said = said_of(table, named);
  return table;
}

TextTable documented_imu_table(const SourcePath& file, const TextTable& documented) {
  const auto named = named_imu(file);
  if (!named) return documented;
  TextTable table = named->table;
  set_units(table, named->unit.value_or(documented.unit), named->gyro_scale.value_or(1.0),
            named->accel_scale.value_or(1.0));
  table.said = "a line with the columns that its heading names";
  return table;
}

StampedLines<ImuSample>::Spec imu_lines(const SourcePath& file, const TextTable& table) {
  const auto parse = [reader = RowReader(table),
                      counter = Counter32(table.unit)](std::string_view line) mutable -> std::optional<ImuSample> {
    std::array<double, kRoles - 1> v{};
    const auto read = reader.read(line, v);
    const auto t = read ? counter.continued(*read) : std::nullopt;
    if (!t) return std::nullopt;
    return ImuSample{*t, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  };
  return {file, "imu", table.said, LastLine::MustEnd, parse};
}

}  // namespace edged
