// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Each family of messages in both wire formats, and the choice of topics.
#include "edged/io/ros/messages/messages.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/evt_test_support.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr Timestamp kStart = timestamp_from_ns(1'700'000'000'000'000'000);
constexpr std::uint64_t kStartNs = 1'700'000'000'000'000'000;
const BagContainer& kPlainBag = kBagContainers[0];
const BagContainer& kPlainMcap = kBagContainers[2];

ImuSample still(Timestamp t) { return {t, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}; }

class Messages : public ::testing::TestWithParam<Wire> {
 protected:
  Wire wire() const { return GetParam(); }
  const BagContainer& container() const { return wire() == Wire::Ros1 ? kPlainBag : kPlainMcap; }
  Recording open(const std::vector<TestTopic>& topics, const RecordingOptions& options = {},
                 const Rig* rig = nullptr) const {
    return open_recording(write_bag(folder_, container(), topics), rig, options);
  }
  /// A small bag with the intrinsics of the event camera.
  std::optional<Calibration> intrinsics_of(const std::string& camera_info) const {
    std::vector<TestTopic> topics = SmallBag(wire()).topics;
    topics.push_back({"/dvs/camera_info", "sensor_msgs/CameraInfo", {{kStart, camera_info}}});
    return open(topics).calibration;
  }
  /// sensor_msgs/CameraInfo of 346 x 260 px.
  std::string camera_info(const char* lens, const std::vector<double>& coefficients,
                          const std::vector<double>& K) const {
    WireWriter out(wire());
    out.header(kStart, "c");
    out.numbers(std::uint32_t{260}, std::uint32_t{346});
    out.text(lens);
    out.number(static_cast<std::uint32_t>(coefficients.size()));
    out.numbers(coefficients);
    out.numbers(K);
    out.numbers(std::vector<double>(9 + 12, 0.0));
    return out.message();
  }

  TempFolder folder_;
};

TEST_P(Messages, EventArraysOfThreePackagesGiveEveryEvent) {
  for (const char* package : {"dvs_msgs", "prophesee_event_msgs", "dv_ros_msgs"}) {
    // Odd and even numbers of events: in CDR the last one is not padded.
    std::vector<Event> events;
    TestTopic topic{"/any/name", std::string(package) + "/EventArray", {}};
    for (int i = 0; i < 7; ++i) {
      const EventBatch batch = bag_events(kStart + std::chrono::milliseconds(i), 1 + i, 3);
      topic.messages.emplace_back(batch.events.front().t, event_array_message(wire(), batch, kBagSensor));
      events.insert(events.end(), batch.events.begin(), batch.events.end());
    }
    const Recording r = open({topic});
    EXPECT_TRUE(read_all(*r.dataset).events == events) << package;
    EXPECT_EQ(r.dataset->info().event_sensor, kBagSensor);
  }
}

using Encode = std::function<std::string(const std::vector<Event>& events)>;

/// Continues from packet to packet.
Encode evt_encoding(EvtFormat format) {
  return [encoder = AnyEvtEncoder(format)](const std::vector<Event>& events) mutable { return encoder.encode(events); };
}

std::string encode_mono(const std::vector<Event>& events) {
  std::string bytes;
  for (const Event& e : events)
    append_number(bytes, std::uint64_t{e.positive} << 63U | std::uint64_t{e.y} << 48U | std::uint64_t{e.x} << 32U |
                             static_cast<std::uint64_t>((e.t - events.front().t).count()));
  return bytes;
}

std::string encode_libcaer(const std::vector<Event>& events) {
  std::string bytes;
  for (const Event& e : events) {
    append_number(bytes, std::uint32_t{e.x} << 17U | std::uint32_t{e.y} << 2U | std::uint32_t{e.positive} << 1U | 1U);
    append_number(bytes, static_cast<std::uint32_t>((e.t - events.front().t).count() / 1000));
  }
  return bytes;
}

