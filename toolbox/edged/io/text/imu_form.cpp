// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects the columns and units of an IMU file.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/io/text/imu_text.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostImuRows = 4000;
constexpr const char* kWanted = "t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]";

/// The first samples of a file.
struct Sample {
  std::vector<std::vector<double>> rows;

  double column(std::size_t row, std::size_t i) const { return rows[row][i]; }
  std::vector<double> norms(const std::array<std::size_t, 3>& columns) const {
    std::vector<double> out;
    for (const auto& row : rows)
      out.push_back(Eigen::Vector3d(row[columns[0]], row[columns[1]], row[columns[2]]).norm());
    return out;
  }
};

/// The numbers of the named columns, else of all columns. Any other text is NaN.
Sample read_sample(const SourcePath& file, const std::optional<NamedImu>& named) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto is_sample = [&named](const std::vector<double>& row) {
    if (!named) return row.size() >= 7 && std::ranges::all_of(row, [](double x) { return std::isfinite(x); });
    const ImuTextForm& f = named->form;
    for (const std::size_t i : {f.t, f.gyro[0], f.gyro[1], f.gyro[2], f.accel[0], f.accel[1], f.accel[2]})
      if (i >= row.size() || !std::isfinite(row[i])) return false;
    return true;
  };
  Sample sample;
  LineReader lines(file);
  for (std::size_t i = 0; i < kMostImuRows; ++i) {
    const auto line = lines.next();
    if (!line) break;
    std::vector<double> row;
    for (FieldReader fields(line->text); !fields.rest().empty();)
      row.push_back(parse_number(fields.next()).value_or(kNone));
    if (is_sample(row) && (sample.rows.empty() || row.size() == sample.rows[0].size()))
      sample.rows.push_back(std::move(row));
  }
  if (sample.rows.size() < 3)
    throw InputError::format("{}: holds no lines of at least 7 numbers; an IMU file has a first line such as `{}`",
                             file.string(), kWanted);
  return sample;
}

/// Unit of an accelerometer with this median, which is mainly gravity.
std::optional<std::pair<double, const char*>> gravity_unit(double median) {
  if (median > 7.0 && median < 13.0) return std::pair(1.0, "m/s^2");
  if (median > 0.7 && median < 1.3) return std::pair(kStandardGravity, "g");
  if (median > 700.0 && median < 1300.0) return std::pair(1e-3 * kStandardGravity, "mg");
  return std::nullopt;
}

NamedImu by_gravity(const SourcePath& file, const Sample& sample) {
  constexpr std::array<std::size_t, 3> kFirst = {1, 2, 3}, kSecond = {4, 5, 6};
  const bool first = gravity_unit(median(sample.norms(kFirst))).has_value();
  const bool second = gravity_unit(median(sample.norms(kSecond))).has_value();
  if (first == second)
    throw InputError::format(
        "{}: no first line names the columns, and gravity does not identify those of the accelerometer; write one such "
        "as "
        "`{}`",
        file.string(), kWanted);
  NamedImu found;
  found.form.gyro = first ? kSecond : kFirst;
  found.form.accel = first ? kFirst : kSecond;
  return found;
}

/// The only unit that gives a rate of 25 to 10,000 Hz.
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

}  // namespace

ImuTextForm find_imu_form(const SourcePath& file) {
  constexpr double kFastest_radps = 35.0;  // 2000 deg/s, the range of MEMS gyros
  const std::optional<NamedImu> named = named_imu(file);
  const Sample sample = read_sample(file, named);
  NamedImu found = named ? *named : by_gravity(file, sample);
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
  const char* accel = form.accel_scale == 1.0 ? "m/s^2" : form.accel_scale == kStandardGravity ? "g" : "mg";
  const auto place = [](const std::array<std::size_t, 3>& at) {
    return fmt::format("{},{},{}", at[0] + 1, at[1] + 1, at[2] + 1);
  };
  form.guessed = !named || !found.unit || !found.gyro_scale || !found.accel_scale;
  form.said = fmt::format("columns {}: t {} [{}]{}, gyro {} [{}]{}, accelerometer {} [{}]{}",
                          form.named ? "by name" : "by gravity (guessed)", form.t + 1, unit_name(form.unit),
                          found.unit ? "" : kGuess, place(form.gyro), form.gyro_scale == 1.0 ? "rad/s" : "deg/s",
                          found.gyro_scale ? "" : kGuess, place(form.accel), accel, found.accel_scale ? "" : kGuess);
  return form;
}

}  // namespace edged
