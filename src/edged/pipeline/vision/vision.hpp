// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The seam between vision and localization: from a packet and the body's predicted motion to images and observations of
// features, and back. Independent of the estimator.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/depth/depth_prior.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/pipeline/localization/imu_propagator.hpp"
#include "edged/pipeline/vision/event_view.hpp"
#include "edged/pipeline/vision/tracked_image.hpp"
#include "edged/rig.hpp"
#include "edged/step.hpp"

namespace edged {

struct VisionInput {
  const Packet& packet;
  const ImuPropagator& body;  ///< as predicted, up to the packet
  bool gyro_trusted = true;   ///< since the packet before
};

struct VisionOutput {
  double scene_depth = 0.0;                      ///< z-depth [m] used by the warp
  std::vector<EventImage> event_images;          ///< one per event camera, empty if there were too few events
  std::vector<TrackedImage> images;              ///< one per camera of the run
  std::vector<CameraObservations> observations;  ///< one per camera with an image in the packet
  bool keyframe = false;                         ///< the packet should become a keyframe, and vision has made it one
  bool events_static = false;                    ///< the view of every event camera is static
  std::optional<RegionDepth> depth;              ///< for Eq. 5
};

/// z-depths of landmarks in each camera at the newest state [m].
using LandmarkDepths = std::vector<std::map<FeatureId, double>>;

/// The feedback of localization.
struct VisionCorrection {
  std::vector<FeatureId> outliers;          ///< outlier tracks, which should end
  std::optional<LandmarkDepths> landmarks;  ///< nothing without an estimate; then all below is unset, too
  std::vector<RigCamera> cameras = {};      ///< as calibrated
  std::optional<SE3> T_new_old = {};        ///< from the old odometry frame to the new one, where the estimator started
  bool ended = false;                       ///< the estimate has ended with this packet
  bool provisional = true;                  ///< no estimate, or one whose scale is not certain yet
};

/// What localization needs of the cameras. A cycle is process, then correct. Localization itself takes the values: a
/// list of VisionOutput tests it without images.
class Vision {
 public:
  virtual ~Vision() = default;

  virtual VisionOutput process(const VisionInput& input) = 0;
  /// body: as estimated, at the time of the packet.
  virtual void correct(const VisionCorrection& correction, const ImuPropagator& body) = 0;
  /// A clock was set back and a new time begins: tracks end.
  virtual void begin_epoch() = 0;

  /// For observers; output: of that packet.
  virtual std::vector<CameraStep> describe(Packet packet, const VisionOutput& output) const = 0;
};

}  // namespace edged