std::string encode_libcaer_cmp(const std::vector<Event>& events) {
  std::string bytes;
  const auto word = [&bytes](unsigned kind, unsigned value) {
    append_number(bytes, static_cast<std::uint16_t>(kind << 12U | value));
  };
  for (const Event& e : events) {
    const auto us = static_cast<unsigned>((e.t - events.front().t).count() / 1000);
    const unsigned polarity = e.positive ? 1U << 11U : 0U;
    word(0, us >> 12U);
    word(1, us & 0xFFFU);
    word(2, e.x);
    if (e.y % 2 == 0) {
      word(3, e.y | polarity);
    } else {  // the same as the second of eight rows, or of the eight after those
      const unsigned base = e.y > 8 ? e.y - 9U : e.y - 1U;
      word(4, base | polarity);
      if (e.y > 8) word(5, 0);
      word(5, 2);
    }
  }
  return bytes;
}

TEST_P(Messages, PacketsOfEveryEncodingGiveEveryEvent) {
  const std::pair<const char*, Encode> encodings[] = {{"evt3", evt_encoding(EvtFormat::Evt3)},
                                                      {"evt21", evt_encoding(EvtFormat::Evt21)},
                                                      {"evt2", evt_encoding(EvtFormat::Evt2)},
                                                      {"mono", encode_mono},
                                                      {"libcaer", encode_libcaer},
                                                      {"libcaer_cmp", encode_libcaer_cmp}};
  for (const auto& [encoding, encode] : encodings) {
    std::vector<Event> events;
    TestTopic topic{"/event_camera/events", "event_camera_msgs/EventPacket", {}};
    for (std::uint64_t i = 0; i < 3; ++i) {
      const EventBatch batch = bag_events(kStart + i * std::chrono::milliseconds(10), 300, 5);
      const Timestamp t = batch.events.front().t;
      topic.messages.emplace_back(
          t, event_packet_message(wire(), t, i, kStartNs + i * 10'000'000, encoding, encode(batch.events)));
      events.insert(events.end(), batch.events.begin(), batch.events.end());
    }
    EXPECT_TRUE(read_all(*open({topic}).dataset).events == events) << encoding;
  }
}

TEST_P(Messages, PacketsOfUnknownEncodingsAreRefusedByTheirName) {
  TestTopic topic{"/e", "event_camera_msgs/EventPacket", {}};
  for (std::uint64_t i = 0; i < 20; ++i)
    topic.messages.emplace_back(kStart, event_packet_message(wire(), kStart, i, 0, "morse", "...---..."));
  EXPECT_THAT(input_error([&] { open({topic}); }), AllOf(HasSubstr("`morse`"), HasSubstr("--topic events=")));
}

TEST_P(Messages, ImagesOfEveryEncodingBecomeGrey) {
  struct Case {
    const char* encoding;
    int type;
    bool big_endian;
    int expected;
  };
  // Grey level 77 in each encoding, and pure red in colours, to detect a wrong order of channels.
  for (const Case& c :
       {Case{"mono8", CV_8UC1, false, 77}, Case{"8UC1", CV_8UC1, false, 77}, Case{"mono16", CV_16UC1, false, 77},
        Case{"mono16", CV_16UC1, true, 77}, Case{"bgr8", CV_8UC3, false, 29}, Case{"rgb8", CV_8UC3, false, 76},
        Case{"bgra8", CV_8UC4, false, 29}, Case{"rgba8", CV_8UC4, false, 76}, Case{"bayer_rggb8", CV_8UC1, false, 77},
        Case{"bayer_gbrg8", CV_8UC1, false, 77}}) {
    cv::Mat image(12, 16, c.type, cv::Scalar::all(77));
    if (c.type == CV_16UC1) image.setTo(c.big_endian ? 0xFE00 + 77 : (77 << 8) + 0xFE);
    if (image.channels() > 1) image.setTo(cv::Scalar(255, 0, 0, 255));
    WireWriter out(wire());
    out.header(kStart, "frames");
    out.numbers(std::uint32_t{12}, std::uint32_t{16});
    out.text(c.encoding);
    out.number(static_cast<std::uint8_t>(c.big_endian));
    const std::size_t row = 16 * image.elemSize(), step = row + 3;  // rows may be padded
    out.number(static_cast<std::uint32_t>(step));
    std::string data;
    for (int y = 0; y < 12; ++y) data += std::string(as_text({image.ptr(y), row})) + "pad";
    out.bytes(as_bytes(data));
    const Contents read = read_all(*open({{"/i", "sensor_msgs/Image", {{kStart, out.message()}}}}).dataset);
    ASSERT_EQ(read.frames.size(), 1u) << c.encoding;
    EXPECT_EQ(read.frames[0].t, kStart);
    EXPECT_EQ(read.frames[0].image.at<std::uint8_t>(5, 7), c.expected) << c.encoding;
  }
}

