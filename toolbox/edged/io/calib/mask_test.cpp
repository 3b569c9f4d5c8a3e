// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Masks from pictures: read, written as text, refused.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "edged/io/calibration.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

class MaskOfACamera : public ::testing::Test {
 protected:
  /// The calibration with these lines in its camera.
  std::filesystem::path calibration(const std::string& lines, const std::string& beside_same_as = "") {
    folder_.write("rig.yaml",
                  "edged_rig: 1\nname: own\ncameras:\n  - name: events\n    modality: events\n"
                  "    resolution: [240, 180]\n    intrinsics: [200, 201, 120, 90]\n" +
                      lines +
                      "    T_B_C: [[0, 0, 1, 0.1], [-1, 0, 0, 0.2], [0, -1, 0, 0.3], [0, 0, 0, 1]]\n"
                      "  - name: frames\n    modality: frames\n    same_as: events\n" +
                      beside_same_as);
    return folder_.path() / "rig.yaml";
  }
  std::string refusal(const std::string& lines) {
    return input_error([&] { load_calibration(calibration(lines)); });
  }
  /// White inside a circle, except for a bar.
  void draw(const std::string& name, int width = 240, int height = 180) {
    cv::Mat picture(height, width, CV_8UC1, cv::Scalar(255));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (std::hypot(x - width / 2.0, y - height / 2.0) > 0.6 * width || y >= height - 10)
          picture.at<std::uint8_t>(y, x) = 0;
    folder_.write_image(name, picture);
  }

  TempFolder folder_;
};

TEST_F(MaskOfACamera, IsReadBesideItsFileAndIsThatOfAllCamerasOfTheLens) {
  draw("mask.png");
  const Calibration calibration = load_calibration(this->calibration("    mask: mask.png\n"));
  for (const RigCamera& camera : calibration.rig.cameras) {
    EXPECT_TRUE(camera.model.uses(120, 90) && camera.model.uses(60, 169));
    EXPECT_FALSE(camera.model.uses(120, 170) || camera.model.uses(0, 0));
  }
  EXPECT_THAT(describe(calibration), HasSubstr("of its pixels are ignored"));
}

TEST_F(MaskOfACamera, IsKeptInACalibrationThatIsWrittenAnew) {
  draw("mask.png");
  const Calibration first = load_calibration(calibration("    mask: mask.png\n"));
  TempFolder elsewhere;
  elsewhere.write("again.yaml", to_yaml(first));
  const Calibration again = load_calibration(elsewhere.path() / "again.yaml");
  EXPECT_TRUE(again.rig.cameras[0].model == first.rig.cameras[0].model);
  EXPECT_TRUE(again.rig.cameras[1].model == first.rig.cameras[1].model);
}

TEST_F(MaskOfACamera, IsRefusedWithItsKeyItsFileAndWhatToDo) {
  draw("small.png", 120, 90);
  folder_.write("black.txt", "no picture");
  folder_.write_image("black.png", 240, 180, 0);
  draw("cut.png");
  std::filesystem::resize_file(folder_.path() / "cut.png", 40);
  EXPECT_THAT(refusal("    mask: none.png\n"), HasSubstr("none.png: no such picture; its name is relative"));
  EXPECT_THAT(refusal("    mask: small.png\n"), HasSubstr("small.png: has 120 x 90 px, the camera 240 x 180"));
  EXPECT_THAT(refusal("    mask: black.txt\n"), HasSubstr("black.txt: cannot be read as a picture; write it as PNG"));
  EXPECT_THAT(refusal("    mask: cut.png\n"), HasSubstr("cut.png: cannot be read as a picture"));
  EXPECT_THAT(refusal("    mask: black.png\n"), HasSubstr("mask: the mask ignores every pixel"));
  EXPECT_THAT(refusal("    mask: none.png\n"), HasSubstr("rig.yaml:"));
}

TEST_F(MaskOfACamera, APipeIsNoPicture) {
  ASSERT_EQ(::mkfifo((folder_.path() / "pipe.png").c_str(), 0600), 0);
  EXPECT_THAT(refusal("    mask: pipe.png\n"), HasSubstr("pipe.png: is not a file but a pipe or a device"));
}

TEST_F(MaskOfACamera, RunsOfPixelsMustMakeUpTheImage) {
  EXPECT_THAT(refusal("    mask_runs: \"100 40\"\n"), HasSubstr("describes 140 pixels, the camera has 43200"));
  EXPECT_THAT(refusal("    mask_runs: \"100 x\"\n"), HasSubstr("must be numbers of pixels that make up 240 x 180"));
  EXPECT_THAT(refusal("    mask_runs: \"43201\"\n"), HasSubstr("must be numbers of pixels"));
  EXPECT_THAT(refusal("    mask_runs: \"-1 5\"\n"), HasSubstr("must be numbers of pixels"));
  draw("mask.png");
  EXPECT_THAT(refusal("    mask: mask.png\n    mask_runs: \"43200\"\n"), HasSubstr("cannot be combined with mask"));
  EXPECT_THAT(input_error([&] { load_calibration(calibration("", "    mask: mask.png\n")); }),
              HasSubstr("cannot be combined with same_as"));
}

}  // namespace
}  // namespace edged
