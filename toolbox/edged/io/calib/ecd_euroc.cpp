// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibrations in folders of the Event-Camera Dataset and of EuRoC.
#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/distortion.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::size_t kProjection = 4, kMostNumbers = kProjection + 14;

std::vector<double> read_row_of_numbers(const SourcePath& file) {
  std::vector<double> v;
  LineReader lines(file);
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    for (std::string_view field = fields.next(); !field.empty(); field = fields.next()) {
      const auto number = parse_number(field);
      if (!number) throw InputError::format("{}:{}: \"{}\" is not a finite number", file.string(), line->number, field);
      v.push_back(*number);
    }
    if (v.size() > kMostNumbers) break;
  }
  const bool coefficients = v.size() >= 2 * kProjection && v.size() <= kMostNumbers;
  if (v.size() != kProjection && !coefficients)
    throw InputError::format("{}: has {}{} numbers; `fx fy cx cy [k1 k2 p1 p2 k3]` has 4 or 9", file.string(),
                             v.size() > kMostNumbers ? "more than " : "", std::min(v.size(), kMostNumbers));
  return v;
}

}  // namespace

CalibrationFile read_ecd_calib(const SourcePath& file) {
  const std::vector<double> v = read_row_of_numbers(file);
  const auto size = ecd_image_size(file.parent_path()).value_or(cv::Size(kEcdWidth, kEcdHeight));
  Lens lens;
  lens.name = "davis", lens.sees = Sees::Both;
  try {
    const Distortion lens_distortion =
        v.size() == kProjection ? Distortion() : make_distortion("radtan", {v.begin() + kProjection, v.end()});
    lens.model = CameraModel(size.width, size.height, v[0], v[1], v[2], v[3], lens_distortion.model, lens_distortion.k);
  } catch (const InputError& e) {
    throw InputError::format("{}: {}", file.string(), e.what());
  }
  CalibrationFile out;
  out.has_extrinsics = false;
  out.name = "calib.txt";
  out.lenses = {lens};
  return out;
}

CalibrationFile read_euroc(const YamlReader& root) {
  if (root.at("sensor_type").text() != "camera") root.at("sensor_type").fail("must be camera: give cam0/sensor.yaml");
  const SourcePath folder = root.file().parent_path();
  Lens lens;
  lens.name = folder.name();
  lens.sees = guess_sees(lens.name, 0, 0).value_or(Sees::Frames);  // the format has frame cameras only
  lens.model = read_model(root, "distortion_model", "distortion_coefficients");
  lens.T_B_C = root.at("T_BS").transform();  // p_B = T_BS * p_S: T_BS is T_B_C, as the IMU is the body

  CalibrationFile out;
  const SourcePath mav0 = folder.parent_path();
  out.name = (mav0.name() == "mav0" ? mav0.parent_path() : mav0).name();
  const SourcePath imu_file = mav0 / "imu0" / "sensor.yaml";
  if (imu_file.is_file()) {
    const YamlReader imu = root.other_file(imu_file);
    out.imu = read_kalibr_noise(imu);
    lens.T_B_C = imu.at("T_BS").transform().inverse() * lens.T_B_C;
  }
  out.lenses = {lens};
  return out;
}

}  // namespace edged