TEST_P(Messages, CompressedImagesAreDecodedAndLeftOutBesideTheirOriginals) {
  const cv::Mat image(12, 16, CV_8UC1, cv::Scalar(99));
  WireWriter out(wire());
  out.header(kStart, "frames");
  out.text("mono8; png compressed");
  out.bytes(encode_png(image));
  const TestTopic compressed{"/i/compressed", "sensor_msgs/CompressedImage", {{kStart, out.message()}}};
  const Contents c = read_all(*open({compressed}).dataset);
  ASSERT_EQ(c.frames.size(), 1u);
  EXPECT_EQ(c.frames[0].image.at<std::uint8_t>(0, 0), 99);
  const TestTopic original{"/i", "sensor_msgs/Image", {{kStart, image_message(wire(), {kStart, "frames", image + 1})}}};
  EXPECT_EQ(read_all(*open({compressed, original}).dataset).frames.at(0).image.at<std::uint8_t>(0, 0), 100);
}

/// header [, child] , pose [, 36 numbers, twist, 36 numbers].
std::string pose_message(Wire wire, const std::string& type, int i) {
  WireWriter out(wire);
  out.header(kStart + std::chrono::milliseconds(i), "map");
  if (type != "geometry_msgs/PoseStamped") out.text("odd");
  out.numbers(std::array{1.0 + i, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8});
  if (type == "nav_msgs/Odometry") out.numbers(std::vector<double>(36 + 6 + 36, 5.0));
  return out.message();
}

TEST_P(Messages, ThreeKindsOfPosesAreGroundTruth) {
  for (const char* type : {"geometry_msgs/PoseStamped", "geometry_msgs/TransformStamped", "nav_msgs/Odometry"}) {
    TestTopic poses{"/vicon", type, {}}, imu{"/imu", "sensor_msgs/Imu", {}};
    for (int i = 0; i < 5; ++i) {
      poses.messages.emplace_back(kStart, pose_message(wire(), type, i));
      imu.messages.emplace_back(kStart, imu_message(wire(), still(kStart + std::chrono::milliseconds(i))));
    }
    const auto truth = open({poses, imu}).dataset->ground_truth();
    ASSERT_TRUE(truth) << type;
    ASSERT_EQ(truth->trajectory.size(), 5u);
    EXPECT_EQ(truth->frame, "body");
    EXPECT_EQ(truth->trajectory[2].t, kStart + std::chrono::milliseconds(2));
    EXPECT_EQ(truth->trajectory[2].T.translation(), Eigen::Vector3d(3, 2, 3));
    EXPECT_NEAR(truth->trajectory[2].T.rotation().y(), 0.6, 1e-15);
  }
}

