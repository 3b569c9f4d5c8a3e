// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes folders of the Event-Camera Dataset; of further cameras events2.txt, images2.txt and so on.
#include "edged/io/text/dataset_formats.hpp"

#include <spdlog/fmt/compile.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/parse/trajectory_io.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kFlushBytes = 1 << 20;

/// A text file that is created when its first line is written.
class LazyFile {
 public:
  explicit LazyFile(fs::path file) : file_(std::move(file)) {}

  template <typename Format, typename... Args>
  void add(const Format& format, const Args&... args) {
    fmt::format_to(std::back_inserter(text_), format, args...);
    if (text_.size() >= kFlushBytes) flush();
  }

  void flush() {
    if (text_.size() == 0) return;
    if (!out_.is_open()) out_.open(file_, std::ios::binary);
    out_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
    out_.flush();
    if (!out_) throw InputError::format("{}: cannot be written: is the disk full?", file_.string());
    text_.clear();
  }

 private:
  fs::path file_;
  std::ofstream out_;
  fmt::memory_buffer text_;
};

/// The place in a rig, named as it is read, of the camera that readers take for that of events.txt.
std::size_t event_camera_place(const std::vector<RigCamera>& named) {
  auto events = std::ranges::find(named, usual_camera_name(Modality::Events, 0), &RigCamera::name);
  if (events == named.end()) events = std::ranges::find(named, Modality::Events, &RigCamera::modality);
  return events == named.end() ? 0 : static_cast<std::size_t>(events - named.begin());
}

void write_calibration(const WriterSetup& setup, const fs::path& folder) {
  const Calibration named = setup.calibration_when_read();
  const CameraModel& m = named.rig.cameras[event_camera_place(named.rig.cameras)].model;
  if (m.distortion() == DistortionModel::None || m.distortion() == DistortionModel::RadTan) {
    const auto& k = m.coefficients();
    LazyFile file(folder / "calib.txt");
    file.add(FMT_COMPILE("{} {} {} {} {} {} {} {} {}\n"), m.fx(), m.fy(), m.cx(), m.cy(), k[0], k[1], k[2], k[3], k[4]);
    file.flush();
  }
  if (!named.has_extrinsics) return;
  LazyFile file(folder / "calibration.yaml");
  file.add(FMT_COMPILE("{}"), to_yaml(named));
  file.flush();
}

/// Finds a camera by its name in the rig, or by the name that readers of formats without names use.
const RigCamera& camera_of_frame(const WriterSetup& setup, const std::string& name) {
  const Rig& rig = setup.calibration->rig;
  const std::vector<RigCamera> renamed = setup.calibration_when_read().rig.cameras;
  const auto known = std::ranges::find(rig.cameras, name, &RigCamera::name);
  const auto usual = std::ranges::find(renamed, name, &RigCamera::name);
  if (known != rig.cameras.end() || usual == renamed.end()) return rig.camera(name);
  return rig.cameras[static_cast<std::size_t>(usual - renamed.begin())];
}

/// T_W_C of the event camera (without one: of the first camera) on its clock.
Trajectory camera_ground_truth(const GroundTruth& truth, const WriterSetup& setup) {
  const std::optional<Calibration>& calibration = setup.calibration;
  if (!calibration || !calibration->has_extrinsics) {
    if (truth.frame == "body" || (setup.info.has_events && truth.frame == "frames"))
      throw InputError::format(
          "groundtruth.txt holds the pose of the event camera, the ground truth is of {}: a calibration with "
          "extrinsics is needed to write it: give --rig or --calib",
          truth.frame == "body" ? "the body" : "the frame camera");
    return truth.trajectory;
  }
  const std::size_t place = event_camera_place(setup.calibration_when_read().rig.cameras);
  const RigCamera& to = calibration->rig.cameras[place];
  if (truth.frame == to.name) return truth.trajectory;
  const RigCamera body;  // identity and no offset
  const RigCamera& from = truth.frame == "body" ? body : camera_of_frame(setup, truth.frame);
  const SE3 T_X_C = from.T_B_C.inverse() * to.T_B_C;
  Trajectory out = truth.trajectory;
  for (StampedPose& pose : out) pose = {pose.t + from.time_offset - to.time_offset, pose.T * T_X_C};
  return out;
}

