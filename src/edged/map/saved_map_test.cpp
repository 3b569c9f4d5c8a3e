// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/saved_map.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using std::chrono::seconds;

MapView second_view(MapView view) {
  view.camera = "frames2";
  view.points.pop_back();
  return view;
}

SavedMap some_map() {
  SavedMap map;
  map.cameras = {{"frames", 240, 180, 200.0}, {"events", 240, 180, 205.0}};
  for (int k = 0; k < 3; ++k) {
    MapView view{k == 1 ? "events" : "frames", SE3(so3::exp({0.1, 0.2, 0.3 * k}), {0.01, 0.02, 0.03}), {}};
    for (int i = 0; i < 4; ++i) {
      MapPoint point;
      point.point = {0.1 * i, -0.2 * k};
      point.inverse_depth = 0.5 + i;
      point.sigma = 0.01;
      point.patch.pixels.fill(static_cast<std::uint8_t>(10 * i + k));
      if (i != 2) point.descriptor = Descriptor{1U + static_cast<unsigned>(i), 2, 3, ~std::uint64_t{0}};
      point.pixel = {100.0 + i, 50.0};
      point.searched = 7, point.matched = 5;
      view.points.push_back(point);
    }
    map.keyframes.push_back({Timestamp() + seconds(10 + k), Timestamp() + seconds(40 - k), {view}});
    if (k == 2) map.keyframes.back().views.push_back(second_view(view));
    map.T_M_K.emplace_back(so3::exp({0.0, 0.1 * k, 0.5}), Eigen::Vector3d(k, 2.0, -1.0));
  }
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(18, 18);
  map.covariance = root * root.transpose();
  return map;
}

Rig rig_with(const std::string& name, double focal) {
  Rig rig;
  rig.cameras.push_back({name, Modality::Frames, CameraModel(240, 180, focal, focal, 120, 90), SE3(), Duration(0)});
  return rig;
}

void expect_equal(const MapView& a, const MapView& b) {
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.T_B_C.matrix(), b.T_B_C.matrix());
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].point, b.points[i].point);
    EXPECT_EQ(a.points[i].patch.pixels, b.points[i].patch.pixels);
    EXPECT_EQ(a.points[i].descriptor, b.points[i].descriptor);
    EXPECT_EQ(a.points[i].matched, b.points[i].matched);
  }
}

/// As version 1 or 2 has it, without the number of inactive keyframes; in version 1 keyframes have one view each and no
/// number of views. Of a map without cameras and with one keyframe.
std::string as_version(char version, std::string bytes) {
  constexpr std::size_t kVersionAt = 10, kSumAt = 14, kBodyAt = 22, kCovariance = 21 * sizeof(double);
  bytes.erase(bytes.size() - kCovariance - 4, 4);
  if (version == 1) bytes.erase(kBodyAt + 8 + 16, 4);  // after the numbers of cameras and of keyframes, and two times
  bytes[kVersionAt] = version;
  std::uint64_t sum = 0xcbf29ce484222325U;
  for (const char c : bytes.substr(kBodyAt)) sum = (sum ^ static_cast<std::uint8_t>(c)) * 0x100000001b3U;
  std::memcpy(bytes.data() + kSumAt, &sum, sizeof(sum));
  return bytes;
}