TEST_P(Messages, SeveralTopicsForTheOnlyCameraOfTheRigAreAskedForWithTheList) {
  const Rig rig = load_rig("davis240c_ecd").rig;
  const EventBatch left = bag_events(kStart, 10, 1), right = bag_events(kStart, 20, 2);
  const std::vector<TestTopic> topics = {
      {"/left/events", "dvs_msgs/EventArray", {{kStart, event_array_message(wire(), left, kBagSensor)}}},
      {"/right/events", "dvs_msgs/EventArray", {{kStart, event_array_message(wire(), right, kBagSensor)}}},
      {"/imu", "sensor_msgs/Imu", {{kStart, imu_message(wire(), still(kStart))}}},
      {"/chatter", "std_msgs/String", {{kStart, "hello"}}}};
  EXPECT_THAT(input_error([&] { open(topics, {}, &rig); }),
              AllOf(HasSubstr("--topic ROLE=NAME"), HasSubstr("events: /left/events, /right/events")));
  EXPECT_EQ(read_all(*open(topics, {.topics = {{"events", "/right/events"}}}).dataset).events.size(), 20u);
  EXPECT_FALSE(open(topics, {.topics = {{"events", "none"}}}).dataset->info().has_events);
  EXPECT_THAT(input_error([&] { open(topics, {.topics = {{"events", "/up"}}}); }), HasSubstr("no topic /up"));
  EXPECT_THAT(input_error([&] { open({topics[3]}); }), HasSubstr("/chatter (std_msgs/String)"));
}

TEST_P(Messages, AGyroAndAnAccelerometerOnTopicsOfTheirOwnAreMerged) {
  TestTopic gyro{"/gyro/sample", "sensor_msgs/Imu", {}}, accel{"/accel/sample", "sensor_msgs/Imu", {}};
  TestTopic both{"/imu", "sensor_msgs/Imu", {}};
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  for (int i = 0; i < 30; ++i) {
    const Timestamp t = kStart + std::chrono::milliseconds(5 * i), later = t + std::chrono::milliseconds(2);
    gyro.messages.emplace_back(t, imu_message(wire(), {t, {0.1 * i, 0, 1}, none}));
    accel.messages.emplace_back(later, imu_message(wire(), {later, none, {5.0 * i + 2, 0, 9.81}}));
    both.messages.emplace_back(t, imu_message(wire(), {t, {0.1 * i, 0, 1}, {1, 0, 9.81}}));
  }
  const Recording merged = open({accel, gyro});
  const std::vector<ImuSample> imu = read_all(*merged.dataset).imu;
  ASSERT_EQ(imu.size(), 29u) << "the first has no accelerometer before it";
  EXPECT_EQ(imu[3].t, kStart + std::chrono::milliseconds(20));
  EXPECT_NEAR(imu[3].gyro_B.x(), 0.4, 1e-12);
  EXPECT_NEAR(imu[3].accel_B.x(), 20.0, 1e-9);
  EXPECT_EQ(merged.dataset->info().streams[0].role, "imu");
  EXPECT_EQ(merged.dataset->info().streams[1].role, "imu");
  EXPECT_EQ(read_all(*open({accel, both, gyro}).dataset).imu.size(), 30u) << "the only one that has both";
  TestTopic other = both;
  other.name = "/other";
  EXPECT_THAT(input_error([&] { open({both, other}); }), HasSubstr("imu: /imu, /other"));
}

