// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Two cameras of each kind in every container: what is written is read back, names, choice and damage.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include <map>
#include <opencv2/core.hpp>
#include <random>

#include "edged/io/calib/calib_test_support.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"
#include "edged/io/test_support.hpp"
#include "edged/io/write_recording.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const cv::Size kSize(240, 180);
const RecordingOptions kAll{.all_cameras = true};

/// Cameras of those names: event cameras, then frame cameras.
Rig rig_of(const std::vector<std::string>& events, const std::vector<std::string>& frames) {
  Rig rig{"head", {}};
  const auto add = [&rig](const std::string& name, Modality modality) {
    const double x_m = 0.1 * static_cast<double>(rig.cameras.size());
    rig.cameras.push_back({name, modality, CameraModel(kSize.width, kSize.height, 200, 200, 120, 90),
                           SE3(Eigen::Quaterniond::Identity(), {x_m, 0, 0}), Duration(0)});
  };
  for (const std::string& name : events) add(name, Modality::Events);
  for (const std::string& name : frames) add(name, Modality::Frames);
  return rig;
}

Calibration stereo_calibration() {
  Calibration calibration;
  calibration.rig = rig_of({"left", "right"}, {"grey", "color"});
  return calibration;
}

/// 200 ms of two event cameras, two frame cameras and an IMU; stamps of events are whole microseconds.
ListedDataset stereo_dataset() {
  ListedDataset d;
  DatasetInfo& info = d.describe();
  info.event_camera = "left";
  info.frame_camera = "grey";
  info.more_cameras = {{"right", Modality::Events, "", kSize}, {"color", Modality::Frames}};
  std::mt19937_64 random(11);
  const auto events_of = [&random](const char* camera, Timestamp t) {
    EventBatch batch{camera, {}};
    for (const Timestamp end = t + std::chrono::microseconds(900); t < end;
         t += std::chrono::microseconds(1 + random() % 20))
      batch.events.push_back({t, static_cast<std::uint16_t>(random() % 240), static_cast<std::uint16_t>(random() % 180),
                              random() % 2 == 1});
    return batch;
  };
  Timestamp t = timestamp_from_ns(1'468'939'993'067'416'000);
  for (int i = 0; i < 200; ++i, t += std::chrono::milliseconds(1)) {
    const double turn = uniform(random);
    d.measurements.push_back(ImuSample{t, {turn, -turn, 0.5}, {0, 9.81, turn}});
    d.measurements.push_back(events_of("left", t));
    d.measurements.push_back(events_of("right", t + std::chrono::microseconds(2)));
    if (i % 40 != 0) continue;
    for (const char* camera : {"grey", "color"}) {
      cv::Mat image(kSize, CV_8UC1);
      for (auto& pixel : cv::Mat_<std::uint8_t>(image)) pixel = static_cast<std::uint8_t>(random());
      d.measurements.push_back(Frame{t + std::chrono::microseconds(950), camera, image});
    }
  }
  d.truth = GroundTruth{{{t, SE3(Eigen::Quaterniond(0.8, 0, 0, 0.6), {1, 2, 3})}}, "left"};
  info.pose_frame = "left";
  return d;
}

/// What each camera has seen.
struct Seen {
  std::map<std::string, std::vector<Event>> events;
  std::map<std::string, std::vector<std::pair<Timestamp, cv::Mat>>> frames;
};

Seen seen_in(Dataset& dataset, const std::map<std::string, std::string>& renamed = {}) {
  Seen seen;
  const auto name = [&](const std::string& camera) { return renamed.contains(camera) ? renamed.at(camera) : camera; };
  while (const auto m = dataset.next()) {
    if (const auto* batch = std::get_if<EventBatch>(&*m)) {
      auto& events = seen.events[name(batch->camera)];
      events.insert(events.end(), batch->events.begin(), batch->events.end());
    }
    if (const auto* frame = std::get_if<Frame>(&*m))
      seen.frames[name(frame->camera)].emplace_back(frame->t, frame->image);
  }
  return seen;
}

