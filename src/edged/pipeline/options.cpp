// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// Options for users; all others are for developers of the method.
constexpr std::string_view kForEveryone[] = {
    "cameras",
    "packets.events_per_pixel",
    "packets.window_per_pixel",
    "packets.max_interval_s",
    "packets.min_interval_s",
    "event_frame.interpolation",
    "event_frame.depth",
    "event_frame.blur_sigma_px",
    "enhance.method",
    "enhance.clahe_clip",
    "enhance.sharpening",
    "enhance.detect",
    "enhance.track",
    "alignment.gain",
    "tracker.detector.max_features",
    "tracker.events.klt.window_px",
    "tracker.events.sigma_px",
    "tracker.frames.klt.window_px",
    "tracker.frames.sigma_px",
    "keyframes.parallax_deg",
    "keyframes.min_tracked_share",
    "depth.source",
    "depth.constant_m",
    "depth.network.model",
    "estimator.depth_factor.enabled",
    "estimator.depth_factor.form",
    "height.enabled",
    "height.sigma_m",
    "height.bias_walk",
    "velocity.enabled",
    "velocity.sigma_mps",
    "velocity.scale_sigma",
    "velocity.position_m",
    "velocity.rotation_deg",
    "estimator.keyframes",
    "estimator.iterations",
    "estimator.noise_inflation",
    "estimator.sigma_inflation",
    "estimator.init_scale_sigma",
    "estimator.calibration.rotation_sigma_deg",
    "estimator.calibration.time_offset_sigma_ms",
    "estimator.calibration.imu_sigma",
    "estimator.landmarks.min_depth_m",
    "estimator.landmarks.max_depth_m",
    "estimator.landmarks.max_per_camera",
    "map.enabled",
    "map.localize_only",
    "map.keyframes.max_keyframes",
    "status.degraded_after_s",
    "status.lost_after_s",
};

/// Options of the tracker whose defaults differ: those of event frames are under tracker.events, of standard frames
/// under tracker.frames.
constexpr std::string_view kPerCameraKind[] = {"klt.window_px", "templates.min_similarity", "sigma_px"};

}  // namespace

void AlignmentConfig::visit(ConfigFields& fields) {
  fields.add("gain", gain,
             {"", 0, 1,
              "Weight of the newest event frame in the running mean of (measured - predicted) displacement (delta "
              "x_last of Eq. 2). 0: off."});
}

OdometryConfig::OdometryConfig() {
  event_tracker.sigma_px = 1.5;      // the appearance of an event frame changes with the direction of motion,
  event_tracker.klt.window_px = 15;  // and in the dark, and in fast motion, it is noisy
  event_tracker.reference_patches.patch.min_similarity = 0.7;
}

void OdometryConfig::visit(ConfigFields& fields) {
  fields.expert_but(kForEveryone, [&] { declare(fields); });
}

void OdometryConfig::declare(ConfigFields& fields) {
  fields.add(
      "cameras", cameras,
      {.effect = "Names of the cameras to use, separated by commas; `first`: the first event camera and the first "
                 "frame camera. Empty: the same, but `edged run` adds a second one of a kind whose view overlaps."});
  fields.group("packets", packets);
  fields.group("event_frame", event_frame);
  fields.group("enhance", enhance);
  fields.add("enhance.detect", enhance_detect, {.effect = "Detect features in the enhanced event frame."});
  fields.add("enhance.track", enhance_track, {.effect = "Track features in the enhanced event frame."});
  fields.group("alignment", alignment);
  fields.group("health", health);
  fields.group("low_light", low_light);
  fields.pair("tracker", "events", event_tracker, "frames", frame_tracker, kPerCameraKind);
  fields.group("stereo", stereo);
  fields.group("keyframes", keyframes);
  fields.group("depth", depth);
  fields.group("height", estimator.height);
  fields.group("velocity", estimator.velocity);
  fields.group("estimator", estimator);
  fields.group("map", map);
  fields.group("status", status);
  fields.add("min_events_per_pixel", min_events_per_pixel,
             {"", 0, 10, "A packet with fewer events per pixel makes no event frame."});
}

void OdometryConfig::validate() const {
  OdometryConfig copy = *this;
  const ConfigFields fields = ConfigFields::of(copy);  // refuses what is out of its range
  estimator.velocity.T_B_S();
  enhance.validate([&fields](std::string_view name) {
    const std::string key = "enhance." + std::string(name);
    return std::ranges::find_if(fields.all(), [&key](const ConfigField& field) { return field.key.ends_with(key); })
        ->key;
  });
  if (map.localize_only && !map.enabled)
    throw InputError("map.localize_only with map.enabled off: there would never be a pose; change one of them");
  if (enhance.method != EdgeMethod::None && !enhance_detect && !enhance_track) {
    throw InputError(
        "enhance.method with enhance.detect and enhance.track both off: nothing would use the enhanced frame; turn one "
        "on, or set enhance.method = none");
  }
}

}  // namespace edged
