// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/imu_text.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "edged/io/text/dataset_with_lines.hpp"

namespace edged {

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
      std::move(recording), imu_lines(file, form), std::move(info),
      [](const Measurement& measurement) { return std::holds_alternative<ImuSample>(measurement); });
}

}  // namespace edged