TEST_P(Messages, CameraInfoGivesTheIntrinsicsOfTheCameraBesideIt) {
  const CameraModel model(346, 260, 250.5, 251.5, 170, 130, DistortionModel::RadTan, {-0.3, 0.1, 1e-3, 2e-3, 0});
  const CameraModel other(30, 20, 40, 41, 15, 10, DistortionModel::Equidistant, {0.01, 0.02, 0.03, 0.04});
  std::vector<TestTopic> topics = SmallBag(wire()).topics;
  const auto info = [&](const char* topic, const CameraModel& m) {
    return TestTopic{topic, "sensor_msgs/CameraInfo", {{kStart, camera_info_message(wire(), kStart, "c", m)}}};
  };
  topics.push_back(info("/dvs/camera_info", model));
  topics.push_back(info("/elsewhere/camera_info", other));
  const auto calibration = open(topics).calibration;
  ASSERT_TRUE(calibration);
  ASSERT_EQ(calibration->rig.cameras.size(), 1u);
  EXPECT_EQ(calibration->rig.camera("events").model, model);
  EXPECT_FALSE(calibration->has_extrinsics || calibration->has_imu_noise);
  topics.push_back(info("/camera/camera_info", other));
  EXPECT_EQ(open(topics).calibration->rig.camera("frames").model, other);
  EXPECT_EQ(open(topics).calibration->rig.camera("events").model, model);
}

TEST_P(Messages, CameraInfoHoldsEveryLens) {
  for (const CameraModel& model :
       {CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::Rational, {0.2, 0, 1e-3, 2e-3, 0, 0.4, 0.01, 0}),
        CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::FieldOfView, {0.9}),
        CameraModel(346, 260, 400, 401, 170, 130, DistortionModel::Omni, {1.1, 0.1, 0.2, 1e-3, 2e-3}),
        CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::DoubleSphere, {-0.2, 0.6}),
        CameraModel(346, 260, 250, 251, 170, 130, DistortionModel::ExtendedUnified, {0.6, 1.1})}) {
    const auto calibration = intrinsics_of(camera_info_message(wire(), kStart, "c", model));
    ASSERT_TRUE(calibration) << to_string(model.distortion());
    EXPECT_EQ(calibration->rig.camera("events").model, model) << to_string(model.distortion());
  }
}

TEST_P(Messages, IntrinsicsMayBePaddedWithZeros) {
  for (const double s1 : {0.0, 0.1}) {
    std::vector<double> k(14, 0.0);
    k[0] = -0.1, k[8] = s1;
    const auto calibration = intrinsics_of(camera_info("rational_polynomial", k, {200, 0, 170, 0, 200, 130, 0, 0, 1}));
    EXPECT_EQ(calibration.has_value(), s1 == 0.0);
  }
}

TEST_P(Messages, IntrinsicsThatAreNotOursOrNotSetAreLeftOut) {
  EXPECT_FALSE(intrinsics_of(camera_info("plumb_bob", {}, std::vector<double>(9, 0.0))));
}

INSTANTIATE_TEST_SUITE_P(Wires, Messages, ::testing::Values(Wire::Ros1, Wire::Cdr),
                         [](const auto& test) { return test.param == Wire::Ros1 ? "ros1" : "cdr"; });

TEST(Message, EventsOfTheFirstDvsMessagesAreRefusedByTheirDefinition) {
  TempFolder folder;
  const TestTopic old{"/dvs/events",
                      "dvs_msgs/EventArray",
                      {{kStart, "old"}},
                      {"Event[] events\n====\nMSG: dvs_msgs/Event\nuint64 time\nuint16 x\n", "x"}};
  EXPECT_THAT(input_error([&] { open_recording(write_bag(folder, kPlainBag, {old})); }),
              AllOf(HasSubstr("of 2015"), HasSubstr("text version")));
}

TEST(Message, SomeDamagedOnesAreCountedAndPassedOver) {
  TempFolder folder;
  SmallBag bag(Wire::Ros1);
  bag.topics[0].messages[3].second.resize(50);
  bag.topics[2].messages[5].second.clear();
  const Recording r = open_recording(write_bag(folder, kPlainBag, bag.topics));
  const Contents c = read_all(*r.dataset);
  EXPECT_EQ(c.events.size(), bag.events.size() - 50);
  EXPECT_EQ(c.imu.size(), 39u);
  EXPECT_EQ(r.dataset->repairs(),
            (std::map<std::string, std::size_t>{{"events: message unreadable", 1}, {"imu: message unreadable", 1}}));
}

}  // namespace
}  // namespace edged
