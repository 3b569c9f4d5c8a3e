// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Every lens model through our own format, and published calibrations with them.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

std::vector<CameraModel> every_lens() {
  return {
      CameraModel(346, 260, 250, 251, 170, 130),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::RadTan, {-0.3, 0.1, 1e-3, 2e-3, 0.01}),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::Equidistant, {0.01, 0.02, 0.03, 0.04}),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::Rational, {0.2, 0, 1e-3, 2e-3, 0, 0.4, 0.01, 0}),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::Rational, {-0.3, 0.1}),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::FieldOfView, {0.9}),
      CameraModel(346, 260, 400, 401, 170, 130, DistortionModel::Omni, {1.1, 0.1, 0.2, 1e-3, 2e-3}),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::DoubleSphere, {-0.2, 0.6}),
      CameraModel(346, 260, 90, 91, 170, 130, DistortionModel::DoubleSphere, {-0.2, 0.6}).within(60.0 * kDegree),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::ExtendedUnified, {0.6, 1.1}),
      CameraModel(346, 260, 500, 501, 170, 130, DistortionModel::OmniEquidistant, {1.1, 0.05, -0.02, 0.01, -0.002}),
  };
}

TEST(Lenses, OfEveryModelAreReadAsTheyWereWritten) {
  const TempFolder folder;
  for (const LensModel& lens : lens_models())
    EXPECT_TRUE(std::ranges::any_of(every_lens(), [&](const CameraModel& m) { return m.distortion() == lens.model; }))
        << lens.name << " is missing in these tests";
  for (const CameraModel& model : every_lens()) {
    Calibration calibration;
    calibration.rig.name = "a";
    calibration.rig.cameras.push_back({"events", Modality::Events, model, SE3(), Duration(0)});
    calibration.has_extrinsics = true;
    const std::string text = to_yaml(calibration);
    EXPECT_EQ(load_calibration(folder.write("a.yaml", text)).rig.cameras[0].model, model) << text;
  }
}

TEST(Lenses, OfBasaltAreReadByTheirType) {
  const TempFolder folder;
  const auto model = [&](const std::string& type, const std::string& values) {
    const std::string text =
        R"({"value0": {"T_imu_cam": [{"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1}],
        "intrinsics": [{"camera_type": ")" +
        type + R"(", "intrinsics": {"fx": 250, "fy": 251, "cx": 170, "cy": 130, )" + values +
        R"(}}], "resolution": [[346, 260]]}})";
    return load_calibration(folder.write("c.json", text), {.otherwise = Sees::Events}).rig.cameras[0].model;
  };
  EXPECT_EQ(model("ds", R"("xi": -0.2, "alpha": 0.6)"),
            CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::DoubleSphere, {-0.2, 0.6}));
  EXPECT_EQ(model("eucm", R"("alpha": 0.6, "beta": 1.1)"),
            CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::ExtendedUnified, {0.6, 1.1}));
  EXPECT_EQ(model("ucm", R"("alpha": 0.6)"),
            CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::ExtendedUnified, {0.6, 1.0}));
  EXPECT_EQ(model("fov", R"("w": 0.9)"),
            CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::FieldOfView, {0.9}));
  EXPECT_EQ(
      model("pinhole-radtan8", R"("k1": 0.2, "k2": 0, "p1": 0.001, "p2": 0.002,
                                        "k3": 0, "k4": 0.4, "k5": 0.01, "k6": 0)"),
      CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::Rational, {0.2, 0, 0.001, 0.002, 0, 0.4, 0.01, 0}));
}

/// The camera of a published file; nothing without the data.
std::optional<CameraModel> published(const char* name, const char* camera) {
  const std::filesystem::path file = data_folder() / "calib" / name;
  if (!std::filesystem::exists(file)) return std::nullopt;
  const Calibration calibration = load_calibration(file.string(), {.otherwise = Sees::Frames});
  return calibration.rig.camera(camera).model;
}

TEST(Lenses, OfPublishedCalibrationsAreRead) {
  const auto omni = published("kalibr_omni_camchain.yaml", "cam0"), mei = published("vins_mei.yaml", "cam0");
  const auto fisheye = published("uzhfpv_outdoor_45_camchain.yaml", "cam1");
  if (!omni || !mei || !fisheye) GTEST_SKIP() << "no data";
  EXPECT_EQ(omni->distortion(), DistortionModel::Omni);
  EXPECT_NEAR(omni->mean_focal(), 0.5 * (1700.177 + 1687.147) / 2.20792, 0.01);
  EXPECT_FALSE(omni->view_limit());
  EXPECT_EQ(mei->distortion(), DistortionModel::Omni);
  EXPECT_NEAR(mei->mean_focal(), 461.3, 0.1) << "of the lens that EuRoC publishes as radtan: 458";
  EXPECT_TRUE(fisheye->view_limit());
}

}  // namespace
}  // namespace edged
