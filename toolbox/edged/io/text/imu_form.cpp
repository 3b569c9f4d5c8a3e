// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which columns an IMU file has, and in which units they are.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/io/text/imu_text.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostImuRows = 4000;
constexpr double kGravity_mps2 = 9.80665;
constexpr const char* kWanted = "t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]";

using Words = std::vector<std::string>;

bool one_of(const std::string& word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

/// The name of a column as words in small letters, and what its brackets hold.
struct ImuColumn {
  Words words;
  std::string unit;
};

ImuColumn imu_column(std::string_view text) {
  ImuColumn out;
  std::string word;
  bool bracket = false;
  const auto end_word = [&] {
    if (!word.empty()) out.words.push_back(std::exchange(word, ""));
  };
  for (const char c : lower_case(text)) {
    if (c == '[' || c == '(') {
      bracket = true;
    } else if (c == ']' || c == ')') {
      bracket = false;
    } else if (bracket) {
      if (c != ' ') out.unit += c;
    } else if (std::isalnum(static_cast<unsigned char>(c))) {
      word += c;
    } else {
      end_word();
    }
  }
  end_word();
  return out;
}

enum class Kind { None, Time, Gyro, Accel };

Kind kind_of(const std::string& stem) {
  if (one_of(stem, {"g", "gyr", "gyro", "gyroscope", "w", "omega", "angular", "angvel", "rotationrate"}))
    return Kind::Gyro;
  if (one_of(stem, {"a", "acc", "accel", "accelerometer", "acceleration", "linear"})) return Kind::Accel;
  return Kind::None;
}

/// What a column holds; of gyro and accelerometer the axis, too.
std::pair<Kind, std::size_t> meaning_of(const ImuColumn& column) {
  Kind kind = Kind::None;
  std::optional<std::size_t> axis;
  for (const std::string& word : column.words) {
    if (one_of(word, {"bias", "covariance", "cov", "std", "sigma", "orientation", "raw"})) return {Kind::None, 0};
    if (one_of(word, {"t", "ts", "time", "timestamp", "timestamps", "stamp"})) return {Kind::Time, 0};
    const char last = word.back();
    const bool ends_with_axis = last >= 'x' && last <= 'z';
    const Kind whole = kind_of(word);
    const Kind stem = ends_with_axis ? kind_of(word.substr(0, word.size() - 1)) : Kind::None;
    if (kind == Kind::None) kind = whole != Kind::None ? whole : stem;
    if (!axis && ends_with_axis && (word.size() == 1 || stem != Kind::None))
      axis = static_cast<std::size_t>(last - 'x');
  }
  return axis ? std::pair(kind, *axis) : std::pair(Kind::None, std::size_t{0});
}

/// By brackets or a last word such as `dps`; nothing where the name does not say.
std::optional<double> scale_of(const ImuColumn& column, Kind kind) {
  const std::string last = column.words.size() > 1 ? column.words.back() : "";
  for (const std::string& unit : {column.unit, last}) {
    if (unit.empty()) continue;
    if (kind == Kind::Gyro && (unit.starts_with("deg") || unit == "dps" || unit.starts_with("\xc2\xb0")))
      return kDegree;
    if (kind == Kind::Gyro && unit.starts_with("rad")) return 1.0;
    if (kind == Kind::Accel && unit == "mg") return 1e-3 * kGravity_mps2;
    if (kind == Kind::Accel && (unit == "g" || unit == "g0")) return kGravity_mps2;
    if (kind == Kind::Accel && (unit.starts_with("m/s") || unit.starts_with("ms^") || unit.starts_with("ms-") ||
                                one_of(unit, {"mps2", "ms2"})))
      return 1.0;
  }
  return std::nullopt;
}

std::optional<TimeUnit> time_unit_of(const ImuColumn& column) {
  if (const auto unit = parse_time_unit(column.unit)) return unit;
  for (const std::string& word : column.words) {
    if (const auto unit = parse_time_unit(word)) return unit;
    if (one_of(word, {"sec", "secs", "seconds"})) return TimeUnit::Seconds;
    if (one_of(word, {"nsec", "nanoseconds"})) return TimeUnit::Nanoseconds;
  }
  return std::nullopt;
}

/// The first lines of a file: the last that is not numbers, and those that are.
struct Sample {
  std::string heading;
  std::vector<std::vector<double>> rows;

  double column(std::size_t row, std::size_t i) const { return rows[row][i]; }
  std::vector<double> norms(const std::array<std::size_t, 3>& columns) const {
    std::vector<double> out;
    for (const auto& row : rows)
      out.push_back(Eigen::Vector3d(row[columns[0]], row[columns[1]], row[columns[2]]).norm());
    return out;
  }
};

Sample read_sample(const SourcePath& file) {
  Sample sample;
  BlockReader blocks(file);
  std::string_view block = blocks.next();
  for (std::size_t end; (end = block.find('\n')) != std::string_view::npos && sample.rows.size() < kMostImuRows;
       block.remove_prefix(end + 1)) {
    const std::string_view line = block.substr(0, end);
    std::vector<double> numbers;
    bool all = true;
    for (FieldReader fields(line); !fields.rest().empty();) {
      const auto number = parse_number(fields.next());
      all = all && number;
      numbers.push_back(number.value_or(0.0));
    }
    if (numbers.empty()) continue;
    if (!all && sample.rows.empty()) sample.heading = line;
    if (all && numbers.size() >= 7 && (sample.rows.empty() || numbers.size() == sample.rows[0].size()))
      sample.rows.push_back(std::move(numbers));
  }
  if (sample.rows.size() < 3)
    throw InputError::format("{}: holds no lines of at least 7 numbers; an IMU file has a first line such as `{}`",
                             file.string(), kWanted);
  return sample;
}

struct Found {
  ImuTextForm form;
  std::optional<TimeUnit> unit;
  std::optional<double> gyro_scale, accel_scale;
};

/// Nothing where the heading names no axis at all.
std::optional<Found> by_heading(const SourcePath& file, const Sample& sample) {
  const std::vector<std::string> names = heading_fields(sample.heading);
  Found found;
  int times = 0;
  std::array<int, 3> gyro{}, accel{};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ImuColumn column = imu_column(names[i]);
    const auto [kind, axis] = meaning_of(column);
    // rostopic has the time of arrival first, then that of the message.
    const bool stamp = kind == Kind::Time && std::ranges::find(column.words, "header") != column.words.end();
    if (kind == Kind::Time && (times++ == 0 || stamp)) {
      found.form.t = i;
      found.unit = time_unit_of(column);
    }
    if (kind == Kind::Gyro) {
      ++gyro[axis], found.form.gyro[axis] = i;
      if (const auto scale = scale_of(column, kind)) found.gyro_scale = scale;
    }
    if (kind == Kind::Accel) {
      ++accel[axis], found.form.accel[axis] = i;
      if (const auto scale = scale_of(column, kind)) found.accel_scale = scale;
    }
  }
  constexpr std::array<int, 3> kOnce = {1, 1, 1}, kNever = {0, 0, 0};
  if (gyro == kNever && accel == kNever) return std::nullopt;
  if (times == 0 || gyro != kOnce || accel != kOnce || names.size() > sample.rows[0].size())
    throw InputError::format(
        "{}: the columns `{}` do not name the time and each axis of gyro and accelerometer once; write a first line "
        "such "
        "as `{}`",
        file.string(), sample.heading, kWanted);
  return found;
}