class EcdWriter final : public RecordingWriter {
 public:
  explicit EcdWriter(const WriterSetup& setup) : setup_(setup), folder_(setup.path), imu_(folder_ / "imu.txt") {
    for (std::size_t i = 0; i < setup.cameras(Modality::Events); ++i)
      events_.emplace_back(folder_ / ("events" + ecd_number(i) + ".txt"));
    for (std::size_t i = 0; i < setup.cameras(Modality::Frames); ++i)
      images_.push_back({LazyFile(folder_ / ("images" + ecd_number(i) + ".txt"))});
    std::error_code error;
    fs::create_directories(folder_, error);
    if (error) throw InputError::format("{}: cannot be made: {}", folder_.string(), error.message());
    if (is_ecd_folder(folder_))
      throw InputError::format("{}: holds a recording already: give another folder", folder_.string());
    if (setup_.calibration) write_calibration(setup_, folder_);
  }

  void write(const EventBatch& batch) override {
    LazyFile& events = events_[setup_.place_of(batch.camera, Modality::Events)];
    for (const Event& e : batch.events) {
      const std::int64_t ns = to_ns(e.t);
      if (ns < 0) {
        events.add(FMT_COMPILE("{} {} {} {:d}\n"), format_seconds(e.t), e.x, e.y, e.positive);
      } else {
        events.add(FMT_COMPILE("{}.{:09} {} {} {:d}\n"), ns / 1'000'000'000, ns % 1'000'000'000, e.x, e.y, e.positive);
      }
    }
  }

  void write(const Frame& frame) override {
    const std::size_t camera = setup_.place_of(frame.camera, Modality::Frames);
    auto& [list, count] = images_[camera];
    const std::string images = "images" + ecd_number(camera);
    if (count == 0) fs::create_directories(folder_ / images);
    const std::string name = fmt::format("{}/frame_{:08}.png", images, count++);
    const fs::path file = folder_ / name;
    const Bytes png = encode_png(frame.image);
    if (!(std::ofstream(file, std::ios::binary) << as_text(png)).flush())
      throw InputError::format("{}: cannot be written: is the disk full?", file.string());
    list.add(FMT_COMPILE("{} {}\n"), format_seconds(frame.t), name);
  }

  void write(const ImuSample& s) override {
    static const TextTable table = accel_first(TimeUnit::Seconds);
    const std::array numbers = {s.gyro_B.x(), s.gyro_B.y(), s.gyro_B.z(), s.accel_B.x(), s.accel_B.y(), s.accel_B.z()};
    imu_.add(FMT_COMPILE("{}\n"), format_row(table, s.t, numbers, ' '));
  }

  void write(const ExternalSample& sample) override {
    const ExternalSensor& sensor = sensor_of(sample);
    const std::string name(sensor.name);
    auto file = external_.find(name);
    if (file == external_.end()) {
      file = external_.try_emplace(name, folder_ / (name + ".txt")).first;
      file->second.add(FMT_COMPILE("# {}; s, {}\n"), layout_of(sensor), sensor.unit);
    }
    const ExternalNumbers numbers = sensor.numbers(sample);
    file->second.add(FMT_COMPILE("{} {} {}\n"), format_seconds(time_of(sample)), fmt::join(numbers.values, " "),
                     fmt::join(numbers.sigmas, " "));
  }

  void write(const GroundTruth& truth) override {
    LazyFile out(folder_ / "groundtruth.txt");
    const TextTable table = tum_table(TimeUnit::Seconds);
    for (const StampedPose& pose : camera_ground_truth(truth, setup_))
      out.add(FMT_COMPILE("{}\n"), pose_row(table, pose, ' '));
    out.flush();
  }

  void finish() override {
    for (LazyFile& file : events_) file.flush();
    for (auto& [list, count] : images_) list.flush();
    imu_.flush();
    for (auto& [name, file] : external_) file.flush();
  }

 private:
  struct Images {
    LazyFile list;
    std::size_t count = 0;
  };

  WriterSetup setup_;
  fs::path folder_;
  std::vector<LazyFile> events_;
  std::vector<Images> images_;
  LazyFile imu_;
  std::map<std::string, LazyFile> external_;
};

}  // namespace

std::unique_ptr<RecordingWriter> write_ecd(const WriterSetup& setup) { return std::make_unique<EcdWriter>(setup); }

}  // namespace edged