bool same(const Seen& a, const Seen& b) {
  const auto same_frame = [](const auto& x, const auto& y) {
    return x.first == y.first && cv::norm(x.second, y.second, cv::NORM_INF) == 0.0;
  };
  if (!(a.events == b.events) || a.frames.size() != b.frames.size()) return false;
  for (const auto& [camera, frames] : a.frames)
    if (!b.frames.contains(camera) || !std::ranges::equal(frames, b.frames.at(camera), same_frame)) return false;
  return true;
}

const std::map<std::string, std::string> kUsual = {
    {"left", "events"}, {"right", "events2"}, {"grey", "frames"}, {"color", "frames2"}};

class TwoCamerasOfAKind : public ::testing::TestWithParam<WritableFormat> {
 protected:
  fs::path write() const {
    const fs::path file = folder_.path() / fmt::format("out{}", GetParam().extension);
    ListedDataset source = stereo_dataset();
    write_recording(source, GetParam(), file, stereo_calibration());
    return file;
  }
  TempFolder folder_;
};

TEST_P(TwoCamerasOfAKind, ComeBackToTheLastBitUnderTheUsualNames) {
  const Recording r = open_recording(write(), nullptr, kAll);
  ListedDataset source = stereo_dataset();
  const auto cameras = recorded_cameras(r.dataset->info());
  ASSERT_EQ(cameras.size(), 4u);
  EXPECT_EQ(cameras[1].name, "events2");
  EXPECT_EQ(cameras[1].sensor, kSize);
  EXPECT_EQ(cameras[3].name, "frames2");
  EXPECT_TRUE(same(seen_in(*r.dataset), seen_in(source, kUsual)));
  EXPECT_EQ(r.dataset->info().pose_frame, "events");
  EXPECT_TRUE(r.dataset->repairs().empty());
}

TEST_P(TwoCamerasOfAKind, AreReadOnlyWhereTheyAreWanted) {
  const fs::path file = write();
  const Recording first = open_recording(file);
  const Seen of_first = seen_in(*first.dataset);
  EXPECT_TRUE(first.dataset->info().more_cameras.empty());
  EXPECT_EQ(of_first.events.size(), 1u);
  EXPECT_TRUE(of_first.events.contains("events") && of_first.frames.contains("frames"));
  const Recording second = open_recording(file, nullptr, {.cameras = {"events2", "frames2"}});
  const Seen of_second = seen_in(*second.dataset);
  EXPECT_EQ(of_second.events.size() + of_second.frames.size(), 2u);
  EXPECT_TRUE(of_second.events.contains("events2") && of_second.frames.contains("frames2"));
  EXPECT_EQ(second.dataset->info().event_camera, "events2");
  EXPECT_EQ(second.dataset->info().pose_frame, "events") << "whichever is read";
  const Recording no_events = open_recording(file, nullptr, kAll);
  no_events.dataset->leave_out(Modality::Events);
  const Seen of_frames = seen_in(*no_events.dataset);
  EXPECT_TRUE(of_frames.events.empty());
  EXPECT_EQ(of_frames.frames.at("frames2").size(), 5u);
}

TEST_P(TwoCamerasOfAKind, HaveTheNamesOfTheRigThatTheUserGives) {
  const Rig rig = rig_of({"dvs_l", "dvs_r"}, {"cam0", "cam1"});
  const Recording r = open_recording(write(), &rig, kAll);
  ListedDataset source = stereo_dataset();
  const std::map<std::string, std::string> names = {
      {"left", "dvs_l"}, {"right", "dvs_r"}, {"grey", "cam0"}, {"color", "cam1"}};
  EXPECT_TRUE(same(seen_in(*r.dataset), seen_in(source, names)));
  EXPECT_EQ(r.dataset->info().pose_frame, "dvs_l");
  Rig matched = rig;
  EXPECT_EQ(match_camera(matched, r.dataset->info(), Modality::Events), "");
  EXPECT_EQ(match_camera(matched, r.dataset->info(), Modality::Frames), "");
}

/// Only the folder and the bags hold a calibration.
TEST_P(TwoCamerasOfAKind, KeepTheirCalibrationWhereTheFormatHasOne) {
  const Recording r = open_recording(write(), nullptr, kAll);
  if (!r.calibration) return;
  std::vector<std::string> names;
  for (const RigCamera& camera : r.calibration->rig.cameras) names.push_back(camera.name);
  EXPECT_THAT(names, ElementsAre("events", "events2", "frames", "frames2"));
}

