// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The ASL folders of the EuRoC data set (Burri et al., IJRR 2016).
#include <array>

#include "edged/core/check.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/text/text_dataset.hpp"
#include "edged/io/trajectory_io.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

constexpr const char* kTruthFolder = "state_groundtruth_estimate0";

/// `ns, wx, wy, wz, ax, ay, az`: angular velocity first.
std::optional<ImuSample> parse_euroc_imu(std::string_view line) {
  FieldReader fields(line);
  const auto t = parse_nanoseconds(fields.next());
  std::array<double, 6> v;
  if (!t || !read_numbers(fields, v)) return std::nullopt;
  return ImuSample{*t, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

StampedLines<FrameEntry>::Spec euroc_images(const fs::path& cam0) {
  return {cam0 / "data.csv", "frames", "ns, file name", LastLine::MayLackEnd,
          [cam0](std::string_view line) -> std::optional<FrameEntry> {
            FieldReader fields(line);
            const auto t = parse_nanoseconds(fields.next());
            if (!t || fields.rest().empty()) return std::nullopt;
            return FrameEntry{*t, cam0 / "data" / fields.rest()};
          }};
}

std::optional<GroundTruth> read_ground_truth(const fs::path& file, Repairs& repairs) {
  LineDamage damage(file.string(), "groundtruth", repairs);
  const auto count = [&](std::size_t line, const std::string& detail) { damage.bad(line, "bad line", detail); };
  GroundTruth truth{read_euroc_csv(file, count), "body"};
  if (truth.trajectory.empty()) return std::nullopt;
  return truth;
}

bool holds_sensors(const fs::path& folder) {
  return fs::exists(folder / "cam0" / "data.csv") || fs::exists(folder / "imu0" / "data.csv");
}

}  // namespace

std::optional<fs::path> find_mav0(const fs::path& folder) {
  if (holds_sensors(folder)) return folder;
  if (holds_sensors(folder / "mav0")) return folder / "mav0";
  return std::nullopt;
}

Recording open_euroc(const fs::path& mav0) {
  const fs::path full = fs::absolute(mav0 / ".").parent_path();
  TextLayout layout;
  layout.info.name = (full.filename() == "mav0" ? full.parent_path() : full).filename().string();
  layout.info.format = "euroc";
  layout.info.pose_frame = "body";
  layout.parse_stamp = parse_nanoseconds;
  if (fs::exists(mav0 / "cam0" / "data.csv")) layout.frames = FrameFile{"cam0", euroc_images(mav0 / "cam0")};
  if (fs::exists(mav0 / "imu0" / "data.csv"))
    layout.imu = {mav0 / "imu0" / "data.csv", "imu", "ns, wx, wy, wz, ax, ay, az", LastLine::MustEnd, parse_euroc_imu};
  if (const fs::path truth = mav0 / kTruthFolder / "data.csv"; fs::exists(truth))
    layout.ground_truth = [truth](Repairs& repairs) { return read_ground_truth(truth, repairs); };

  Recording recording;
  if (fs::exists(mav0 / "cam0" / "sensor.yaml")) recording.calibration = load_calibration(mav0);
  recording.dataset = std::make_unique<TextDataset>(std::move(layout));
  return recording;
}

}  // namespace edged