std::string refusal(std::string_view bytes) {
  try {
    saved_map_from_bytes(bytes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(SavedMap, ComesBackAsItWas) {
  const SavedMap map = some_map(), back = saved_map_from_bytes(to_bytes(map));
  ASSERT_EQ(back.keyframes.size(), map.keyframes.size());
  EXPECT_EQ(back.cameras[1].name, "events");
  EXPECT_EQ(back.covariance, map.covariance.selfadjointView<Eigen::Lower>().toDenseMatrix());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    const MapKeyframe &a = map.keyframes[k], &b = back.keyframes[k];
    EXPECT_EQ(map.T_M_K[k].matrix(), back.T_M_K[k].matrix());
    ASSERT_EQ(a.views.size(), b.views.size());
    for (std::size_t v = 0; v < a.views.size(); ++v) expect_equal(a.views[v], b.views[v]);
  }
  EXPECT_EQ(to_bytes(back), to_bytes(map));
}

TEST(SavedMap, LiesBeforeTheNextRun) {
  const SavedMap back = saved_map_from_bytes(to_bytes(some_map()));
  EXPECT_EQ(back.keyframes[0].matched_at, Timestamp() - seconds(1));  // 40 s, the newest of all
  EXPECT_EQ(back.keyframes[2].t, Timestamp() - seconds(29));
}

TEST(SavedMap, AnEmptyOneIsOne) { EXPECT_TRUE(saved_map_from_bytes(to_bytes(SavedMap())).keyframes.empty()); }

TEST(SavedMap, DamagedOnesAreRefused) {
  const std::string good = to_bytes(some_map());
  for (std::size_t n = 0; n < good.size(); n += n < 100 ? 1 : 97) EXPECT_NE(refusal(good.substr(0, n)), "") << n;
  EXPECT_NE(refusal(good + "x"), "");
  for (std::size_t i = 0; i < good.size(); i += 61) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    EXPECT_NE(refusal(bad), "") << i;
  }
  std::string later = good;
  later[10] = 4;
  EXPECT_EQ(refusal(later), "a map of version 4, this program reads 1 to 3");
}

TEST(SavedMap, OfEarlierVersionsIsRead) {
  SavedMap map = some_map();
  map.cameras.clear();
  map.keyframes.resize(1), map.T_M_K.resize(1);
  map.covariance.conservativeResize(6, 6);
  for (const char version : {1, 2}) {
    const SavedMap back = saved_map_from_bytes(as_version(version, to_bytes(map)));
    ASSERT_EQ(back.keyframes.size(), 1U);
    ASSERT_EQ(back.keyframes[0].views.size(), 1U);
    expect_equal(back.keyframes[0].views[0], map.keyframes[0].views[0]);
    EXPECT_EQ(to_bytes(back), to_bytes(map));
  }
}

/// The first keyframe is inactive, its parent is the last.
SavedMap map_with_one_inactive() {
  SavedMap map = some_map();
  map.covariance.conservativeResize(12, 12);
  map.inactive = {{0, {{2, 0.9 * Matrix6d::Identity()}}, 1e-6 * Matrix6d::Identity()}};
  return map;
}

TEST(SavedMap, KeepsWhatRestsAndRefusesWrongTies) {
  const SavedMap map = map_with_one_inactive(), back = saved_map_from_bytes(to_bytes(map));
  ASSERT_EQ(back.inactive.size(), 1U);
  EXPECT_EQ(back.inactive[0].parents[0].keyframe, 2U);
  EXPECT_EQ(back.inactive[0].parents[0].gain, map.inactive[0].parents[0].gain);
  EXPECT_EQ(back.covariance.rows(), 12);
  EXPECT_EQ(to_bytes(back), to_bytes(map));
  for (const std::uint32_t to : {0U, 3U}) {  // itself, none
    SavedMap wrong = map;
    wrong.inactive[0].parents[0].keyframe = to;
    EXPECT_NE(refusal(to_bytes(wrong)), "") << to;
  }
  SavedMap twice = map;
  twice.inactive.push_back(twice.inactive[0]);
  twice.covariance.conservativeResize(6, 6);
  EXPECT_NE(refusal(to_bytes(twice)), "");
}

TEST(SavedMap, WhatMakesNoSenseIsRefused) {
  SavedMap map = some_map();
  map.keyframes[1].views[0].points[0].inverse_depth = -1.0;
  EXPECT_NE(refusal(to_bytes(map)), "");
  map = some_map();
  map.T_M_K[0].translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(to_bytes(map)), "");
  map = some_map();
  std::swap(map.keyframes[0], map.keyframes[2]);
  EXPECT_NE(refusal(to_bytes(map)), "");
}

TEST(SavedMap, FitsTheLensItWasMadeWith) {
  const SavedMap map = some_map();
  EXPECT_NO_THROW(check_fits(map, rig_with("frames", 201.0)));
  EXPECT_THROW(check_fits(map, rig_with("frames", 230.0)), InputError);
  EXPECT_THROW(check_fits(map, rig_with("cam7", 200.0)), InputError);
}

TEST(SavedMap, FitsACameraOnlyIfAKeyframeIsOfIt) {
  SavedMap map = some_map();
  EXPECT_NO_THROW(check_fits(map, rig_with("events", 205.0)));
  for (MapKeyframe& keyframe : map.keyframes) keyframe.views[0].camera = "frames";
  EXPECT_THROW(check_fits(map, rig_with("events", 205.0)), InputError);
  map.keyframes.clear();
  EXPECT_NO_THROW(check_fits(map, rig_with("events", 205.0)));
}

}  // namespace
}  // namespace edged
