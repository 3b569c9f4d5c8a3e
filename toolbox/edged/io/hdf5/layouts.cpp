// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The table of layouts, and the events of each of them.
#include "edged/io/hdf5/layouts.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "edged/io/hdf5/h5_filters.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/state.hpp"

namespace edged {
namespace {

constexpr std::array kLayouts = {
    Hdf5Layout{.name = "m3ed",
               .events = "/prophesee/left",
               .images = "/ovc/left/data",
               .image_stamps = "/ovc/ts",
               .gyro = "/ovc/imu/omega",
               .accel = "/ovc/imu/accel",
               .imu_stamps = "/ovc/imu/ts",
               .poses = "/Cn_T_C0",
               .pose_stamps = "/ts",
               .truth_files = {"_pose_gt.h5", "_depth_gt.h5"},
               .inverse_poses = true,
               .sensor = "/prophesee/left/calib/resolution",
               .width = 1280,
               .height = 720},
    Hdf5Layout{.name = "mvsec",
               .events = "/davis/left/events",
               .images = "/davis/left/image_raw",
               .image_stamps = "/davis/left/image_raw_ts",
               .gyro = "/davis/left/imu",
               .imu_stamps = "/davis/left/imu_ts",
               .poses = "/davis/left/pose",
               .pose_stamps = "/davis/left/pose_ts",
               .truth_files = {"_gt.hdf5"},
               .width = 346,
               .height = 260},
    Hdf5Layout{.name = "metavision", .events = "/CD/events"},
    // DSEC, VECtor and TUM-VIE, which differ in their other files. hdf5_writer adds frames, IMU and ground truth.
    Hdf5Layout{.name = "dsec",
               .events = "/events",
               .offset = "/t_offset",
               .images = "/frames/images",
               .image_stamps = "/frames/t_ns",
               .gyro = "/imu/gyro",
               .accel = "/imu/accel",
               .imu_stamps = "/imu/t_ns",
               .poses = "/truth/poses",
               .pose_stamps = "/truth/t_ns"},
    Hdf5Layout{.name = "raw_events", .events = "/raw_events"},
    Hdf5Layout{.name = "eds", .events = "", .offset = "/t_offset"},
};

constexpr Timestamp kNoStamp = Timestamp::min();

Timestamp stamp_of(std::int64_t value, std::int64_t unit_ns) {
  std::int64_t ns = 0;
  const bool fits = !__builtin_mul_overflow(value, unit_ns, &ns) && ns >= -kMaxStampNs && ns <= kMaxStampNs;
  return fits ? timestamp_from_ns(ns) : kNoStamp;
}

Timestamp stamp_of(double value, std::int64_t unit_ns) {
  const double ns = std::round(value * static_cast<double>(unit_ns));
  return !(std::abs(ns) <= static_cast<double>(kMaxStampNs)) ? kNoStamp
                                                             : timestamp_from_ns(static_cast<std::int64_t>(ns));
}

Timestamp shifted(Timestamp t, Duration offset) {
  if (t == kNoStamp) return t;
  const std::int64_t ns = to_ns(t + offset);  // neither can overflow
  return ns < -kMaxStampNs || ns > kMaxStampNs ? kNoStamp : t + offset;
}

/// The unit of stamps by the name and type of the array. For floating-point numbers, the last stamp decides.
std::int64_t unit_of(const H5Array& array) {
  constexpr std::int64_t kMicroseconds = 1000, kSeconds = 1'000'000'000;
  if (array.path().ends_with("_ns")) return 1;
  if (!array.floating()) return kMicroseconds;
  if (array.rows() == 0 || array.columns() != 1) return kSeconds;
  try {
    const double last = array.read<double>(array.rows() - 1, 1).front();
    return std::abs(last) * static_cast<double>(kSeconds) > static_cast<double>(kMaxStampNs) ? kMicroseconds : kSeconds;
  } catch (const Damage&) {
    return kSeconds;
  }
}

std::uint16_t pixel(double v) { return v >= 0 && v < 65535 ? static_cast<std::uint16_t>(v) : 65535; }
std::uint16_t pixel(std::int32_t v) { return v >= 0 && v < 65535 ? static_cast<std::uint16_t>(v) : 65535; }

std::vector<std::uint16_t> read_pixels(const H5Array& array, std::uint64_t first, std::uint64_t count) {
  // The conversion clamps large values to 65535, as wanted, but negative ones to 0.
  if (array.unsigned_integer()) return array.read<std::uint16_t>(first, count);
  std::vector<std::uint16_t> pixels(count);
  std::ranges::transform(array.read<std::int32_t>(first, count), pixels.begin(),
                         [](std::int32_t v) { return pixel(v); });
  return pixels;
}

/// The type of the library for EcfEvent.
H5Handle fields_type() {
  H5Handle type(H5Tcreate(H5T_COMPOUND, sizeof(EcfEvent)), H5Tclose);
  H5Tinsert(type.get(), "x", offsetof(EcfEvent, x), H5T_NATIVE_UINT16);
  H5Tinsert(type.get(), "y", offsetof(EcfEvent, y), H5T_NATIVE_UINT16);
  H5Tinsert(type.get(), "p", offsetof(EcfEvent, p), H5T_NATIVE_INT16);
  H5Tinsert(type.get(), "t", offsetof(EcfEvent, t), H5T_NATIVE_INT64);
  return type;
}

Duration offset_of(const H5File& file, std::string_view path) try {
  const auto array = file.find(path);
  if (!array || array->rows() == 0) return Duration(0);
  const Timestamp offset = array->floating() ? stamp_of(array->read<double>(0, 1).front(), 1000)
                                             : stamp_of(array->read<std::int64_t>(0, 1).front(), 1000);
  return offset == kNoStamp ? Duration(0) : offset.time_since_epoch();
} catch (const Damage&) {
  return Duration(0);
}

/// A data set of events: with fields of them, or rows of four numbers.
bool has_event_shape(const H5Array& one) {
  if (one.compound()) return one.has_fields({"x", "y", "p", "t"}) && one.columns() == 1;
  return one.shape().size() == 2 && one.columns() == 4;
}

}  // namespace

std::span<const Hdf5Layout> hdf5_layouts() { return kLayouts; }

std::string path_of_camera(std::string_view path, std::size_t index) {
  constexpr std::array<std::string_view, 3> kSides = {"/left", "/right", "/rgb"};
  std::string out(path);
  if (index == 0) return out;
  if (const std::size_t left = path.find(kSides[0]); left != std::string_view::npos)
    return index < kSides.size() ? out.replace(left, kSides[0].size(), kSides[index]) : "";
  for (const std::string_view group : {"/events", "/frames"})
    if (path == group || path.starts_with(std::string(group) + "/"))
      return out.insert(group.size(), std::to_string(index + 1));
  return out;
}

H5Stamps::H5Stamps(H5Array array) : array_(std::move(array)), unit_ns_(unit_of(array_)) {}

std::vector<Timestamp> H5Stamps::read(std::uint64_t first, std::uint64_t count) const {
  if (array_.columns() != 1) throw Damage(array_.path() + " has several stamps a row");
  std::vector<Timestamp> stamps;
  stamps.reserve(count);
  if (array_.floating())
    for (const double v : array_.read<double>(first, count)) stamps.push_back(stamp_of(v, unit_ns_));
  else
    for (const std::int64_t v : array_.read<std::int64_t>(first, count)) stamps.push_back(stamp_of(v, unit_ns_));
  return stamps;
}

H5Events::H5Events(Kind kind, std::vector<H5Array> arrays, Duration offset, bool cut)
    : kind_(kind), arrays_(std::move(arrays)), offset_(offset), cut_(cut), rows_(arrays_.front().rows()) {
  for (const H5Array& array : arrays_) {
    ragged_ = ragged_ || array.rows() != arrays_.front().rows();
    rows_ = std::min(rows_, array.rows());
  }
  if (kind_ != Kind::Columns) return;
  stamps_.emplace(std::move(arrays_.back()));
  arrays_.pop_back();
}

std::optional<H5Events> H5Events::find(const H5File& file, const Hdf5Layout& layout, std::size_t camera) {
  const std::string root = path_of_camera(layout.events, camera);
  if (camera > 0 && (root.empty() || root == layout.events)) return std::nullopt;
  const Duration offset = offset_of(file, layout.offset);
  std::vector<H5Array> arrays;
  if (auto one = file.find(root)) {
    if (!has_event_shape(*one)) return std::nullopt;
    const Kind kind = one->compound() ? Kind::Fields : Kind::Rows;
    arrays.push_back(std::move(*one));
    return H5Events(kind, std::move(arrays), offset, file.cut());
  }
  for (const char* column : {"/x", "/y", "/p", "/t"}) {
    auto array = file.find(root + column);
    if (!array || array->columns() != 1 || array->shape().size() != 1) return std::nullopt;
    arrays.push_back(std::move(*array));
  }
  return H5Events(Kind::Columns, std::move(arrays), offset, file.cut());
}

std::vector<Event> H5Events::read(std::uint64_t first, std::uint64_t count) const {
  std::vector<Event> events = kind_ == Kind::Columns ? read_columns(first, count)
                              : kind_ == Kind::Rows  ? read_rows(first, count)
                                                     : read_fields(first, count);
  if (cut_ && std::ranges::all_of(events, [](const Event& e) { return e.x == 0 && e.y == 0; }))
    throw Damage("data after the end of a cut file");
  for (Event& event : events) event.t = shifted(event.t, offset_);
  return events;
}

std::vector<Event> H5Events::read_columns(std::uint64_t first, std::uint64_t count) const {
  const auto x = read_pixels(arrays_[0], first, count), y = read_pixels(arrays_[1], first, count);
  const auto p = arrays_[2].read<std::int8_t>(first, count);
  const auto t = stamps_->read(first, count);
  std::vector<Event> events(count);
  // By its members: whole, it would be read back from the stack before its parts are written there, 5 ns an event.
  for (std::size_t i = 0; i < count; ++i) {
    events[i].t = t[i];
    events[i].x = x[i], events[i].y = y[i];
    events[i].positive = p[i] > 0;
  }
  return events;
}

std::vector<Event> H5Events::read_rows(std::uint64_t first, std::uint64_t count) const {
  const std::int64_t unit = unit_of(arrays_[0]);
  const auto values = arrays_[0].read<double>(first, count);
  std::vector<Event> events(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double* v = &values[4 * i];
    events[i] = {stamp_of(v[2], unit), pixel(v[0]), pixel(v[1]), v[3] > 0};
  }
  return events;
}

std::vector<Event> H5Events::read_fields(std::uint64_t first, std::uint64_t count) const {
  static const H5Handle type = fields_type();
  std::vector<EcfEvent> rows(count);
  arrays_[0].read_as(type.get(), first, count, rows.data());
  std::vector<Event> events(count);
  for (std::size_t i = 0; i < count; ++i)
    events[i] = {stamp_of(rows[i].t, std::int64_t{1000}), rows[i].x, rows[i].y, rows[i].p > 0};
  return events;
}

std::optional<Timestamp> H5Events::last() const try {
  if (rows_ == 0) return std::nullopt;
  const Timestamp t = read(rows_ - 1, 1).front().t;
  return t == kNoStamp ? std::nullopt : std::optional(t);
} catch (const Damage&) {
  return std::nullopt;
}

std::optional<H5Imu> H5Imu::find(const H5File& file, const Hdf5Layout& layout) {
  auto gyro = file.find(layout.gyro), accel = file.find(layout.accel), stamps = file.find(layout.imu_stamps);
  if (!gyro || !stamps || gyro->columns() != (accel ? 3U : 6U) || (accel && accel->columns() != 3)) return std::nullopt;
  return H5Imu(std::move(*gyro), std::move(accel), H5Stamps(std::move(*stamps)));
}

H5Imu::H5Imu(H5Array first, std::optional<H5Array> second, H5Stamps stamps)
    : first_(std::move(first)),
      second_(std::move(second)),
      stamps_(std::move(stamps)),
      rows_(std::min(first_.rows(), stamps_.rows())) {
  if (second_) rows_ = std::min(rows_, second_->rows());
  swapped_ = !second_ && accel_first();
}

/// For rows with both sensors in an undocumented order. The three columns with gravity are the specific force.
bool H5Imu::accel_first() const try {
  constexpr std::uint64_t kFirstSamples = 1024;
  const std::uint64_t count = std::min(kFirstSamples, first_.rows());
  const auto values = first_.read<double>(0, count);
  double first = 0, second = 0;
  for (std::size_t i = 0; i < count; ++i) {
    first += Eigen::Vector3d(&values[6 * i]).norm();
    second += Eigen::Vector3d(&values[6 * i + 3]).norm();
  }
  const auto n = static_cast<double>(std::max<std::uint64_t>(count, 1));
  return std::abs(first / n - kGravity) < std::abs(second / n - kGravity);
} catch (const Damage&) {
  return true;
}

std::vector<ImuSample> H5Imu::read(std::uint64_t first, std::uint64_t count) const {
  const auto stamps = stamps_.read(first, count);
  const auto a = first_.read<double>(first, count);
  const auto b = second_ ? second_->read<double>(first, count) : std::vector<double>();
  std::vector<ImuSample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d one(second_ ? &a[3 * i] : &a[6 * i]), other(second_ ? &b[3 * i] : &a[6 * i + 3]);
    samples[i] = swapped_ ? ImuSample{stamps[i], other, one} : ImuSample{stamps[i], one, other};
  }
  return samples;
}

}  // namespace edged
