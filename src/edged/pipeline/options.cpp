// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// What a user may have reason to change; all else is for who works on the method.
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
    "alignment_gain",
    "event_tracker.detector.max_features",
    "event_tracker.klt.window_px",
    "event_tracker.sigma_px",
    "frame_tracker.detector.max_features",
    "frame_tracker.klt.window_px",
    "frame_tracker.sigma_px",
    "keyframes.parallax_deg",
    "keyframes.min_tracked_share",
    "depth.source",
    "depth.constant_m",
    "depth.network.model",
    "depth_factor.enabled",
    "depth_factor.form",
    "height.enabled",
    "height.sigma_m",
    "height.bias_walk",
    "velocity.enabled",
    "velocity.sigma_mps",
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
    "map.keyframes.max_keyframes",
    "status.degraded_after_s",
    "status.lost_after_s",
};

}  // namespace

OdometryConfig::OdometryConfig() {
  event_tracker.sigma_px = 1.5;      // the look of an event frame changes with the direction of motion,
  event_tracker.klt.window_px = 15;  // and in the dark, and in fast motion, it is noisy
  event_tracker.templates.patch.min_similarity = 0.7;
}

void OdometryConfig::visit(ConfigFields& fields) {
  fields.expert_but(kForEveryone, [&] { declare(fields); });
}

void OdometryConfig::declare(ConfigFields& fields) {
  fields.add(
      "cameras", cameras,
      {.effect = "names of the cameras to use, separated by commas, any number of a kind; empty: the first event "
                 "camera and the first frame camera, as the mode uses them"});
  fields.group("packets", packets);
  fields.group("event_frame", event_frame);
  fields.group("enhance", enhance);
  fields.add("enhance.detect", enhance_detect,
             {.effect = "find new features on the enhanced event frame, not the plain one"});
  fields.add("enhance.track", enhance_track,
             {.effect = "follow features on the enhanced event frame, not the plain one"});
  fields.add("alignment_gain", alignment.gain,
             {"", 0, 1,
              "weight of the last event frame's median (measured - predicted) displacement in the running mean "
              "that corrects the next prediction (delta x_last of Eq. 2); 0 is off"});
  fields.add("alignment_max_px", alignment.max_px, {"px", 0, 50, "bound of that correction"});
  fields.group("health", health);
  fields.group("low_light", low_light);
  fields.group("event_tracker", event_tracker);
  fields.group("frame_tracker", frame_tracker);
  fields.group("keyframes", keyframes);
  fields.group("depth", depth);
  fields.group("depth_factor", estimator.depth_factor);
  fields.group("height", estimator.height);
  fields.group("velocity", estimator.velocity);
  fields.group("estimator", estimator);
  fields.group("map", map);
  fields.group("status", status);
  fields.add("quiet_rate_per_pixel", quiet_rate_per_pixel,
             {"1/s", 0, 1000, "events per pixel and second below which nothing moves in view"});
  fields.add(
      "max_travel_px", max_travel_px,
      {"px", 0.5, 1000, "an event frame reaches back in time until the scene has moved this far by translation"});
  fields.add("thin_width_px", thin_width_px,
             {"px", 1, 1e6,
              "while frames carry enough features each n-th event is rendered, n the sensor's width over this, rounded "
              "down"});
  fields.add("min_events_per_pixel", min_events_per_pixel,
             {"", 0, 10, "a packet with fewer events draws no event frame"});
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
  if (enhance.method != EdgeMethod::None && !enhance_detect && !enhance_track) {
    throw InputError(
        "enhance.method with enhance.detect and enhance.track both off: nothing would use the enhanced frame; turn one "
        "on, or set enhance.method = none");
  }
}

}  // namespace edged