TEST_P(TwoCamerasOfAKind, CutOrDamagedTheyGiveOneLineOrWhatIsWhole) {
  if (GetParam().extension.empty()) GTEST_SKIP() << "a folder";
  const std::string whole = read_text(write());
  std::mt19937 random(5);
  std::size_t read = 0;
  for (int i = 0; i < 60; ++i) {
    std::string damaged = i < 20 ? whole.substr(0, whole.size() * static_cast<std::size_t>(i) / 20) : whole;
    if (i >= 20) damaged[random() % whole.size()] ^= static_cast<char>(1U << random() % 8);
    const fs::path file = folder_.write(fmt::format("damaged{}", GetParam().extension), damaged);
    const std::string refusal = input_error([&] {
      const Recording r = open_recording(file, nullptr, kAll);
      for (const auto& [camera, events] : seen_in(*r.dataset).events) {
        EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::t));
        read += events.size();
      }
    });
    EXPECT_EQ(refusal.find('\n'), std::string::npos) << refusal;
  }
  EXPECT_GT(read, 0u);
}

std::vector<WritableFormat> formats_of_several() {
  std::vector<WritableFormat> formats;
  for (const WritableFormat& format : writable_formats())
    if (format.several_cameras) formats.push_back(format);
  return formats;
}

INSTANTIATE_TEST_SUITE_P(All, TwoCamerasOfAKind, ::testing::ValuesIn(formats_of_several()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(SeveralCameras, FormatsOfOneEventCameraRefuseTwo) {
  for (const WritableFormat& format : writable_formats()) {
    if (format.several_cameras) continue;
    TempFolder folder;
    ListedDataset source = stereo_dataset();
    const fs::path file = folder.path() / fmt::format("a{}", format.extension);
    EXPECT_THAT(input_error([&] { write_recording(source, format, file, stereo_calibration()); }),
                HasSubstr("holds one event camera, not both left and right: choose one with --cameras"));
  }
}

/// A bag of two event cameras, two frame cameras and an IMU on those topics.
class StereoBags : public ::testing::TestWithParam<BagContainer> {
 protected:
  Recording open(const std::vector<std::string>& names, const RecordingOptions& options,
                 const Rig* rig = nullptr) const {
    fs::remove(folder_.path() / "unused");
    const Wire wire = GetParam().make(folder_.path() / "unused")->wire();
    std::vector<TestTopic> topics;
    const Timestamp t0 = timestamp_from_seconds(100);
    for (std::size_t i = 0; i < names.size(); ++i) {
      const bool events = i < 2;
      TestTopic& topic =
          topics.emplace_back(TestTopic{names[i], events ? "dvs_msgs/EventArray" : "sensor_msgs/Image", {}, {}});
      for (int k = 0; k < 4; ++k) {
        const Timestamp t = t0 + std::chrono::milliseconds(10 * k + static_cast<int>(i));
        const int count = 10 + static_cast<int>(i);  // tells the cameras apart
        topic.messages.emplace_back(
            t, events ? event_array_message(wire, bag_events(t, count, 1), kBagSensor)
                      : image_message(wire, {t, "", cv::Mat(20, 30 + static_cast<int>(i), CV_8UC1, cv::Scalar(7))}));
      }
    }
    TestTopic& imu = topics.emplace_back(TestTopic{"/imu", "sensor_msgs/Imu", {}, {}});
    for (int k = 0; k < 8; ++k) {
      const Timestamp t = t0 + std::chrono::milliseconds(5 * k);
      imu.messages.emplace_back(t, imu_message(wire, {t, {0, 0, 1}, {0, 0, 9.8}}));
    }
    fs::remove(folder_.path() / fmt::format("a{}", GetParam().extension));
    return open_recording(write_bag(folder_, GetParam(), topics), rig, options);
  }

  /// The topic of each camera: "cam0=/left/events".
  static std::vector<std::string> assigned(const Recording& r) {
    std::vector<std::string> out;
    for (const RecordedCamera& camera : recorded_cameras(r.dataset->info()))
      out.push_back(camera.name + "=" + camera.stream);
    return out;
  }

  TempFolder folder_;
};

const std::vector<std::string> kTopics = {"/left/events", "/right/events", "/left/image_raw", "/right/image_raw"};

TEST_P(StereoBags, GiveEachTopicToItsCamera) {
  const Recording r = open(kTopics, kAll);
  EXPECT_THAT(assigned(r), ElementsAre("events=/left/events", "events2=/right/events", "frames=/left/image_raw",
                                       "frames2=/right/image_raw"));
  const Seen seen = seen_in(*r.dataset);
  EXPECT_EQ(seen.events.at("events").size(), 40u);
  EXPECT_EQ(seen.events.at("events2").size(), 44u);
  EXPECT_EQ(seen.frames.at("frames").front().second.cols, 32);
  EXPECT_EQ(seen.frames.at("frames2").front().second.cols, 33);
}

TEST_P(StereoBags, AreAssignedByTheTopicsOfTheCalibration) {
  const Rig rig = rig_of({"dvs0", "dvs1"}, {"cam0", "cam1"});
  RecordingOptions options = kAll;
  options.camera_topics = {{"dvs0", "/right/events"}, {"dvs1", "/left/events"}, {"cam0", "/right/image_raw"}};
  EXPECT_THAT(assigned(open(kTopics, options, &rig)),
              ElementsAre("dvs0=/right/events", "dvs1=/left/events", "cam0=/right/image_raw"));
  // Kalibr calibrates event cameras with images: their events are in the same name space.
  options.camera_topics = {{"dvs0", "/right/e2vid"}, {"dvs1", "/left/e2vid"}};
  EXPECT_THAT(assigned(open(kTopics, options, &rig)),
              ElementsAre("dvs0=/right/events", "dvs1=/left/events", "cam0=/left/image_raw", "cam1=/right/image_raw"));
  const Rig mono = rig_of({"cam1"}, {"cam0"});
  options.camera_topics = {{"cam1", "/right/events"}, {"cam0", "/right/image_raw"}};
  EXPECT_THAT(assigned(open(kTopics, options, &mono)), ElementsAre("events=/right/events", "frames=/right/image_raw"));
  options.cameras = {"cam1", "cam0"};
  EXPECT_THAT(assigned(open(kTopics, options, &mono)), ElementsAre("cam1=/right/events", "cam0=/right/image_raw"));
}

TEST_P(StereoBags, OfTwoDavisAreTwoCamerasOfEachKindByTheChainOfKalibr) {
  const std::vector<std::string> topics = {"/davis/left/events", "/davis/right/events", "/davis/left/image_raw",
                                           "/davis/right/image_raw"};
  const auto assigned_by = [&](const std::vector<std::string>& calibrated) {
    const Calibration c = load_calibration(folder_.write("camchain-imucam.yaml", kalibr_chain(calibrated, 240, 180)));
    RecordingOptions options = kAll;
    options.camera_topics = c.topics;
    return assigned(open(topics, options, &c.rig));
  };
  for (const char* calibrated_with : {"image_raw", "events"})
    EXPECT_THAT(
        assigned_by({fmt::format("/davis/right/{}", calibrated_with), fmt::format("/davis/left/{}", calibrated_with)}),
        ElementsAre("events=/davis/right/events", "cam1_events=/davis/left/events", "frames=/davis/right/image_raw",
                    "cam1_frames=/davis/left/image_raw"));
  EXPECT_THAT(assigned_by({topics[1], topics[3], topics[0], topics[2]}),
              ElementsAre("cam0=/davis/right/events", "cam2=/davis/left/events", "cam1=/davis/right/image_raw",
                          "cam3=/davis/left/image_raw"));
}

TEST_P(StereoBags, ElseByTheNamesOfTheRigOrInOrder) {
  const Rig swapped = rig_of({"right_dvs", "left_dvs"}, {"cam0", "cam1"});
  EXPECT_THAT(assigned(open(kTopics, kAll, &swapped)), ElementsAre("right_dvs=/right/events", "left_dvs=/left/events",
                                                                   "cam0=/left/image_raw", "cam1=/right/image_raw"));
  RecordingOptions some;
  some.cameras = {"left_dvs", "cam1"};
  EXPECT_THAT(assigned(open(kTopics, some, &swapped)), ElementsAre("left_dvs=/left/events", "cam1=/right/image_raw"));
}

TEST_P(StereoBags, OrByTheUser) {
  const Rig rig = rig_of({"dvs0", "dvs1"}, {"cam0", "cam1"});
  RecordingOptions options = kAll;
  options.topics = {{"dvs0", "/right/events"}, {"dvs1", "/left/events"}, {"frames", "none"}};
  EXPECT_THAT(assigned(open(kTopics, options, &rig)), ElementsAre("dvs0=/right/events", "dvs1=/left/events"));
  options.topics = {{"events2", "/left/events"}, {"frames2", "none"}};
  EXPECT_THAT(assigned(open(kTopics, options)),
              ElementsAre("events=/right/events", "events2=/left/events", "frames=/left/image_raw"));
}

TEST_P(StereoBags, RefuseInOneLineWhatIsGivenTwiceOrUnknown) {
  const Rig rig = rig_of({"dvs0", "dvs1"}, {"cam0"});
  const auto refusal = [&](const RecordingOptions& options) {
    return input_error([&] { open(kTopics, options, &rig); });
  };
  EXPECT_THAT(refusal({.topics = {{"dvs0", "/left/events"}, {"dvs1", "/left/events"}, {"frames", "none"}}}),
              HasSubstr("--topic dvs1=/left/events: the topic is that of dvs0 already"));
  EXPECT_THAT(refusal({.topics = {{"dvs7", "/left/events"}, {"frames", "none"}}}),
              AllOf(HasSubstr("the name of a camera: dvs0, dvs1, cam0")));
  EXPECT_THAT(
      refusal({.topics = {{"frames", "none"}}, .camera_topics = {{"dvs0", "/left/events"}, {"dvs1", "/left/events"}}}),
      HasSubstr("topic /left/events is that of two cameras, dvs0 and dvs1"));
  EXPECT_THAT(refusal({.topics = {{"dvs0", "/up"}, {"frames", "none"}}}), HasSubstr("no topic /up that could be"));
  EXPECT_THAT(refusal({}), HasSubstr("several topics for one role, choose with --topic ROLE=NAME (or ROLE=none, "
                                     "CAMERA=NAME); frames: /left/image_raw, /right/image_raw"));
}

INSTANTIATE_TEST_SUITE_P(All, StereoBags, ::testing::ValuesIn(kBagContainers),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(SeveralCameras, TopicsOfKalibrAndOfOurCalibrationsAreKept) {
  TempFolder folder;
  const std::string camera =
      "  camera_model: pinhole\n  intrinsics: [200, 200, 120, 90]\n  distortion_model: none\n  distortion_coeffs: []\n"
      "  resolution: [240, 180]\n  T_cam_imu: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  const Calibration kalibr = load_calibration(
      folder.write("camchain.yaml", "cam0:\n" + camera + "  rostopic: /prophesee/left/events\ncam1:\n" + camera +
                                        "  rostopic: /davis/image_raw\ncam2:\n" + camera + "  modality: frames\n"));
  const std::map<std::string, std::string> topics = {
      {"cam0", "/prophesee/left/events"}, {"events", "/davis/image_raw"}, {"frames", "/davis/image_raw"}};
  EXPECT_EQ(kalibr.topics, topics) << "a DAVIS is two cameras";
  EXPECT_EQ(load_calibration(folder.write("own.yaml", to_yaml(kalibr))).topics, topics);
}

TEST(SeveralCameras, ARecordingThatNamesACameraTheRigLacksIsRefusedWithBothLists) {
  ListedDataset source = stereo_dataset();
  Rig rig = rig_of({"left", "other"}, {"grey", "color"});
  EXPECT_THAT(input_error([&] { match_camera(rig, source.info(), Modality::Events); }),
              AllOf(HasSubstr("left (events), right (events)"), HasSubstr("left (events), other (events)"),
                    HasSubstr("none is called 'right'")));
}

}  // namespace
}  // namespace edged
