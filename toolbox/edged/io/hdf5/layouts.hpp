// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The layouts of data sets in HDF5, and their events and IMU samples independent of the layout.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/hdf5/h5.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Paths within a file; "" for data that a layout does not have. Stamps are integers in microseconds, floating-point
/// numbers in seconds, or nanoseconds if the name ends with _ns.
struct Hdf5Layout {
  std::string_view name;
  /// A group with x, y, t, p, or one data set: rows of (x, y, t, p) or with fields of these names.
  std::string_view events;
  std::string_view offset = "";                     ///< one stamp, added to those of the events
  std::string_view images = "", image_stamps = "";  ///< (n, height, width[, channels])
  std::string_view gyro = "", accel = "";           ///< (n, 3) each [rad/s, m/s^2]; no accel: gyro is (n, 6) with both
  std::string_view imu_stamps = "";
  std::string_view poses = "", pose_stamps = "";  ///< (n, 7): x y z [m] qx qy qz qw, or (n, 4, 4)
  /// The poses are those of the event camera, in a file NAME + one of these beside NAME or NAME_data. None: they are in
  /// the file of the events.
  std::array<std::string_view, 2> truth_files = {};
  bool inverse_poses = false;    ///< the poses are T_X_W
  std::string_view sensor = "";  ///< width and height of the event sensor
  int width = 0, height = 0;     ///< size of the event sensor in all recordings of the data set; 0: not constant
};

std::span<const Hdf5Layout> hdf5_layouts();

/// The path of the same data of a further camera of the file, from 1: "/davis/right/events" of "/davis/left/events",
/// "/ovc/rgb/data" as the third of "/ovc/left/data", "/events2" of "/events"; other paths as they are.
std::string path_of_camera(std::string_view path, std::size_t index);

/// The stamps of a file in nanoseconds, exact for integers.
class H5Stamps {
 public:
  explicit H5Stamps(H5Array array);

  std::uint64_t rows() const { return array_.rows(); }
  /// Timestamp::min() for a stamp out of range. Throws Damage.
  std::vector<Timestamp> read(std::uint64_t first, std::uint64_t count) const;

 private:
  H5Array array_;
  std::int64_t unit_ns_;
};

/// The events of a file in one of the layouts.
class H5Events {
 public:
  /// Nothing if the file has no events in this layout. camera: 0 for the first of the file.
  static std::optional<H5Events> find(const H5File& file, const Hdf5Layout& layout, std::size_t camera = 0);

  std::uint64_t rows() const { return rows_; }
  /// True if the arrays of x, y, t and p differ in length.
  bool ragged() const { return ragged_; }
  /// Events in the order of the file. A stamp out of range is Timestamp::min(), a coordinate out of range is 65535.
  /// Throws Damage.
  std::vector<Event> read(std::uint64_t first, std::uint64_t count) const;
  std::optional<Timestamp> last() const;

 private:
  enum class Kind { Columns, Rows, Fields };
  H5Events(Kind kind, std::vector<H5Array> arrays, Duration offset, bool cut);

  std::vector<Event> read_columns(std::uint64_t first, std::uint64_t count) const;
  std::vector<Event> read_rows(std::uint64_t first, std::uint64_t count) const;
  std::vector<Event> read_fields(std::uint64_t first, std::uint64_t count) const;

  Kind kind_;
  std::vector<H5Array> arrays_;  ///< x, y and p, or one array of all
  std::optional<H5Stamps> stamps_;
  Duration offset_;
  bool cut_, ragged_ = false;
  std::uint64_t rows_ = 0;
};

/// The IMU samples of a file in one of the layouts.
class H5Imu {
 public:
  /// Nothing if the file has no IMU in this layout.
  static std::optional<H5Imu> find(const H5File& file, const Hdf5Layout& layout);

  std::uint64_t rows() const { return rows_; }
  /// A stamp out of range is Timestamp::min(). Throws Damage.
  std::vector<ImuSample> read(std::uint64_t first, std::uint64_t count) const;

 private:
  H5Imu(H5Array first, std::optional<H5Array> second, H5Stamps stamps);
  bool accel_first() const;

  H5Array first_;
  std::optional<H5Array> second_;  ///< none: both sensors are in the first array
  H5Stamps stamps_;
  std::uint64_t rows_;
  bool swapped_ = false;  ///< the specific force comes first
};

}  // namespace edged
