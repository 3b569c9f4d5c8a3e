// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/imu_text.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/io/stamped_lines.hpp"
#include "edged/io/text/dataset_with_lines.hpp"

namespace edged {
namespace {

StampedLines<ImuSample>::Spec lines_of(const SourcePath& file, const ImuTextForm& form) {
  const std::size_t columns = 1 + std::max({form.t, std::ranges::max(form.gyro), std::ranges::max(form.accel)});
  const auto parse = [form, columns](std::string_view line) -> std::optional<ImuSample> {
    FieldReader fields(line);
    std::optional<Timestamp> t;
    std::vector<double> v(columns);
    for (std::size_t i = 0; i < columns; ++i) {
      const std::string_view field = fields.next();
      if (i == form.t) t = parse_stamp(field, form.unit);
      const auto number = parse_number(field);
      if (!number) return std::nullopt;
      v[i] = *number;
    }
    if (!t) return std::nullopt;
    const auto triple = [&v](const std::array<std::size_t, 3>& at) {
      return Eigen::Vector3d(v[at[0]], v[at[1]], v[at[2]]);
    };
    return ImuSample{*t, form.gyro_scale * triple(form.gyro), form.accel_scale * triple(form.accel)};
  };
  return {file, "imu", form.said, LastLine::MustEnd, parse};
}

}  // namespace

std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file) {
  const ImuTextForm form = find_imu_form(file);
  spdlog::log(form.guessed ? spdlog::level::warn : spdlog::level::info, "{}: {}", file.string(), form.said);
  if (recording->info().has_imu)
    spdlog::warn(fmt::format("{}: its own IMU is left out for {}", recording->info().name, file.string()));
  DatasetInfo info = recording->info();
  std::erase_if(info.streams, [](const StreamInfo& stream) { return stream.role == "imu"; });
  info.streams.push_back({file.string(), form.said, 0, "imu"});
  info.has_imu = true;
  return std::make_unique<DatasetWithLines<ImuSample>>(
      std::move(recording), lines_of(file, form), std::move(info),
      [](const Measurement& measurement) { return std::holds_alternative<ImuSample>(measurement); });
}

}  // namespace edged
