// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/saved_map.hpp"

#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <type_traits>

#include "edged/core/check.hpp"
#include "edged/map/tuning.hpp"

namespace edged {
namespace {

static_assert(std::endian::native == std::endian::little, "maps are written and read as they lie in memory");

constexpr std::string_view kMagic = "edged map\n";
constexpr std::uint32_t kVersion = 3;
constexpr std::uint32_t kOneView = 1;    // the version whose keyframes have one view each
constexpr std::uint32_t kAllActive = 2;  // the last version whose covariance is of all keyframes
constexpr std::size_t kMostCameras = 16, kMostKeyframes = 10'000, kMostPoints = 10'000, kLongestName = 200;
constexpr Duration kBefore = std::chrono::seconds(1), kOldest = std::chrono::hours(24 * 365 * 100);

[[noreturn]] void refuse(const char* why) {
  throw InputError::format("not a usable map: {}; make it again with --save-map", why);
}

/// FNV-1a: detects damage, not manipulation.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char c : bytes) sum = (sum ^ static_cast<std::uint8_t>(c)) * 0x100000001b3U;
  return sum;
}

template <typename T>
concept Plain = std::is_arithmetic_v<T>;

/// Writer and Reader have the same interface, so that one list serves both: fields_of.
class Writer {
 public:
  void operator()(Plain auto& x) { bytes.append(reinterpret_cast<const char*>(&x), sizeof(x)); }
  /// The size of a vector or text.
  void size(auto& container, std::size_t /*most*/) {
    auto n = static_cast<std::uint32_t>(container.size());
    (*this)(n);
  }
  void expect(std::size_t /*bytes*/) {}

  std::string bytes;
  static constexpr std::uint32_t version = kVersion;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes, std::uint32_t its_version = kVersion) : version(its_version), bytes_(bytes) {}

  void operator()(Plain auto& x) {
    expect(sizeof(x));
    std::memcpy(&x, bytes_.data(), sizeof(x));
    bytes_.remove_prefix(sizeof(x));
    if (!std::isfinite(static_cast<double>(x))) refuse("a number in it is not finite");
  }
  void size(auto& container, std::size_t most) {
    std::uint32_t n = 0;
    (*this)(n);
    if (n > most) refuse("its sizes exceed its length");
    expect(n);
    container.resize(n);
  }
  /// Checks that so many bytes follow, before the allocation.
  void expect(std::size_t bytes) const {
    if (bytes > bytes_.size()) refuse("it is truncated");
  }
  bool at_end() const { return bytes_.empty(); }

  const std::uint32_t version;

 private:
  std::string_view bytes_;
};

void fields_of(auto& archive, std::string& text) {
  archive.size(text, kLongestName);
  for (char& c : text) archive(c);
}

template <typename Derived>
void fields_of(auto& archive, Eigen::PlainObjectBase<Derived>& matrix) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) archive(matrix.data()[i]);
}

void fields_of(auto& archive, SE3& T) {
  fields_of(archive, T.rotation().coeffs());
  fields_of(archive, T.translation());
}

void fields_of(auto& archive, Timestamp& t) {
  std::int64_t ns = to_ns(t);
  archive(ns);
  t = timestamp_from_ns(ns);
}

void fields_of(auto& archive, MapPoint& point) {
  fields_of(archive, point.point);
  archive(point.inverse_depth);
  archive(point.sigma);
  for (std::uint8_t& pixel : point.patch.pixels) archive(pixel);
  std::uint8_t described = point.descriptor ? 1 : 0;
  archive(described);
  if (described != 0) {
    if (!point.descriptor) point.descriptor.emplace();
    for (std::uint64_t& word : *point.descriptor) archive(word);
  }
  fields_of(archive, point.pixel);
  archive(point.searched);
  archive(point.matched);
}

void fields_of(auto& archive, MapView& view) {
  fields_of(archive, view.camera);
  fields_of(archive, view.T_B_C);
  archive.size(view.points, kMostPoints);
  for (MapPoint& point : view.points) fields_of(archive, point);
}

void fields_of(auto& archive, MapKeyframe& keyframe) {
  fields_of(archive, keyframe.t);
  fields_of(archive, keyframe.matched_at);
  if (archive.version == kOneView) {
    keyframe.views.resize(1);
  } else {
    archive.size(keyframe.views, kMostCameras);
  }
  for (MapView& view : keyframe.views) fields_of(archive, view);
}

void fields_of(auto& archive, ConditionalPose& pose) {
  archive(pose.keyframe);
  archive.size(pose.parents, InactiveKeyframes::kMostParents);
  for (ConditionalPose::Parent& parent : pose.parents) {
    archive(parent.keyframe);
    fields_of(archive, parent.gain);
  }
  fields_of(archive, pose.covariance);
}

void fields_of(auto& archive, SavedMap& map) {
  archive.size(map.cameras, kMostCameras);
  for (SavedMap::Camera& camera : map.cameras) {
    fields_of(archive, camera.name);
    archive(camera.width);
    archive(camera.height);
    archive(camera.focal);
  }
  archive.size(map.keyframes, kMostKeyframes);
  for (MapKeyframe& keyframe : map.keyframes) fields_of(archive, keyframe);
  map.T_M_K.resize(map.keyframes.size());
  for (SE3& T : map.T_M_K) fields_of(archive, T);
  if (archive.version > kAllActive) {
    archive.size(map.inactive, map.keyframes.size());
    for (ConditionalPose& pose : map.inactive) fields_of(archive, pose);
  }
  const Eigen::Index n = 6 * (std::ssize(map.T_M_K) - std::ssize(map.inactive));
  archive.expect(static_cast<std::size_t>(n * (n + 1) / 2) * sizeof(double));
  map.covariance.conservativeResize(n, n);
  for (Eigen::Index column = 0; column < n; ++column) {
    for (Eigen::Index row = column; row < n; ++row) archive(map.covariance(row, column));  // it is symmetric
  }
}

