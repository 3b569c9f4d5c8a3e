// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT 2.0 of a DAVIS: records of two big-endian words, an address that encodes the kind of the record, and
// microseconds.
#include <spdlog/fmt/fmt.h>

#include <array>
#include <utility>
#include <vector>

#include "edged/core/angles.hpp"
#include "edged/io/aedat/aedat_old.hpp"
#include "edged/io/core/streamed_dataset.hpp"

namespace edged {
namespace {

constexpr std::size_t kRecordBytes = 8;
constexpr std::size_t kRecordsAtOnce = 8192;
constexpr std::size_t kImuWords = 7;  // accelerometer x y z, temperature, gyro x y z

struct Record {
  std::uint32_t address, time_us;

  bool of_dvs() const { return address >> 31U == 0; }
  bool external() const { return (address >> 10U & 1U) != 0; }  ///< true for the trigger input, in a DVS record
  /// Kind of the other records: 0 reset level of a pixel, 1 its signal level, 3 the IMU.
  unsigned kind() const { return address >> 10U & 3U; }
  unsigned x() const { return address >> 12U & 0x3FFU; }
  unsigned y() const { return address >> 22U & 0x1FFU; }
  int level() const { return static_cast<int>(address & 0x3FFU); }
  bool on() const { return (address >> 11U & 1U) != 0; }
  std::size_t imu_word() const { return address >> 28U & 7U; }
  std::int16_t imu_value() const { return static_cast<std::int16_t>(address >> 12U & 0xFFFFU); }
};

std::vector<Record> records_in(ByteSpan bytes) {
  std::vector<Record> records;
  ByteReader reader(bytes);
  while (reader.left() >= kRecordBytes) {
    const auto word = [&reader] {
      const auto w = reader.number<std::uint32_t>();
      return w << 24U | (w & 0xFF00U) << 8U | (w >> 8U & 0xFF00U) | w >> 24U;
    };
    const std::uint32_t address = word();
    records.push_back({address, word()});
  }
  return records;
}

/// Assembles a frame from its pixels. The brightness is the reset level minus the signal level, of 10 bits. The stamp
/// of the frame is the middle of the exposures of its pixels.
class ApsFrame {
 public:
  explicit ApsFrame(cv::Size size) : size_(size) { clear(); }

  /// Returns the frame if this level completes it. x and y are within the size.
  std::optional<std::pair<Timestamp, cv::Mat>> add(const Record& record, int x, int y, Timestamp t) {
    const auto pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) + static_cast<std::size_t>(x);
    const unsigned kind = record.kind();
    if (kind == 0 && reset_[pixel] >= 0) clear();  // the previous frame was not complete
    if (kind == 0) {
      reset_[pixel] = record.level();
    } else if (reset_[pixel] >= 0 && !seen_[pixel]) {
      const int level = (reset_[pixel] - record.level()) >> 2U;
      image_.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::clamp(level, 0, 255));
      seen_[pixel] = true;
      ++signals_;
    } else {
      return std::nullopt;
    }
    if (!first_) first_ = t;
    sum_ns_[kind] += static_cast<double>((t - *first_).count());
    if (signals_ < seen_.size()) return std::nullopt;
    const double mean_ns = (sum_ns_[0] + sum_ns_[1]) / (2.0 * static_cast<double>(signals_));
    std::pair done(*first_ + Duration(static_cast<std::int64_t>(mean_ns)), image_.clone());
    clear();
    return done;
  }

 private:
  void clear() {
    const auto pixels = static_cast<std::size_t>(size_.area());
    reset_.assign(pixels, -1);
    seen_.assign(pixels, false);
    image_ = cv::Mat::zeros(size_, CV_8UC1);
    signals_ = 0;
    sum_ns_ = {};
    first_.reset();
  }

  cv::Size size_;
  std::vector<int> reset_;  ///< -1: not received yet
  std::vector<bool> seen_;
  cv::Mat image_;
  std::size_t signals_ = 0;
  std::array<double, 2> sum_ns_{};  ///< sums of the stamps of reset and signal levels, relative to the first stamp
  std::optional<Timestamp> first_;
};

class Aedat2File final : public StreamedDataset {
 public:
  Aedat2File(const std::filesystem::path& file, const OldAedatHeader& header, cv::Size sensor)
      : StreamedDataset(file, "aedat2"), file_(file), header_(header), at_(header.bytes), frame_(sensor) {
    set_sensor(sensor);
    begin(streams_there());
    find_end();
  }

