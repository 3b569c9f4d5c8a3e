// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibrations that are well-formed, but wrong.
#include "edged/io/calib/calib_test_support.hpp"

namespace edged {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A valid calibration in the format of this program, with one change by a test.
struct Own {
  std::string size = "[346, 260]", intrinsics = "[250, 250, 173, 130]", rotation_x = "1, 0, 0", at = "0.1";

  std::string text() const {
    return "edged_rig: 1\ncameras:\n  - name: events\n    modality: events\n    resolution: " + size +
           "\n    intrinsics: " + intrinsics + "\n    T_B_C:\n      - [" + rotation_x + ", " + at +
           "]\n      - [0, 1, 0, 0]\n      - [0, 0, 1, 0]\n      - [0, 0, 0, 1]\n";
  }
};

class Plausibility : public CalibrationFiles {
 protected:
  std::vector<std::string> warnings(const Own& own) { return load(own.text()).warnings; }
  std::string complaint(const Own& own) { return CalibrationFiles::complaint(own.text()); }
};

TEST_F(Plausibility, AnOrdinaryHeadPassesWithoutAWord) { EXPECT_THAT(warnings({}), IsEmpty()); }

TEST_F(Plausibility, LongLeverArmsAndMillimetresAreNamed) {
  EXPECT_THAT(warnings({.at = "0.7"}), ElementsAre(HasSubstr("camera events: 0.70 m away from the IMU")));
  EXPECT_THAT(warnings({.at = "-26.0"}),
              ElementsAre(::testing::AllOf(HasSubstr("26 m away"), HasSubstr("in millimetres (0.026 m), divide"))));
}

TEST_F(Plausibility, RotationsAreMeasured) {
  EXPECT_THAT(warnings({.rotation_x = "1.0000001, 0, 0"}), IsEmpty());
  EXPECT_THAT(warnings({.rotation_x = "1.0001, 0, 0"}), ElementsAre(HasSubstr("orthonormal only to 0.0002")));
  EXPECT_THAT(complaint({.rotation_x = "1.01, 0, 0"}), HasSubstr("differs from 1 by 0.0201"));
  EXPECT_THAT(complaint({.rotation_x = "-1, 0, 0"}), HasSubstr("mirrored"));
}

TEST_F(Plausibility, FocalLengthsMustGiveAFieldOfViewThatLensesHave) {
  EXPECT_THAT(complaint({.intrinsics = "[4.5, 4.5, 173, 130]"}), HasSubstr("must be in pixels"));
  EXPECT_THAT(complaint({.intrinsics = "[250000, 250000, 173, 130]"}), HasSubstr("impossible"));
  EXPECT_THAT(warnings({.intrinsics = "[3000, 3000, 173, 130]"}), ElementsAre(HasSubstr("field of view of 8.")));
  EXPECT_THAT(warnings({.intrinsics = "[250, 300, 173, 130]"}), ElementsAre(HasSubstr("pixels are square")));
}

TEST_F(Plausibility, AFisheyeMaySeeBehindItself) {
  const auto fisheye = [](const std::string& focal, const std::string& more = "") {
    return Own{.size = "[512, 512]",
               .intrinsics = "[" + focal + ", " + focal +
                             ", 255, 257]\n    distortion: equidistant\n    coefficients: "
                             "[0.0035, 0.0007, -0.002, 0.0002]" +
                             more};
  };
  EXPECT_THAT(warnings(fisheye("191")), IsEmpty());
  EXPECT_THAT(complaint(fisheye("19.1")), HasSubstr("impossible"));
  EXPECT_THAT(complaint(fisheye("191", "\n    max_angle: 95")),
              HasSubstr("max_angle: the view limit of a lens must be"));
  const Calibration narrow = load(fisheye("191", "\n    max_angle: 50").text());
  EXPECT_NEAR(*narrow.rig.cameras[0].model.view_limit(), 0.8727, 1e-4);
  EXPECT_THAT(describe(narrow), HasSubstr("used up to 50 deg off its axis"));
  EXPECT_THAT(to_yaml(narrow), HasSubstr("max_angle: 50 "));
  const Calibration odd = load(fisheye("191", "\n    max_angle: 48").text());
  EXPECT_EQ(load(to_yaml(odd)).rig.cameras[0].model, odd.rig.cameras[0].model);
  EXPECT_THAT(to_yaml(load(fisheye("191").text())), Not(HasSubstr("max_angle")));
}

TEST_F(Plausibility, ThePrincipalPointMustFitTheImage) {
  EXPECT_THAT(warnings({.size = "[260, 346]"}), ElementsAre(HasSubstr("width and height swapped")));
  EXPECT_THAT(warnings({.size = "[240, 260]"}), ElementsAre(HasSubstr("22 % off the middle of 240 x 260")));
}

TEST_F(Plausibility, OneLensHasOneSize) {
  Own own;
  own.size = "[300, 260]";
  std::string second = own.text();
  second = second.substr(second.find("  - name"));
  second.replace(second.find("events"), 6, "other");
  const Calibration c = load(Own{}.text() + second);
  EXPECT_THAT(c.warnings, ElementsAre(HasSubstr("has the lens of camera events but 300 x 260")));
}

TEST_F(Plausibility, EveryRigThatShipsIsPlausible) {
  EXPECT_THAT(known_rigs(), ::testing::Contains("davis240c_ecd"));
  for (const std::string& name : known_rigs()) {
    const Calibration c = load_rig(name);
    EXPECT_EQ(c.rig.name, name);
    EXPECT_THAT(c.warnings, IsEmpty()) << name;
    EXPECT_TRUE(c.has_extrinsics) << name;
    EXPECT_NE(c.rig.find(Modality::Events), nullptr) << name;
    for (const RigCamera& camera : c.rig.cameras) {
      EXPECT_LT(camera.T_B_C.translation().norm(), 0.3) << name << " " << camera.name;
      EXPECT_LT(std::abs(to_seconds(camera.time_offset)), 0.05) << name << " " << camera.name;
    }
  }
}

}  // namespace
}  // namespace edged
