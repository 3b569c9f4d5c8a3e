// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes data sets that grow by whole chunks.
#include "edged/io/hdf5/hdf5_writer.hpp"

#include <memory>
#include <span>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/hdf5/h5.hpp"
#include "edged/io/hdf5/h5_filters.hpp"
#include "edged/io/hdf5/layouts.hpp"

namespace edged {
namespace {

/// Errors of the library here are errors of the disk.
void check_written(bool good, const std::string& file) {
  if (!good) throw InputError::format("{}: cannot be written: is the disk full?", file);
}

/// A new data set (rows, row_shape...) of numbers, filled row by row.
template <typename T>
class GrowingArray {
 public:
  GrowingArray(hid_t file, std::string file_name, const std::string& path, std::vector<hsize_t> row_shape,
               hsize_t chunk_rows)
      : file_name_(std::move(file_name)), shape_(std::move(row_shape)), chunk_rows_(chunk_rows) {
    for (const hsize_t side : shape_) columns_ *= side;
    shape_.insert(shape_.begin(), 0);
    std::vector<hsize_t> most = shape_, chunk = shape_;
    most.front() = H5S_UNLIMITED;
    chunk.front() = chunk_rows;
    const H5Handle space(H5Screate_simple(static_cast<int>(shape_.size()), shape_.data(), most.data()), H5Sclose);
    const H5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose), links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    const auto parameters = blosc_parameters(sizeof(T), chunk_rows * columns_ * sizeof(T));
    H5Pset_create_intermediate_group(links.get(), 1);
    H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_filter(creation.get(), static_cast<H5Z_filter_t>(H5Filter::Blosc), H5Z_FLAG_MANDATORY, parameters.size(),
                  parameters.data());
    data_ = H5Handle(
        H5Dcreate2(file, path.c_str(), h5_native_type<T>(), space.get(), links.get(), creation.get(), H5P_DEFAULT),
        H5Dclose);
    check_written(bool(data_), file_name_);
  }

  void add(T value) {
    rest_.push_back(value);
    write_when_full();
  }

  template <typename Values>
  void add_all(const Values& values) {
    rest_.insert(rest_.end(), std::begin(values), std::end(values));
    write_when_full();
  }

  void flush() {
    const hsize_t rows = rest_.size() / columns_;
    if (rows == 0) return;
    std::vector<hsize_t> start(shape_.size(), 0), extent = shape_;
    start.front() = shape_.front();
    extent.front() = rows;
    shape_.front() += rows;
    check_written(H5Dset_extent(data_.get(), shape_.data()) >= 0, file_name_);
    const H5Handle space(H5Dget_space(data_.get()), H5Sclose);
    const H5Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
    check_written(H5Dwrite(data_.get(), h5_native_type<T>(), memory.get(), space.get(), H5P_DEFAULT, rest_.data()) >= 0,
                  file_name_);
    rest_.clear();
  }

  hid_t id() const { return data_.get(); }

 private:
  void write_when_full() {
    if (rest_.size() >= chunk_rows_ * columns_) flush();
  }