 private:
  /// Determined from the first records.
  OneOfEach streams_there() {
    constexpr std::size_t kFirstRecords = std::size_t{1} << 18U;
    OneOfEach streams;
    for (const Record& record : records_in(file_.read(header_.bytes, kFirstRecords * kRecordBytes))) {
      streams.events = streams.events || record.of_dvs();
      streams.frames = streams.frames || (!record.of_dvs() && record.kind() < 2);
      streams.imu = streams.imu || (!record.of_dvs() && record.kind() == 3);
    }
    return streams;
  }

  void find_end() {
    const std::uint64_t count = (file_.size() - header_.bytes) / kRecordBytes;
    const auto first = records_in(file_.read(header_.bytes, kRecordBytes));
    const auto last = records_in(file_.read(header_.bytes + (count - 1) * kRecordBytes, kRecordBytes));
    if (count * kRecordBytes != file_.size() - header_.bytes)
      repairs_.add("file: cut", name_ + ": the file ends within a record");
    if (first.empty() || last.empty()) return;
    const auto lasts_us = static_cast<std::int32_t>(last[0].time_us - first[0].time_us);
    if (lasts_us > 0)
      info_.end = timestamp_from_ns((std::int64_t{static_cast<std::int32_t>(first[0].time_us)} + lasts_us) * 1000);
  }

  bool read_on() override {
    const std::vector<Record> records = records_in(file_.read(at_, kRecordsAtOnce * kRecordBytes));
    at_ += records.size() * kRecordBytes;
    std::vector<Event> events;
    for (const Record& record : records) take(record, events);
    push_events(events);
    return !records.empty();
  }

  /// The counter of 32 bits, continued over wraps.
  Timestamp stamp_of(std::uint32_t time_us) {
    if (!last_us_) elapsed_us_ = static_cast<std::int32_t>(time_us);
    if (last_us_) elapsed_us_ += static_cast<std::int32_t>(time_us - *last_us_);
    last_us_ = time_us;
    return timestamp_from_ns(elapsed_us_ * 1000);
  }

  /// The sensor is read out from the lower right corner of the image.
  void take(const Record& record, std::vector<Event>& events) {
    const cv::Size size = info_.event_sensor;
    const Timestamp t = stamp_of(record.time_us);
    const int x = size.width - 1 - static_cast<int>(record.x()), y = size.height - 1 - static_cast<int>(record.y());
    if (record.of_dvs()) {
      // Negative coordinates become large, which lies outside any sensor.
      if (!record.external())
        events.push_back({t, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), record.on()});
    } else if (record.kind() == 3) {
      take_imu(record, t);
    } else if (record.kind() < 2 && wants(Modality::Frames)) {
      if (x < 0 || y < 0) return repairs_.add("frames: pixel outside the sensor", name_ + ": a pixel of a frame");
      if (auto done = frame_.add(record, x, y, t)) push_frame(done->first, std::move(done->second));
    }
  }

  /// Seven consecutive records make a sample.
  void take_imu(const Record& record, Timestamp t) {
    if (record.imu_word() != imu_.size() || (!imu_.empty() && t != imu_t_)) {
      if (!imu_.empty() || record.imu_word() != 0)
        repairs_.add("imu: sample incomplete", fmt::format("{}: words of an IMU sample are missing", name_));
      imu_.clear();
      if (record.imu_word() != 0) return;
    }
    imu_t_ = t;
    imu_.push_back(record.imu_value());
    if (imu_.size() < kImuWords) return;
    const double g = kStandardGravity / header_.accel_lsb_per_g, turn = kDegree / header_.gyro_lsb_per_dps;
    push_imu({t, turn * Eigen::Vector3d(imu_[4], imu_[5], imu_[6]), g * Eigen::Vector3d(imu_[0], imu_[1], imu_[2])});
    imu_.clear();
  }

  BinaryFile file_;
  OldAedatHeader header_;
  std::uint64_t at_;
  ApsFrame frame_;
  std::vector<std::int16_t> imu_;
  Timestamp imu_t_{};
  std::optional<std::uint32_t> last_us_;
  std::int64_t elapsed_us_ = 0;
};

}  // namespace

Recording open_aedat2(const std::filesystem::path& file, const OldAedatHeader& header, cv::Size sensor) {
  return {std::make_unique<Aedat2File>(file, header, sensor), std::nullopt};
}

}  // namespace edged
