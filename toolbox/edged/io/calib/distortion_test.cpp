// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Coefficients padded with zeros as by OpenCV, in each format.
#include "edged/io/parse/distortion.hpp"

#include <gmock/gmock.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>

#include "edged/camera/lens_table.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

/// A calibration with these coefficients in each of the formats that list them.
std::vector<std::pair<std::string, std::string>> files_with(const std::vector<double>& k) {
  const std::string list = fmt::format("[{}]", fmt::join(k, ", "));
  const std::string T = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]";
  return {
      {"own.yaml",
       "edged_rig: 1\nname: a\ncameras:\n  - name: events\n    modality: events\n    resolution: [240, 180]\n"
       "    intrinsics: [200, 200, 120, 90]\n    distortion: radtan\n    coefficients: " +
           list + "\n    T_B_C: " + T + "\n"},
      {"camchain.yaml",
       "cam0:\n  camera_model: pinhole\n  rostopic: /dvs/events\n  resolution: [240, 180]\n"
       "  intrinsics: [200, 200, 120, 90]\n  distortion_model: radtan\n  distortion_coeffs: " +
           list + "\n  T_cam_imu: " + T + "\n"},
      {"info.yaml",
       "image_width: 240\nimage_height: 180\ncamera_name: dvs\ncamera_matrix: {rows: 3, cols: 3, data: [200, 0, "
       "120, 0, 200, 90, 0, 0, 1]}\ndistortion_model: rational_polynomial\ndistortion_coefficients: {rows: 1, "
       "cols: " +
           std::to_string(k.size()) + ", data: " + list + "}\n"},
      {"mav0/cam0/sensor.yaml",
       "sensor_type: camera\nT_BS: {rows: 4, cols: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, "
       "0, 0, 1]}\nresolution: [240, 180]\ncamera_model: pinhole\nintrinsics: [200, 200, 120, 90]\n"
       "distortion_model: radial-tangential\ndistortion_coefficients: " +
           list + "\n"},
      {"calib.txt", fmt::format("200 200 120 90 {}\n", fmt::join(k, " "))},
  };
}

TEST(Distortion, ZerosBehindTheCoefficientsOfTheModelAreAcceptedInEveryFormat) {
  const TempFolder folder;
  for (const std::size_t count : {4U, 5U, 8U, 12U, 14U}) {
    std::vector<double> k(count, 0.0);
    k[0] = -0.3, k[1] = 0.1;
    for (const auto& [name, text] : files_with(k)) {
      const Calibration calibration = load_calibration(folder.write(name, text), {.otherwise = Sees::Events});
      const CameraModel& model = calibration.rig.cameras.front().model;
      EXPECT_EQ(model.distortion(), DistortionModel::RadTan) << name << count;
      EXPECT_EQ(model.coefficients()[0], -0.3) << name << count;
    }
  }
}

TEST(Distortion, EightCoefficientsAreTheRationalModelInEveryFormat) {
  const TempFolder folder;
  const std::vector<double> k = {-0.3, 0.1, 1e-3, -2e-3, 0.01, 0.05, 0.02, 0.003};
  for (const std::size_t count : {8U, 12U}) {
    std::vector<double> padded = k;
    padded.resize(count);
    for (const auto& [name, text] : files_with(padded)) {
      const Calibration calibration = load_calibration(folder.write(name, text), {.otherwise = Sees::Events});
      const CameraModel& model = calibration.rig.cameras.front().model;
      EXPECT_EQ(model.distortion(), DistortionModel::Rational) << name << count;
      EXPECT_TRUE(std::equal(k.begin(), k.end(), model.coefficients().begin())) << name << count;
    }
  }
}

TEST(Distortion, ACoefficientThatIsNotSupportedIsNamedInEveryFormat) {
  const TempFolder folder;
  for (const double k4 : {0.0, 0.1}) {
    std::vector<double> k(12, 0.0);
    k[0] = -0.3, k[5] = k4, k[8] = 0.02;
    for (const auto& [name, text] : files_with(k)) {
      const auto file = folder.write(name, text);
      const std::string refusal = input_error([&] { load_calibration(file, {.otherwise = Sees::Events}); });
      EXPECT_THAT(refusal, HasSubstr("s1 = 0.02 is not supported")) << name;
    }
  }
}

TEST(Distortion, EveryModelTakesItsCoefficientsByEachOfItsNames) {
  for (const LensModel& lens : lens_models()) {
    if (lens.max_coefficients == 0) continue;
    std::vector<double> k;
    for (std::size_t i = 0; i < lens.max_coefficients; ++i) k.push_back(0.1 + 0.01 * static_cast<double>(i));
    for (std::string_view name : {lens.name, lens.aliases[0], lens.aliases[1], lens.aliases[2], lens.ros}) {
      if (name.empty()) continue;
      const Distortion distortion = make_distortion(name, k);
      EXPECT_EQ(distortion.model, lens.model) << name;
      EXPECT_TRUE(std::equal(k.begin(), k.end(), distortion.k.begin())) << name;
    }
  }
}

TEST(Distortion, EquidistantAndNoneArePaddedToo) {
  EXPECT_EQ(make_distortion("equidistant", {0.1, 0.2, 0.3, 0.4, 0, 0, 0, 0}).k[3], 0.4);
  EXPECT_EQ(make_distortion("none", {0, 0, 0, 0, 0}).model, DistortionModel::None);
  EXPECT_EQ(make_distortion("cahvor", {0}).model, DistortionModel::None);
  EXPECT_EQ(make_distortion("fov", {0.9, 0, 0, 0}).k[0], 0.9);
  EXPECT_EQ(make_distortion("rational_polynomial", {0.1, 0, 0, 0, 0, 0, 0, 0}).model, DistortionModel::RadTan);
  EXPECT_EQ(make_distortion("rational", {0.1, 0, 0, 0, 0, 0, 0, 0}).model, DistortionModel::Rational);
  EXPECT_THAT(input_error([] { make_distortion("fisheye", {0.1, 0, 0, 0, 0.5}); }), HasSubstr("number 5 = 0.5"));
  EXPECT_THAT(input_error([] { make_distortion("none", {0.1}); }), HasSubstr("distortion none"));
  EXPECT_THAT(input_error([] { make_distortion("cahvor", {0.9}); }), HasSubstr("distortion cahvor is not supported"));
  EXPECT_THAT(input_error([] { make_distortion("radtan", {0.1, 0.2}); }), HasSubstr("takes 4 or 5"));
  EXPECT_THAT(input_error([] { make_distortion("omni", {1.1, 0.2, 0.1}); }), HasSubstr("takes 1 or 5"));
}

}  // namespace
}  // namespace edged