  std::string file_name_;
  std::vector<hsize_t> shape_;
  hsize_t chunk_rows_;
  std::size_t columns_ = 1;
  std::vector<T> rest_;  ///< not yet written
  H5Handle data_;
};

void put_attribute(hid_t object, const char* name, std::int64_t value) {
  const H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const H5Handle attribute(H5Acreate2(object, name, H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute.get(), H5T_NATIVE_INT64, &value);
}

void put_attribute(hid_t object, const char* name, const std::string& text) {
  const H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Tset_size(type.get(), text.size() + 1);
  const H5Handle attribute(H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute.get(), type.get(), text.c_str());
}

H5Handle create_file(const std::filesystem::path& path) {
  prepare_h5();
  H5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  if (!file)
    throw InputError::format("{}: cannot be written: is there such a folder, and may you write there?", path.string());
  return file;
}

constexpr hsize_t kEventRows = 65536, kSampleRows = 1024;

struct EventArrays {
  /// index: the place of the table by milliseconds.
  EventArrays(hid_t file, const std::string& name, const std::string& group, const std::string& index)
      : x(file, name, group + "/x", {}, kEventRows),
        y(file, name, group + "/y", {}, kEventRows),
        p(file, name, group + "/p", {}, kEventRows),
        t(file, name, group + "/t", {}, kEventRows),
        ms_to_idx(file, name, index, {}, kEventRows) {}
  void flush() { x.flush(), y.flush(), p.flush(), t.flush(), ms_to_idx.flush(); }
  GrowingArray<std::uint16_t> x, y;
  GrowingArray<std::uint8_t> p;
  GrowingArray<std::int64_t> t;
  GrowingArray<std::uint64_t> ms_to_idx;
  std::uint64_t count = 0;
  std::int64_t next_ms = 0;  ///< first millisecond without an index
};

struct ImuArrays {
  ImuArrays(hid_t file, const std::string& name)
      : gyro(file, name, "/imu/gyro", {3}, kSampleRows),
        accel(file, name, "/imu/accel", {3}, kSampleRows),
        stamps(file, name, "/imu/t_ns", {}, kSampleRows) {}
  void flush() { gyro.flush(), accel.flush(), stamps.flush(); }
  GrowingArray<double> gyro, accel;
  GrowingArray<std::int64_t> stamps;
};

struct FrameArrays {
  FrameArrays(hid_t file, const std::string& name, const std::string& group, cv::Size frame_size)
      : size(frame_size),
        images(file, name, group + "/images",
               {static_cast<hsize_t>(frame_size.height), static_cast<hsize_t>(frame_size.width)}, 1),
        stamps(file, name, group + "/t_ns", {}, kSampleRows) {}
  void flush() { images.flush(), stamps.flush(); }
  cv::Size size;
  GrowingArray<std::uint8_t> images;
  GrowingArray<std::int64_t> stamps;
};

class Hdf5Writer final : public RecordingWriter {
 public:
  explicit Hdf5Writer(const WriterSetup& setup)
      : setup_(setup),
        name_(setup.path.string()),
        file_(create_file(setup.path)),
        frames_(setup.cameras(Modality::Frames)) {
    for (std::size_t i = 0; i < setup.cameras(Modality::Events); ++i) {
      const std::string group = path_of_camera("/events", i);
      events_.push_back(
          std::make_unique<EventArrays>(file_.get(), name_, group, i == 0 ? "/ms_to_idx" : group + "/ms_to_idx"));
      const cv::Size sensor = setup.event_sensor(i);
      const H5Handle events(H5Gopen2(file_.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
      put_attribute(events.get(), "width", sensor.width);
      put_attribute(events.get(), "height", sensor.height);
    }
  }

  void write(const EventBatch& batch) override {
    EventArrays& events = *events_[setup_.place_of(batch.camera, Modality::Events)];
    for (const Event& event : batch.events) {
      const std::int64_t us = to_ns(event.t) / 1000;
      if (!offset_us_) offset_us_ = us;
      index(events, us - *offset_us_);
      events.x.add(event.x);
      events.y.add(event.y);
      events.p.add(event.positive ? 1 : 0);
      events.t.add(us - *offset_us_);
      ++events.count;
    }
  }

  void write(const Frame& frame) override {
    const std::size_t camera = setup_.place_of(frame.camera, Modality::Frames);
    auto& frames = frames_[camera];
    if (!frames)
      frames = std::make_unique<FrameArrays>(file_.get(), name_, path_of_camera("/frames", camera), frame.image.size());
    EDGED_CHECK(frame.image.size() == frames->size && frame.image.type() == CV_8UC1, "frames of one size and type");
    for (int row = 0; row < frame.image.rows; ++row)
      frames->images.add_all(std::span(frame.image.ptr(row), static_cast<std::size_t>(frame.image.cols)));
    frames->stamps.add(to_ns(frame.t));
  }

  void write(const ImuSample& sample) override {
    if (!imu_) imu_ = std::make_unique<ImuArrays>(file_.get(), name_);
    imu_->gyro.add_all(std::span(sample.gyro_B.data(), 3));
    imu_->accel.add_all(std::span(sample.accel_B.data(), 3));
    imu_->stamps.add(to_ns(sample.t));
  }

  void write(const GroundTruth& truth) override {
    GrowingArray<double> poses(file_.get(), name_, "/truth/poses", {7}, kSampleRows);
    GrowingArray<std::int64_t> stamps(file_.get(), name_, "/truth/t_ns", {}, kSampleRows);
    put_attribute(poses.id(), "frame", setup_.name_when_read(truth.frame));
    for (const StampedPose& pose : truth.trajectory) {
      poses.add_all(std::span(pose.T.translation().data(), 3));
      poses.add_all(std::span(pose.T.rotation().coeffs().data(), 4));  // x y z w
      stamps.add(to_ns(pose.t));
    }
    poses.flush();
    stamps.flush();
  }

  void finish() override {
    for (auto& events : events_) events->flush();
    for (auto& frames : frames_)
      if (frames) frames->flush();
    if (imu_) imu_->flush();
    write_offset();
    check_written(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, name_);
    // The file is closed, so that other programs can open it, only after its last data set.
    events_.clear(), frames_.clear(), imu_.reset();
    file_ = H5Handle();
  }

 private:
  void write_offset() {
    const std::int64_t offset = offset_us_.value_or(0);
    const H5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const H5Handle data(
        H5Dcreate2(file_.get(), "/t_offset", H5T_STD_I64LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        H5Dclose);
    check_written(H5Dwrite(data.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &offset) >= 0, name_);
  }

  /// The next event is the first at or after each millisecond up to its own stamp.
  static void index(EventArrays& events, std::int64_t us) {
    constexpr std::int64_t kMostIndexed = 24LL * 3600 * 1000;  // [ms]; a wrong stamp must not fill the disk
    for (; events.next_ms * 1000 <= us && events.next_ms < kMostIndexed; ++events.next_ms)
      events.ms_to_idx.add(events.count);
  }

  WriterSetup setup_;
  std::string name_;
  H5Handle file_;
  std::vector<std::unique_ptr<EventArrays>> events_;  ///< of each camera
  std::vector<std::unique_ptr<FrameArrays>> frames_;  ///< of each camera; null before its first frame
  std::unique_ptr<ImuArrays> imu_;
  std::optional<std::int64_t> offset_us_;  ///< stamp of the first event
};

}  // namespace

std::unique_ptr<RecordingWriter> write_hdf5(const WriterSetup& setup) { return std::make_unique<Hdf5Writer>(setup); }

}  // namespace edged