/// Each is in the list once, and its parents are active or later in the list.
void check_inactive(const SavedMap& map) {
  std::vector<bool> usable(map.keyframes.size(), true);
  for (const ConditionalPose& pose : map.inactive) {
    if (pose.keyframe >= usable.size() || !usable[pose.keyframe])
      refuse("an inactive pose in it is there twice or missing");
    usable[pose.keyframe] = false;
    const auto known = [&](const ConditionalPose::Parent& parent) {
      return parent.keyframe < usable.size() && usable[parent.keyframe];
    };
    if (!std::ranges::all_of(pose.parents, known) || (pose.covariance.diagonal().array() < 0.0).any())
      refuse("a pose in it has wrong parents");
  }
}

void check_values(const SavedMap& map) {
  const auto past = [](Timestamp t) { return t < Timestamp() && t > Timestamp() - kOldest; };
  const auto unit = [](const SE3& T) { return std::abs(T.rotation().norm() - 1.0) < 1e-6; };
  const auto sound = [](const MapPoint& p) {
    return p.inverse_depth > 0.0 && p.sigma >= 0.0 && p.searched >= p.matched;
  };
  const auto usable = [&](const MapView& view) {
    return !view.points.empty() && std::ranges::all_of(view.points, sound) && unit(view.T_B_C);
  };
  for (const MapKeyframe& keyframe : map.keyframes) {
    if (keyframe.views.empty() || !std::ranges::all_of(keyframe.views, usable) || !past(keyframe.t) ||
        !past(keyframe.matched_at))
      refuse("a keyframe in it is invalid");
  }
  if (!std::ranges::all_of(map.T_M_K, unit) || (map.covariance.diagonal().array() < 0.0).any())
    refuse("a pose in it is invalid");
  check_inactive(map);
  if (!std::ranges::is_sorted(map.keyframes, {}, &MapKeyframe::t)) refuse("its keyframes are not in order");
}

/// Shifts times so that the newest is before any time of another run.
void set_back(std::vector<MapKeyframe>& keyframes) {
  Timestamp newest = Timestamp::min();
  for (const MapKeyframe& keyframe : keyframes) newest = std::max({newest, keyframe.t, keyframe.matched_at});
  const Duration by = newest - (Timestamp() - kBefore);
  for (MapKeyframe& keyframe : keyframes) keyframe.t -= by, keyframe.matched_at -= by;
}

}  // namespace

void check_fits(const SavedMap& map, const Rig& rig) {
  std::set<std::string> viewed;  // a run of frames and events may have mapped by frames alone
  for (const MapKeyframe& keyframe : map.keyframes)
    for (const MapView& view : keyframe.views) viewed.insert(view.camera);
  bool any = viewed.empty();
  for (const SavedMap::Camera& camera : map.cameras) {
    if (!viewed.contains(camera.name)) continue;
    const auto same = std::ranges::find(rig.cameras, camera.name, &RigCamera::name);
    if (same == rig.cameras.end()) continue;
    any = true;
    const CameraModel& now = same->model;
    if (now.width() != camera.width || now.height() != camera.height ||
        std::abs(now.mean_focal() - camera.focal) > kMapTuning.same_focal_share * camera.focal) {
      throw InputError::format(
          "created with another lens: camera {} of {}x{} px, focal length {:.1f} px; now {}x{}, {:.1f}", camera.name,
          camera.width, camera.height, camera.focal, now.width(), now.height(), now.mean_focal());
    }
  }
  if (!any)
    throw InputError::format(
        "created with other cameras: its keyframes are of {}; use it in a mode and with a rig that "
        "have one",
        fmt::join(viewed, ", "));
}

std::string to_bytes(const SavedMap& map) {
  SavedMap kept = map;
  if (!kept.keyframes.empty()) set_back(kept.keyframes);
  Writer body;
  fields_of(body, kept);
  Writer head;
  head.bytes = kMagic;
  std::uint32_t version = kVersion;
  std::uint64_t sum = checksum(body.bytes);
  head(version);
  head(sum);
  return head.bytes + body.bytes;
}

SavedMap saved_map_from_bytes(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) refuse("it has no map header");
  Reader head(bytes.substr(kMagic.size()));
  std::uint32_t version = 0;
  std::uint64_t sum = 0;
  head(version);
  if (version < kOneView || version > kVersion)
    throw InputError::format("a map of version {}, this program reads {} to {}", version, kOneView, kVersion);
  head(sum);
  const std::string_view body = bytes.substr(kMagic.size() + sizeof(version) + sizeof(sum));
  if (checksum(body) != sum) refuse("it has been damaged or cut off");
  Reader reader(body, version);
  SavedMap map;
  fields_of(reader, map);
  if (!reader.at_end()) refuse("it has extra bytes at its end");
  map.covariance.triangularView<Eigen::StrictlyUpper>() = map.covariance.transpose();
  check_values(map);
  return map;
}

}  // namespace edged
