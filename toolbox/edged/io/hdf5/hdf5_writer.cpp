// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/hdf5/hdf5.hpp"

#include <deque>
#include <memory>
#include <optional>
#include <utility>
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
class GrowingArray {
 public:
  struct Shape {
    std::vector<hsize_t> row;
    hsize_t chunk_rows;
  };

  /// type: of the numbers, which have that many bytes.
  GrowingArray(hid_t file, std::string file_name, const std::string& path, std::pair<hid_t, std::size_t> type,
               const Shape& shape)
      : file_name_(std::move(file_name)), type_(type.first), shape_(shape.row), row_bytes_(type.second) {
    for (const hsize_t side : shape_) row_bytes_ *= side;
    chunk_bytes_ = shape.chunk_rows * row_bytes_;
    shape_.insert(shape_.begin(), 0);
    std::vector<hsize_t> most = shape_, chunk = shape_;
    most.front() = H5S_UNLIMITED;
    chunk.front() = shape.chunk_rows;
    const H5Handle space(H5Screate_simple(static_cast<int>(shape_.size()), shape_.data(), most.data()), H5Sclose);
    const H5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose), links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    const auto parameters = blosc_parameters(type.second, chunk_bytes_);
    H5Pset_create_intermediate_group(links.get(), 1);
    H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_filter(creation.get(), static_cast<H5Z_filter_t>(H5Filter::Blosc), H5Z_FLAG_MANDATORY, parameters.size(),
                  parameters.data());
    data_ = H5Handle(H5Dcreate2(file, path.c_str(), type_, space.get(), links.get(), creation.get(), H5P_DEFAULT),
                     H5Dclose);
    check_written(bool(data_), file_name_);
  }

  /// T: the type of the numbers.
  template <typename T>
  void add(T value) {
    append_number(rest_, value);
    if (rest_.size() >= chunk_bytes_) flush();
  }
  template <typename T>
  void add_all(const T* values, std::size_t count) {
    rest_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    if (rest_.size() >= chunk_bytes_) flush();
  }

  void flush() {
    const hsize_t rows = rest_.size() / row_bytes_;
    if (rows == 0) return;
    std::vector<hsize_t> start(shape_.size(), 0), extent = shape_;
    start.front() = shape_.front();
    extent.front() = rows;
    shape_.front() += rows;
    check_written(H5Dset_extent(data_.get(), shape_.data()) >= 0, file_name_);
    const H5Handle space(H5Dget_space(data_.get()), H5Sclose);
    const H5Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
    check_written(H5Dwrite(data_.get(), type_, memory.get(), space.get(), H5P_DEFAULT, rest_.data()) >= 0, file_name_);
    rest_.clear();
  }

  hid_t id() const { return data_.get(); }

 private:
  std::string file_name_;
  hid_t type_;
  std::vector<hsize_t> shape_;
  std::size_t row_bytes_, chunk_bytes_ = 0;
  std::string rest_;  ///< values not yet written
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
  GrowingArray *x, *y, *p, *t, *ms_to_idx;
  std::uint64_t count = 0;
  std::int64_t next_ms = 0;  ///< first millisecond without an index
};

struct FrameArrays {
  cv::Size size;
  GrowingArray *images, *stamps;
};

struct ImuArrays {
  GrowingArray *gyro, *accel, *stamps;
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
      events_.push_back({event_array<std::uint16_t>(group + "/x"), event_array<std::uint16_t>(group + "/y"),
                         event_array<std::uint8_t>(group + "/p"), event_array<std::int64_t>(group + "/t"),
                         event_array<std::uint64_t>(i == 0 ? "/ms_to_idx" : group + "/ms_to_idx")});
      const cv::Size sensor = setup.event_sensor(i);
      const H5Handle events(H5Gopen2(file_.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
      put_attribute(events.get(), "width", sensor.width);
      put_attribute(events.get(), "height", sensor.height);
    }
  }

  void write(const EventBatch& batch) override {
    EventArrays& events = events_[setup_.place_of(batch.camera, Modality::Events)];
    for (const Event& event : batch.events) {
      const std::int64_t us = to_ns(event.t) / 1000;
      if (!offset_us_) offset_us_ = us;
      index(events, us - *offset_us_);
      events.x->add(event.x);
      events.y->add(event.y);
      events.p->add(std::uint8_t{event.positive});
      events.t->add(us - *offset_us_);
      ++events.count;
    }
  }

  void write(const Frame& frame) override {
    const std::size_t camera = setup_.place_of(frame.camera, Modality::Frames);
    auto& frames = frames_[camera];
    const auto rows = static_cast<hsize_t>(frame.image.rows), columns = static_cast<hsize_t>(frame.image.cols);
    const std::string group = path_of_camera("/frames", camera);
    if (!frames)
      frames = {frame.image.size(), array<std::uint8_t>(group + "/images", {{rows, columns}, 1}),
                array<std::int64_t>(group + "/t_ns", {{}, kSampleRows})};
    EDGED_CHECK(frame.image.size() == frames->size && frame.image.type() == CV_8UC1, "frames of one size and type");
    const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
    frames->images->add_all(image.data, image.total());
    frames->stamps->add(to_ns(frame.t));
  }

  void write(const ImuSample& sample) override {
    if (!imu_)
      imu_ = {array<double>("/imu/gyro", {{3}, kSampleRows}), array<double>("/imu/accel", {{3}, kSampleRows}),
              array<std::int64_t>("/imu/t_ns", {{}, kSampleRows})};
    imu_->gyro->add_all(sample.gyro_B.data(), 3);
    imu_->accel->add_all(sample.accel_B.data(), 3);
    imu_->stamps->add(to_ns(sample.t));
  }

  void write(const GroundTruth& truth) override {
    GrowingArray& poses = *array<double>("/truth/poses", {{7}, kSampleRows});
    GrowingArray& stamps = *array<std::int64_t>("/truth/t_ns", {{}, kSampleRows});
    put_attribute(poses.id(), "frame", setup_.name_when_read(truth.frame));
    for (const StampedPose& pose : truth.trajectory) {
      poses.add_all(pose.T.translation().data(), 3);
      poses.add_all(pose.T.rotation().coeffs().data(), 4);  // x y z w
      stamps.add(to_ns(pose.t));
    }
  }

  void finish() override {
    for (GrowingArray& array : arrays_) array.flush();
    write_offset();
    check_written(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) >= 0, name_);
    // The file is closed, so that other programs can open it, only after its last data set.
    arrays_.clear();
    file_ = H5Handle();
  }

 private:
  template <typename T>
  GrowingArray* array(const std::string& path, const GrowingArray::Shape& shape) {
    return &arrays_.emplace_back(file_.get(), name_, path, std::pair(h5_native_type<T>(), sizeof(T)), shape);
  }
  template <typename T>
  GrowingArray* event_array(const std::string& path) {
    return array<T>(path, {{}, kEventRows});
  }

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
      events.ms_to_idx->add(events.count);
  }

  WriterSetup setup_;
  std::string name_;
  H5Handle file_;
  std::deque<GrowingArray> arrays_;                 ///< all arrays of the file
  std::vector<EventArrays> events_;                 ///< one for each camera
  std::vector<std::optional<FrameArrays>> frames_;  ///< one for each camera; nothing before its first frame
  std::optional<ImuArrays> imu_;
  std::optional<std::int64_t> offset_us_;  ///< stamp of the first event
};

}  // namespace

std::unique_ptr<RecordingWriter> write_hdf5(const WriterSetup& setup) { return std::make_unique<Hdf5Writer>(setup); }

}  // namespace edged
