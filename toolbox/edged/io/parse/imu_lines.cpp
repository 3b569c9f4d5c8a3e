// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/imu_lines.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/angles.hpp"

namespace edged {
namespace {

enum class ImuKind { None, Gyro, Accel };

ImuKind imu_kind_of(std::string_view stem) {
  if (is_one_of(stem,
                {"g", "gyr", "gyro", "gyroscope", "w", "omega", "ang", "angular", "angvel", "rotationrate", "rate"}))
    return ImuKind::Gyro;
  if (is_one_of(stem, {"a", "acc", "accel", "accelerometer", "acceleration", "linear"})) return ImuKind::Accel;
  return ImuKind::None;
}

/// 0: time, 1 to 3: the axes of the gyro, 4 to 6: those of the accelerometer.
std::optional<std::size_t> imu_role(const ColumnName& column) {
  if (has_word(column, {"bias", "covariance", "cov", "std", "sigma", "orientation", "raw"})) return std::nullopt;
  if (names_time(column)) return 0;
  ImuKind kind = ImuKind::None;
  std::optional<std::size_t> axis;
  for (const std::string& word : column.words) {
    const char last = word.back();
    const bool ends_with_axis = last >= 'x' && last <= 'z';
    const ImuKind whole = imu_kind_of(word);
    const ImuKind stem = ends_with_axis ? imu_kind_of(word.substr(0, word.size() - 1)) : ImuKind::None;
    if (kind == ImuKind::None) kind = whole != ImuKind::None ? whole : stem;
    if (!axis && ends_with_axis && (word.size() == 1 || stem != ImuKind::None))
      axis = static_cast<std::size_t>(last - 'x');
  }
  const bool velocity = has_word(column, {"vel", "velocity"});  // "lin_vel_x" is not of the accelerometer
  if (!axis || kind == ImuKind::None || (kind == ImuKind::Accel && velocity)) return std::nullopt;
  return (kind == ImuKind::Gyro ? 1 : 4) + *axis;
}

const ColumnRoles& imu_roles() {
  static const ColumnRoles roles{{"t", "gx", "gy", "gz", "ax", "ay", "az"},
                                 imu_role,
                                 "t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]"};
  return roles;
}

/// The factor to SI units, by brackets or a last word such as `dps`. Nothing if the name has no unit.
std::optional<double> imu_scale_of(const ColumnName& column, ImuKind kind) {
  const std::string last = column.words.size() > 1 ? column.words.back() : "";
  for (const std::string& unit : {column.unit, last}) {
    if (unit.empty()) continue;
    if (kind == ImuKind::Gyro && (unit.starts_with("deg") || unit == "dps" || unit.starts_with("\xc2\xb0")))
      return kDegree;
    if (kind == ImuKind::Gyro && unit.starts_with("rad")) return 1.0;
    if (kind == ImuKind::Accel && unit == "mg") return 1e-3 * kStandardGravity;
    if (kind == ImuKind::Accel && (unit == "g" || unit == "g0")) return kStandardGravity;
    if (kind == ImuKind::Accel && (unit.starts_with("m/s") || unit.starts_with("ms^") || unit.starts_with("ms-") ||
                                   is_one_of(unit, {"mps2", "ms2"})))
      return 1.0;
  }
  return std::nullopt;
}

std::vector<std::size_t> places_of(const ImuTextForm& form) {
  return {form.t, form.gyro[0], form.gyro[1], form.gyro[2], form.accel[0], form.accel[1], form.accel[2]};
}

}  // namespace

ImuTextForm gyro_first(TimeUnit unit) {
  return {.gyro = {1, 2, 3}, .accel = {4, 5, 6}, .unit = unit, .said = "t gx gy gz ax ay az"};
}

ImuTextForm accel_first(TimeUnit unit) {
  return {.gyro = {4, 5, 6}, .accel = {1, 2, 3}, .unit = unit, .said = "t ax ay az gx gy gz"};
}

std::optional<NamedImu> named_imu(const SourcePath& file) {
  const auto columns = named_columns(file, imu_roles());
  if (!columns) return std::nullopt;
  NamedImu found;
  found.form.named = true;
  found.form.t = columns->at[0];
  found.unit = time_unit_of(columns->name_of(0));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    found.form.gyro[axis] = columns->at[1 + axis];
    found.form.accel[axis] = columns->at[4 + axis];
    if (const auto scale = imu_scale_of(columns->name_of(1 + axis), ImuKind::Gyro)) found.gyro_scale = scale;
    if (const auto scale = imu_scale_of(columns->name_of(4 + axis), ImuKind::Accel)) found.accel_scale = scale;
  }
  return found;
}

StampedLines<ImuSample>::Spec imu_lines(const SourcePath& file, const ImuTextForm& form, bool exact) {
  const auto parse =
      [form, picker = ColumnPicker(places_of(form), exact)](std::string_view line) -> std::optional<ImuSample> {
    std::array<std::string_view, 7> fields;
    std::array<double, 7> v{};
    if (!picker.pick(line, fields)) return std::nullopt;
    const auto t = parse_stamp(fields[0], form.unit);
    for (std::size_t i = 1; i < fields.size(); ++i) {
      const auto number = parse_number(fields[i]);
      if (!number) return std::nullopt;
      v[i] = *number;
    }
    if (!t) return std::nullopt;
    return ImuSample{*t, form.gyro_scale * Eigen::Vector3d(v[1], v[2], v[3]),
                     form.accel_scale * Eigen::Vector3d(v[4], v[5], v[6])};
  };
  return {file, "imu", form.said, LastLine::MustEnd, parse};
}

StampedLines<ImuSample>::Spec documented_imu_lines(const SourcePath& file, const ImuTextForm& documented, bool exact) {
  const auto named = named_imu(file);
  if (!named) return imu_lines(file, documented, exact);
  ImuTextForm form = named->form;
  form.unit = named->unit.value_or(documented.unit);
  form.gyro_scale = named->gyro_scale.value_or(1.0);
  form.accel_scale = named->accel_scale.value_or(1.0);
  form.said = "a line with the columns that its heading names";
  return imu_lines(file, form);
}

}  // namespace edged
