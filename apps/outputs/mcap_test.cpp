// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Results as MCAP, read by our own reader; tests/program/mcap_test.py uses another one.
#include "outputs/mcap.hpp"

#include <gtest/gtest.h>

#include "edged/camera/undistort.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

Rig one_camera() {
  Rig rig;
  rig.cameras.push_back({"left", Modality::Frames, CameraModel(1280, 960, 500, 510, 639.5, 479.5), SE3()});
  return rig;
}

/// Good, a keyframe, 30 ms apart.
Step step_of(int number) {
  Step step;
  step.t = timestamp_from_ns(5'000'000'000 + 30'000'000LL * number);
  step.status = TrackingStatus::Good;
  step.keyframe = true;
  step.state.T_W_B = SE3(Eigen::Quaterniond::Identity(), {0.01 * number, 0, 0});
  step.landmarks = {{7, {1, 2, 3}}};
  step.cameras = {{.name = "left", .image = cv::Mat(960, 1280, CV_8UC1, cv::Scalar(90))}};
  return step;
}

/// Messages by topic; each must be json.
std::map<std::string, std::vector<foxglove::Json>> read_results(const std::filesystem::path& file) {
  const auto source = open_messages(file, nullptr);
  std::map<std::string, std::vector<foxglove::Json>> messages;
  while (const auto message = source->next())
    messages[source->topics()[message->topic].name].push_back(foxglove::Json::parse(as_text(message->data)));
  for (const Topic& topic : source->topics()) EXPECT_EQ(topic.count, messages[topic.name].size()) << topic.name;
  return messages;
}

class ResultsMcapFile : public ::testing::Test {
 protected:
  void add_steps(ResultsMcap& results, int steps) {
    for (int i = 0; i < steps; ++i) {
      snapshots_.add(step_of(i));
      results.add(step_of(i), snapshots_);
    }
  }

  TempFolder folder_;
  std::filesystem::path file_ = folder_.path() / "results.mcap";
  Snapshots snapshots_;
};

TEST_F(ResultsMcapFile, HoldsNumbersOfEveryStepAndTheRestAtItsPace) {
  ResultsMcap results(file_, one_camera(), {{"version", "1"}});
  add_steps(results, 400);  // 12 s
  results.finish({}, snapshots_, {}, {});
  const auto messages = read_results(file_);
  EXPECT_EQ(messages.at("/stats").size(), 400u);
  EXPECT_EQ(messages.at("/pose").size(), 400u);
  EXPECT_EQ(messages.at("/pose").back()["pose"]["position"]["x"], 3.99);
  EXPECT_EQ(messages.at("/frames/image").size(), 58u);  // one of seven steps: the first after 200 ms
  EXPECT_EQ(messages.at("/map").size(), 4u);            // three, and that of the end
  EXPECT_EQ(messages.at("/log").front()["message"], "Good");
  // However long the run, paths stay short.
  EXPECT_LE(messages.at("/path").back()["poses"].size(), 300u);
  EXPECT_GE(messages.at("/path").back()["poses"].size(), 150u);
  EXPECT_FALSE(messages.contains("/events/image"));
}

TEST_F(ResultsMcapFile, DescribesThePicturesThatItHolds) {
  ResultsMcap results(file_, one_camera(), {});
  add_steps(results, 1);
  results.finish({}, snapshots_, {}, {});
  const foxglove::Json calibration = read_results(file_).at("/frames/calibration").at(0);
  EXPECT_EQ(calibration["width"], 640);
  EXPECT_EQ(calibration["height"], 480);
  EXPECT_EQ(calibration["frame_id"], "left");
  EXPECT_EQ(calibration["K"], foxglove::Json::parse("[250.0, 0, 319.5, 0, 255.0, 239.5, 0, 0, 1]"));
  EXPECT_EQ(calibration["D"], foxglove::Json::array());
}

TEST_F(ResultsMcapFile, DescribesEventPicturesWithoutTheDistortionThatTheyHaveNoMore) {
  const CameraModel lens(240, 180, 199, 200, 133, 114, DistortionModel::RadTan, {-0.38, 0.19, 0, 0, 0});
  const CameraModel ideal = ideal_pinhole(lens);
  ResultsMcap results(
      file_, {"davis", {{"events", Modality::Events, lens, SE3()}, {"left", Modality::Frames, lens, SE3()}}}, {});
  add_steps(results, 1);
  results.finish({}, snapshots_, {}, {});
  auto messages = read_results(file_);
  const foxglove::Json events = messages.at("/events/calibration").at(0),
                       frames = messages["/frames/calibration"].at(0);
  EXPECT_EQ(events["D"], foxglove::Json::array());
  EXPECT_EQ(events["distortion_model"], "");
  EXPECT_EQ(events["K"], foxglove::Json({ideal.fx(), 0.0, ideal.cx(), 0.0, ideal.fy(), ideal.cy(), 0.0, 0.0, 1.0}));
  EXPECT_EQ(frames["K"][0], 199.0);
  EXPECT_EQ(frames["D"].size(), 5u);
}

TEST_F(ResultsMcapFile, ThatIsNeverFinishedGivesWhatCameBefore) {
  {
    ResultsMcap results(file_, one_camera(), {});
    add_steps(results, 400);
  }
  EXPECT_GT(read_results(file_).at("/stats").size(), 100u);
}

TEST_F(ResultsMcapFile, IsToldFromARecordingByItsTopics) {
  ResultsMcap results(file_, one_camera(), {});
  add_steps(results, 1);
  results.finish({}, snapshots_, {}, {});
  const std::string refusal = input_error([&] { open_recording(file_); });
  EXPECT_NE(refusal.find("/pose (foxglove.PoseInFrame in json)"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace edged
