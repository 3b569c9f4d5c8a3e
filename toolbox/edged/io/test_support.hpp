// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Folders for the tests of io.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/test_data.hpp"
#include "edged/dataset.hpp"
#include "edged/io/parse/image_codec.hpp"

namespace edged {

/// A new temporary folder, which the destructor removes.
class TempFolder {
 public:
  TempFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("edged_") + test->test_suite_name() + "_" + test->name() + "_" + std::to_string(::getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

  void write_image(const std::string& name, int width = 240, int height = 180, int gray = 100) const {
    write_image(name, cv::Mat(height, width, CV_8UC1, cv::Scalar(gray)));
  }

  void write_image(const std::string& name, const cv::Mat& image) const {
    write(name, std::string(as_text(encode_png(image))));
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A data set with given measurements.
class ListedDataset : public Dataset {
 public:
  const DatasetInfo& info() const override { return info_; }
  std::optional<Measurement> next() override {
    if (next_ == measurements.size() && failing) throw InputError("damaged at its end");
    if (next_ == measurements.size()) return std::nullopt;
    return measurements[next_++];
  }
  std::optional<GroundTruth> ground_truth() const override { return truth; }

  std::vector<Measurement> measurements;
  std::optional<GroundTruth> truth;
  bool failing = false;  ///< throws at its end
  DatasetInfo& describe() { return info_; }

 private:
  DatasetInfo info_{"listed", "listed", "body", {}, {}, true, true, true, {}, {}, cv::Size(240, 180)};
  std::size_t next_ = 0;
};

inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// 200 ms with events of one camera, frames and IMU, at Unix time. Events are stamped at whole ticks.
inline ListedDataset random_dataset(Duration tick = Duration(1)) {
  ListedDataset d;
  std::mt19937_64 random(7);
  Timestamp t = timestamp_from_ns(1'468'939'993'067'416'019);
  for (int i = 0; i < 200; ++i) {
    t += std::chrono::milliseconds(1);
    const Eigen::Vector3d gyro(uniform(random), -uniform(random), 1e-9 * uniform(random));
    d.measurements.push_back(ImuSample{t, gyro, gyro * 9.81});
    EventBatch batch{"left", {}};
    for (Timestamp e = t; e < t + std::chrono::microseconds(900); e += Duration(1 + random() % 20'000))
      batch.events.push_back({e, static_cast<std::uint16_t>(random() % 240), static_cast<std::uint16_t>(random() % 180),
                              random() % 2 == 1});
    for (Event& event : batch.events) event.t -= event.t.time_since_epoch() % tick;
    d.measurements.push_back(std::move(batch));
    if (i % 40 != 0) continue;
    cv::Mat image(180, 240, CV_8UC1);
    for (auto& pixel : cv::Mat_<std::uint8_t>(image)) pixel = static_cast<std::uint8_t>(random());
    d.measurements.push_back(Frame{t + std::chrono::microseconds(950), "left", image});
  }
  d.truth = GroundTruth{{{t, SE3(Eigen::Quaterniond(0.8, 0, 0, 0.6), {1, 2, 3})}}, "body"};
  return d;
}

/// All measurements of a data set, by kind.
struct Contents {
  std::vector<Measurement> all;
  std::vector<Event> events;
  std::vector<Frame> frames;
  std::vector<ImuSample> imu;
};

inline Contents read_all(Dataset& dataset) {
  Contents c;
  while (auto m = dataset.next()) {
    if (const auto* b = std::get_if<EventBatch>(&*m))
      c.events.insert(c.events.end(), b->events.begin(), b->events.end());
    if (const auto* f = std::get_if<Frame>(&*m)) c.frames.push_back(*f);
    if (const auto* s = std::get_if<ImuSample>(&*m)) c.imu.push_back(*s);
    c.all.push_back(std::move(*m));
  }
  return c;
}

inline bool operator==(const Event& a, const Event& b) {
  return a.t == b.t && a.x == b.x && a.y == b.y && a.positive == b.positive;
}

/// The message of the InputError that `action` throws, or "" for none.
template <typename Action>
std::string input_error(Action&& action) {
  try {
    action();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace edged