/// Unit of an accelerometer whose median is this, as gravity is the most of it.
std::optional<std::pair<double, const char*>> gravity_unit(double median) {
  if (median > 7.0 && median < 13.0) return std::pair(1.0, "m/s^2");
  if (median > 0.7 && median < 1.3) return std::pair(kGravity_mps2, "g");
  if (median > 700.0 && median < 1300.0) return std::pair(1e-3 * kGravity_mps2, "mg");
  return std::nullopt;
}

Found by_gravity(const SourcePath& file, const Sample& sample) {
  constexpr std::array<std::size_t, 3> kFirst = {1, 2, 3}, kSecond = {4, 5, 6};
  const bool first = gravity_unit(median(sample.norms(kFirst))).has_value();
  const bool second = gravity_unit(median(sample.norms(kSecond))).has_value();
  if (first == second)
    throw InputError::format(
        "{}: no first line names the columns, and gravity does not identify those of the accelerometer; write one such "
        "as "
        "`{}`",
        file.string(), kWanted);
  Found found;
  found.form.gyro = first ? kSecond : kFirst;
  found.form.accel = first ? kFirst : kSecond;
  return found;
}

/// The only unit in which samples would come 25 to 10,000 times a second.
TimeUnit unit_by_rate(const SourcePath& file, const Sample& sample, std::size_t t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < sample.rows.size(); ++i) steps.push_back(sample.column(i, t) - sample.column(i - 1, t));
  const double step = median(std::move(steps));
  for (const TimeUnit unit :
       {TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds}) {
    const double step_s = step * std::pow(10.0, static_cast<int>(unit) - 9);
    if (step_s >= 1e-4 && step_s <= 0.04) return unit;
  }
  throw InputError::format("{}: the unit of its stamps is not certain (they are {:g} apart); name it: `{}`",
                           file.string(), step, kWanted);
}

