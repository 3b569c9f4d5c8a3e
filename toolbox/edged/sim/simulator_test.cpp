// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/simulator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/io/test_support.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/test_recording.hpp"

namespace edged {
namespace {

/// Length of the mean acceleration [m/s^2].
double mean_accel(const SimulatorConfig& config) {
  Simulator simulator(config);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  while (const auto measurement = simulator.next()) {
    if (const auto* sample = std::get_if<ImuSample>(&*measurement)) sum += sample->accel_B, ++count;
  }
  return (sum / count).norm();
}

TEST(Simulator, GivesTheSameBitsForTheSameSeedOnly) {
  SimulatorConfig config = small("room", 1.2);
  const Recorded first = record(config), second = record(config);
  config.seed = 2;
  const Recorded other = record(config);
  EXPECT_GT(first.events.size(), 10000U);
  EXPECT_TRUE(same(first, second));
  EXPECT_FALSE(same(first, other));
}

TEST(Simulator, GivesTheSameFramesWhereEventsAreLeftOut) {
  Simulator with(small("room", 0.8)), without(small("room", 0.8));
  without.leave_out(Modality::Events);
  std::vector<Frame> frames;
  while (const auto measurement = with.next()) {
    if (const auto* frame = std::get_if<Frame>(&*measurement)) frames.push_back(*frame);
  }
  std::size_t same = 0;
  while (const auto measurement = without.next()) {
    EXPECT_FALSE(std::holds_alternative<EventBatch>(*measurement));
    const auto* frame = std::get_if<Frame>(&*measurement);
    if (frame == nullptr) continue;
    ASSERT_LT(same, frames.size());
    EXPECT_EQ(frame->t, frames[same].t);
    EXPECT_EQ(cv::norm(frame->image, frames[same].image, cv::NORM_INF), 0.0);
    ++same;
  }
  EXPECT_EQ(same, frames.size());
  EXPECT_LT(without.renderings(), with.renderings());
}

TEST(Simulator, HandsOutEverySensorInOneOrderOfTime) {
  for (const double offset_ms : {2.4, -7.3}) {
    SimulatorConfig config = small("room", 1.0);
    config.imu.time_offset_ms = offset_ms;
    Simulator simulator(config);
    Timestamp last = Timestamp::min();
    std::size_t frames = 0, samples = 0;
    while (const auto measurement = simulator.next()) {
      Timestamp first, final;
      if (const auto* batch = std::get_if<EventBatch>(&*measurement)) {
        ASSERT_FALSE(batch->events.empty());
        EXPECT_EQ(batch->camera, "events");
        first = batch->events.front().t, final = batch->events.back().t;
        EXPECT_LE(final - first, std::chrono::milliseconds(5));
      } else if (const auto* frame = std::get_if<Frame>(&*measurement)) {
        first = final = frame->t;
        ++frames;
      } else {
        first = final = std::get<ImuSample>(*measurement).t;
        ++samples;
      }
      ASSERT_LE(last, first);
      last = final;
    }
    EXPECT_EQ(frames, 24U);
    EXPECT_EQ(samples, 1001U);
  }
}

TEST(Simulator, TurnsAndStretchesTheAxesOfTheImuAsMuchAsItIsTold) {
  SimulatorConfig config = small("room", 1.2);
  config.motion.rest_s = 1.2;
  const double exact = mean_accel(config);
  config.imu.scale_error = 0.05;
  const double stretched = mean_accel(config);
  config.imu.cross_axis_mrad = 50.0;
  EXPECT_GT(std::abs(stretched - exact), 1e-3);
  EXPECT_LT(std::abs(stretched - exact), 3.0 * 0.05 * 9.81);
  EXPECT_NE(mean_accel(config), stretched);
}

TEST(Simulator, BlursFramesInMotionButNotAtRest) {
  SimulatorConfig config = small("handheld-fast", 1.2);
  config.frames.read_noise_electrons = 0.0;
  config.frames.electrons_per_ms *= 1e3, config.frames.electrons_per_level *= 1e3;
  config.frames.exposure_ms = 25.0;
  const Recorded slow = record(config);
  config.frames.electrons_per_ms *= 25.0 / 0.5;
  config.frames.exposure_ms = 0.5;
  const Recorded quick = record(config);
  ASSERT_EQ(slow.frames.size(), quick.frames.size());
  EXPECT_NEAR(sharpness(slow.frames[2].image) / sharpness(quick.frames[2].image), 1.0, 0.02);
  EXPECT_LT(sharpness(slow.frames.back().image), 0.6 * sharpness(quick.frames.back().image));
  EXPECT_NEAR(cv::norm(slow.frames[1].image, slow.frames[3].image, cv::NORM_INF), 0.0, 1.0);
}

TEST(Simulator, PresetsLookLikeTheirNames) {
  EXPECT_THROW(simulator_preset("submarine"), InputError);
  std::map<std::string, double> brightness, rate;
  for (const std::string name :
       {"room", "poster", "shapes", "handheld-fast", "handheld-wild", "walkers", "dark", "spot"}) {
    const Recorded recorded = record(small(name, 1.5));
    brightness[name] = cv::mean(recorded.frames.back().image)[0];
    rate[name] = static_cast<double>(recorded.events.size()) / 1.2;
    EXPECT_GT(rate[name], 3e4) << name;  // a quarter of a DAVIS240C's pixels
    EXPECT_LT(rate[name], 2e6) << name;
  }
  EXPECT_GT(brightness["shapes"], brightness["room"]);
  EXPECT_GT(brightness["room"], 40.0);
  EXPECT_LT(brightness["dark"], 20.0);
  EXPECT_GT(rate["handheld-fast"], rate["room"]);
  EXPECT_LT(brightness["spot"], brightness["room"]);
}

TEST(Simulator, ThePresetHandheldWildTurnsByUpToTenRadiansASecond) {
  const Simulator simulator(simulator_preset("handheld-wild"));
  double fastest = 0.0;
  for (double t = 0.0; t < 20.0; t += 0.01) fastest = std::max(fastest, simulator.trajectory().at(t).omega_B.norm());
  EXPECT_NEAR(fastest, 10.0, 1.0);
}

TEST(Simulator, PresetsOfFlightsAreTheElevenOfThePaper) {
  std::vector<std::string> last = simulator_presets();
  EXPECT_EQ(last.front(), "room");
  last.erase(last.begin(), last.end() - std::ssize(kPaperFlights));
  EXPECT_EQ(last, kPaperFlights);
  for (const std::string& name : kPaperFlights) {
    const SimulatorConfig config = simulator_preset(name);
    EXPECT_EQ(config.name, name);
    EXPECT_EQ(config.camera.width, 346);
    EXPECT_EQ(config.camera.height, 260);
    EXPECT_NEAR(config.T_B_C.R().determinant(), 1.0, 1e-12);
    EXPECT_NEAR(config.T_B_C.translation().norm(), 0.05, 0.005);
  }
  for (const char* dark : {"low-lit", "aggressive-lowlit"})
    EXPECT_LT(simulator_preset(dark).scene.light, 0.1 * simulator_preset("30-percent").scene.light) << dark;
}

TEST(Simulator, AFileIsAPresetThatDiffersFromItsBase) {
  const TempFolder folder;
  folder.write("mine.yaml", "summary: mine\nbase: circle\nscene: {light: 0.5}\n");
  folder.write("wrong.yaml", "motion: {hight: 2}\n");
  folder.write("turned-off.yaml", "T_B_C: 1 0 0\n");
  folder.write("endless.yaml", "base: endless\n");
  ::setenv("EDGED_PRESETS", folder.path().c_str(), 1);
  EXPECT_EQ(preset_summary("mine"), "mine");
  SimulatorConfig mine = simulator_preset("mine"), circle = simulator_preset("circle");
  EXPECT_EQ(mine.name, "mine");
  EXPECT_EQ(mine.scene.light, 0.5);
  EXPECT_EQ(mine.T_B_C.matrix(), circle.T_B_C.matrix());
  mine.scene.light = circle.scene.light;
  EXPECT_EQ(ConfigFields::of(mine).to_yaml(), ConfigFields::of(circle).to_yaml());
  const auto told = [](const char* preset) -> std::string {
    try {
      simulator_preset(preset);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(told("wrong"), testing::HasSubstr("wrong.yaml:1: unknown option 'motion.hight'"));
  EXPECT_THAT(told("turned-off"), testing::HasSubstr("T_B_C must be three rows of four numbers"));
  EXPECT_THAT(told("endless"), testing::HasSubstr("endless.yaml: its chain of base presets has no end"));
  ::unsetenv("EDGED_PRESETS");
}

TEST(Simulator, StampsFramesInTheMiddleOfExposuresThatAdaptToTheLight) {
  SimulatorConfig config = small("low-lit", 1.0);
  const Recorded recorded = record(config);
  ASSERT_EQ(recorded.frames.size(), 25U);
  // Frame k begins at (k + 0.1) / rate. The exposure is 8 ms at first, and soon the longest allowed.
  EXPECT_EQ(recorded.frames.front().t, timestamp_from_seconds(0.004 + 0.004));
  EXPECT_EQ(recorded.frames.back().t, timestamp_from_seconds(24.1 / 25.0 + 0.0125));
  EXPECT_LT(cv::mean(recorded.frames.back().image)[0], 25.0);
}

TEST(Simulator, GroundTruthIsTheBodyOnTheClockOfTheImu) {
  const SimulatorConfig config = small("poster", 1.0);
  const Simulator simulator(config);
  const auto truth = simulator.ground_truth();
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->frame, "body");
  ASSERT_EQ(truth->trajectory.size(), 201U);
  const StampedPose& pose = truth->trajectory[150];
  EXPECT_EQ(pose.t, timestamp_from_seconds(0.7524));
  EXPECT_EQ(pose.T.translation(), simulator.trajectory().at(0.75).T_W_B.translation());
  const Calibration calibration = simulator.calibration();
  EXPECT_EQ(calibration.rig.camera("events").time_offset, timestamp_from_seconds(0.0024).time_since_epoch());
  EXPECT_EQ(calibration.rig.camera("frames").model, config.camera.model());
}

TEST(Simulator, HasACameraOfEveryLensModelThatIsUsedInTheWholeImage) {
  for (const LensModel& lens : lens_models()) {
    if (lens.max_coefficients == 0) continue;
    SimulatorConfig config = small("room", 1.0);
    ConfigFields::of(config).set("camera.distortion=" + std::string(lens.name));
    const CameraModel model = config.camera.model();
    EXPECT_EQ(model.distortion(), lens.model);
    if (!lens.radius_of_angle) {
      EXPECT_EQ(model.coefficients()[1], config.camera.k2);
    }
    EXPECT_FALSE(model.view_limit()) << lens.name;
  }
  SimulatedCameraConfig omni;
  omni.distortion = DistortionModel::Omni;
  EXPECT_EQ(omni.model().coefficients(), (LensCoefficients{omni.xi, omni.k1, omni.k2, omni.p1, omni.p2}));
}

TEST(Simulator, RefusesAnExposureLongerThanThePeriod) {
  SimulatorConfig config = small("room", 1.0);
  ConfigFields::of(config).set("frames.exposure_ms=50");
  EXPECT_THROW(Simulator{config}, InputError);
}

}  // namespace
}  // namespace edged
