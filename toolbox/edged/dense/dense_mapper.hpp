// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Semi-dense depth by temporal stereo: which images are references, which of the others they are compared with, and
// the points of all.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/dense/depth_map.hpp"
#include "edged/dense/rectifier.hpp"
#include "edged/dense/refined_poses.hpp"

namespace edged {

/// An image as its camera gave it.
struct DenseImage {
  std::string camera;
  Modality modality = Modality::Frames;
  CameraModel model;  ///< model of the image
  SE3 T_B_C;
  cv::Mat image;  ///< CV_8UC1
};

/// What one packet shows.
struct DenseInstant {
  Timestamp t;            ///< IMU clock
  bool restart = false;   ///< the odometry frame O is not that of the instants before
  bool keyframe = false;  ///< its images may become references
  SE3 T_O_B;
  Trajectory refined = {};                        ///< T_O_B of earlier keyframes that are marginalized now
  double scene_depth = 0.0;                       ///< [m]
  std::vector<Eigen::Vector3d> landmarks_O = {};  ///< landmarks of keyframes
  std::vector<DenseImage> images = {};
};

/// Limits for the cameras of one modality.
struct DenseModality {
  std::size_t views;      ///< a reference is compared with so many
  double least_flow_cos;  ///< cosine of the angle between the image motions of a view and of its reference
  EdgeConfig edges;
  SearchConfig search;
};

/// Distances are shares of the depth of the scene.
struct DenseConfig {
  DenseModality frames{8, -1.0, {}, {}};
  /// Noisy, and edges lie behind their true place, against the image motion.
  DenseModality events{10,
                       0.8,
                       {.sigma_px = 1.2, .least_strength = 33.0F},
                       {.patch_scale = 1.5,
                        .first_views = 10,
                        .most_first_cost = 0.5F,
                        .least_correlation = 0.6F,
                        .least_sigma_px = 0.4,
                        .most_sigma = 0.03,
                        .least_views = 4}};
  CullConfig cull;
  int widest_px = 400;          ///< wider images are binned: a pixel of half the width costs a fifth
  double view_spacing = 0.015;  ///< between kept views
  double least_baseline = 0.05, most_baseline = 0.5;
  double reference_spacing = 0.12;      ///< between references
  double reference_turn_rad = 0.2;      ///< or so much rotation
  double most_turn_rad = 0.5;           ///< rotation of a view against its reference
  double most_wait_s = 2.0;             ///< how long a reference waits for the views after it
  double most_delay_s = 6.0;            ///< how long an image waits for the refined poses of the keyframes around it
  std::size_t kept_views = 40;          ///< views of each modality
  std::size_t fused_keyframes = 4;      ///< the latest ones before a keyframe
  std::size_t most_points = 4'000'000;  ///< beyond that every second one is dropped
};

struct DenseCounters {
  std::size_t keyframes = 0;   ///< with depth
  std::size_t unmeasured = 0;  ///< keyframes without parallax
  std::size_t edges = 0;       ///< edge pixels of the first
  std::size_t with_depth = 0;  ///< pixels with depth after culling, before fusion
};

/// Deterministic, single-threaded. Memory: some seconds of views, and 16 bytes a point up to a maximum.
class DenseMapper {
 public:
  explicit DenseMapper(const DenseConfig& config = {}) : config_(config) {}

  /// In order of time.
  void add(DenseInstant instant);
  /// No more will come: the last references do without views after them.
  void finish();

  /// Complete after finish().
  const std::vector<DepthMap>& maps() const { return maps_; }
  const DenseCounters& counters() const { return counters_; }

 private:
  struct Camera {
    CameraModel given;
    int bin = 1;
    CameraModel lens;  // given, binned
    CameraModel pinhole;
    std::optional<Rectifier> rectifier;  // none for a pinhole
  };
  struct Reference {
    DenseView view;
    InverseDepthRange range;  // of its scene
    double depth;             // the same, median
  };
  /// The views of one modality.
  struct Views {
    const DenseModality& config;
    std::optional<SE3> last_kept;  // T_O_B
    std::deque<DenseView> all = {};
    std::deque<Reference> waiting = {};
    std::optional<SE3> last_reference = {};  // T_O_C
    std::vector<std::size_t> latest = {};    // indices of maps
  };

  bool keep(const DenseInstant& instant, Modality modality, Views& views) const;
  void release(DenseInstant instant);
  void add_image(const DenseInstant& instant, const DenseImage& image, bool first, Views& views);
  DenseView view_of(const DenseInstant& instant, const DenseImage& image, const EdgeConfig& edges);
  bool is_complete(const Reference& reference, const Views& views, Timestamp now) const;
  std::vector<const DenseView*> views_for(const Reference& reference, const Views& views) const;
  void measure(const Reference& reference, Views& views);
  void thin_out();

  DenseConfig config_;
  RefinedPoses poses_;
  std::deque<DenseInstant> delayed_;
  std::map<std::string, Camera> cameras_;
  std::map<Modality, Views> views_;
  std::vector<DepthMap> maps_;
  DenseCounters counters_;
  std::size_t points_ = 0;
};

}  // namespace edged