const char* name_of_unit(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::Seconds:
      return "s";
    case TimeUnit::Milliseconds:
      return "ms";
    case TimeUnit::Microseconds:
      return "us";
    case TimeUnit::Nanoseconds:
      return "ns";
  }
  return "";
}

}  // namespace

ImuTextForm find_imu_form(const SourcePath& file) {
  constexpr double kFastest_radps = 35.0;  // 2000 deg/s, what MEMS gyros measure
  const Sample sample = read_sample(file);
  const std::optional<Found> named = by_heading(file, sample);
  Found found = named ? *named : by_gravity(file, sample);
  ImuTextForm& form = found.form;
  const char* const kGuess = " (guessed)";
  form.unit = found.unit ? *found.unit : unit_by_rate(file, sample, form.t);
  const std::vector<double> turning = sample.norms(form.gyro);
  form.gyro_scale = found.gyro_scale ? *found.gyro_scale : std::ranges::max(turning) > kFastest_radps ? kDegree : 1.0;
  const double pull = median(sample.norms(form.accel));
  const auto guess = gravity_unit(pull);
  if (!found.accel_scale && !guess)
    throw InputError::format("{}: the unit of the accelerometer is not certain (its median is {:g}); name it: `{}`",
                             file.string(), pull, kWanted);
  form.accel_scale = found.accel_scale ? *found.accel_scale : guess->first;
  const char* accel = form.accel_scale == 1.0 ? "m/s^2" : form.accel_scale == kGravity_mps2 ? "g" : "mg";
  const auto place = [](const std::array<std::size_t, 3>& at) {
    return fmt::format("{},{},{}", at[0] + 1, at[1] + 1, at[2] + 1);
  };
  form.named = named.has_value();
  form.guessed = !named || !found.unit || !found.gyro_scale || !found.accel_scale;
  form.said = fmt::format("columns {}: t {} [{}]{}, gyro {} [{}]{}, accelerometer {} [{}]{}",
                          form.named ? "by name" : "by gravity (guessed)", form.t + 1, name_of_unit(form.unit),
                          found.unit ? "" : kGuess, place(form.gyro), form.gyro_scale == 1.0 ? "rad/s" : "deg/s",
                          found.gyro_scale ? "" : kGuess, place(form.accel), accel, found.accel_scale ? "" : kGuess);
  return form;
}

}  // namespace edged
