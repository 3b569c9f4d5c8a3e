// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The rotations of a camera, from its images alone.
#pragma once

#include <deque>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "edged/frontend/trackers/klt_tracker.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"

namespace edged {

/// The rotation of a camera between two instants of its clock.
struct Turn {
  Timestamp begin, end;
  Eigen::Vector3d phi_C = Eigen::Vector3d::Zero();  ///< R_W_C(end) = R_W_C(begin) * Exp(phi_C) [rad]
  /// Unit vectors to each corner at begin and at end.
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> rays = {};
};

/// Slower turns say little about the mounting of a camera [rad/s].
inline constexpr double kLeastTurningRate = 0.15;
/// How long a camera turns faster than that, in the turns from `first` on; each instant is counted once.
Duration turning_time(std::span<const Turn> turns, std::size_t first = 0);

/// Rotation between two views of the same points, for any translation of the camera: p_begin ~ R * (p_end - t). Points
/// lie on the unit plane. Nothing with too few points. (Kneip and Lynen, Direct Optimization of
/// Frame-to-Frame Rotation, ICCV 2013; as in OpenGV.)
std::optional<Eigen::Matrix3d> rotation_between(std::span<const Eigen::Vector2d> begin,
                                                std::span<const Eigen::Vector2d> end);

/// Tracks corners in standard frames, or in images of the newest events, at most 640 px wide: of a wider sensor 2 x 2
/// or more pixels are one.
class VisualTurns {
 public:
  /// corners: largest number of tracks; fewer are cheaper and less accurate.
  explicit VisualTurns(const RigCamera& camera, int corners = DetectorConfig().max_features);

  /// Adds a measurement. Those of other cameras are ignored.
  void add(const Measurement& measurement);
  const std::vector<Turn>& turns() const { return turns_; }

 private:
  /// The corners of one image, by id.
  struct View {
    Timestamp t;
    std::map<FeatureId, Eigen::Vector2d> points;
  };

  void add_events(std::span<const Event> events);
  void add_image(const cv::Mat& image, Timestamp t);
  void add_turn(const View& view);

  Modality modality_;
  int octaves_;  ///< by which images of events are binned
  KltTracker tracker_;
  FeatureId next_id_ = 1;
  std::deque<View> views_;  ///< the newest ones
  std::vector<Turn> turns_;
  cv::Mat event_image_;  ///< image of the events since the previous one; its stamp is the middle of their stamps
  std::optional<Timestamp> image_begin_;
  std::size_t events_ = 0, events_per_image_;
};

}  // namespace edged
