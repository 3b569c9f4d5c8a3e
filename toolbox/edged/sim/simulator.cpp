// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <string_view>
#include <utility>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/motion/motion.hpp"
#include "edged/sim/scene/scene.hpp"
#include "edged/sim/sensors/event_camera.hpp"
#include "edged/sim/sensors/external_model.hpp"
#include "edged/sim/sensors/frame_camera.hpp"
#include "edged/sim/sensors/imu_model.hpp"
#include "edged/sim/sensors/renderer.hpp"

namespace edged {
namespace {

constexpr Timestamp kForever = Timestamp::max();
constexpr Duration kMicrosecond(1000);
constexpr Duration kLongestBatch = std::chrono::milliseconds(5);
// Longest time between renders, so that slow changes (leak, bandwidth, onset of motion) are not missed.
constexpr double kLongestStep_s = 3e-3;

SimulatorConfig checked(SimulatorConfig config) {
  Disturbance& disturbance = config.disturbance;
  disturbance = disturbance.filled_in(config.duration_s);
  if (disturbance.kind != DisturbanceKind::None && disturbance.end_s() > config.duration_s)
    throw InputError::format(
        "option 'disturbance.length_s': the disturbance ends at {} s, but the recording at {} s; raise duration_s",
        disturbance.end_s(), config.duration_s);
  if (disturbance.kind == DisturbanceKind::BlankWall && config.scene.kind != SceneKind::Boxes)
    throw InputError("option 'disturbance.kind': blank-wall needs a room; set scene.kind to boxes");
  if (disturbance.kind == DisturbanceKind::Flicker && disturbance.strength > 1.0)
    throw InputError::format("option 'disturbance.strength': a modulation of {} is above 1", disturbance.strength);
  const FrameCameraConfig& frames = config.frames;
  const auto check = [&frames](const char* key, double exposure_ms) {
    if (exposure_ms * 1e-3 >= 1.0 / frames.rate_hz)
      throw InputError::format("option 'frames.{}' is {}, but frames come every {} ms; lower it or frames.rate_hz", key,
                               exposure_ms, 1e3 / frames.rate_hz);
  };
  check("exposure_ms", frames.exposure_ms);
  if (frames.auto_exposure) check("max_exposure_ms", frames.max_exposure_ms);
  return config;
}

std::vector<SE3> camera_path(const DisturbedTrajectory& trajectory, const SimulatorConfig& config) {
  std::vector<SE3> path;
  for (double t = 0.0; t <= config.duration_s; t += 0.02) path.push_back(trajectory.at(t).T_W_B * config.T_B_C);
  return path;
}

Scene scene_of(const DisturbedTrajectory& trajectory, const SimulatorConfig& config) {
  return make_scene(config.scene, camera_path(trajectory, config), static_cast<std::uint64_t>(config.seed),
                    config.disturbance, trajectory.at(config.disturbance.middle_s()).T_W_B * config.T_B_C,
                    config.flicker);
}

/// Rotations of the disturbance are about the y axis of the camera, which points down.
DisturbedTrajectory trajectory_of(const SimulatorConfig& config) {
  return {make_motion(config.motion, config.duration_s, config.T_B_C, static_cast<std::uint64_t>(config.seed)),
          config.disturbance, config.imu.gyro_range, config.T_B_C.R().col(1)};
}

Timestamp whole_microseconds(double s) {
  return timestamp_from_ns(static_cast<std::int64_t>(std::llround(s * 1e6)) * 1000);
}

/// An even number of microseconds, so that the middle is a whole number of them.
Duration exposure_of(double ms) { return whole_microseconds(ms * 1e-3).time_since_epoch() / 2000 * 2000; }

std::uint64_t noise_seed(const SimulatorConfig& config) {
  return static_cast<std::uint64_t>(config.seed) + (config.mount.suffix.empty() ? 0 : 0x9e3779b97f4a7c15U);
}

/// What lens models have beside the focal lengths and the centre.
struct Coefficient {
  std::string_view name;
  double SimulatedCameraConfig::*value;
  FieldDoc doc;
};

using Camera = SimulatedCameraConfig;
constexpr Coefficient kCoefficients[] = {
    {"k1", &Camera::k1, {"", -10, 10, "radial distortion"}},
    {"k2", &Camera::k2, {"", -10, 10, "radial distortion"}},
    {"p1", &Camera::p1, {"", -1, 1, "tangential distortion"}},
    {"p2", &Camera::p2, {"", -1, 1, "tangential distortion"}},
    {"k3", &Camera::k3, {"", -10, 10, "radial distortion"}},
    {"k4", &Camera::k4, {"", -10, 10, "radial distortion"}},
    {"k5", &Camera::k5, {"", -10, 10, "radial distortion"}},
    {"k6", &Camera::k6, {"", -10, 10, "radial distortion"}},
    {"xi", &Camera::xi, {"", -1, 10, "of ds and omni: distance from the centre of the sphere"}},
    {"alpha", &Camera::alpha, {"", 0, 1, "of ds and eucm: weight of the sphere against the plane"}},
    {"beta", &Camera::beta, {"", 0.01, 100, "of eucm: shape of the ellipsoid"}},
    {"w", &Camera::w, {"rad", 0, 3.1, "of fov: angle of view of an ideal lens of that kind"}}};

}  // namespace

void SimulatedCameraConfig::visit(ConfigFields& fields) {
  fields.add("width", width, {"px", 16, 4096, "columns"});
  fields.add("height", height, {"px", 16, 4096, "rows"});
  fields.add("fx", fx, {"px", 1, 1e5, "focal length"});
  fields.add("fy", fy, {"px", 1, 1e5, "focal length"});
  fields.add("cx", cx, {"px", 0, 4096, "principal point"});
  fields.add("cy", cy, {"px", 0, 4096, "principal point"});
  std::vector<std::pair<std::string_view, DistortionModel>> lenses;
  for (const LensModel& lens : lens_models())
    if (lens.max_coefficients > 0) lenses.emplace_back(lens.name, lens.model);
  fields.choice("distortion", distortion, lenses,
                {.effect = "the model of the lens: it takes the coefficients below that it has"});
  for (const Coefficient& k : kCoefficients) fields.add(k.name, this->*k.value, k.doc);
  fields.add("residual_px", residual_px,
             {"px", 0, 5, "rms of a smooth error of the lens that its calibration does not have"});
  fields.add("flare", flare,
             {"", 0, 1,
              "share of the light of lamps in view that the lens scatters over the image, and as much that it "
              "mirrors about its centre"});
}

double SimulatedCameraConfig::coefficient(std::string_view name) const {
  const auto* const found = std::ranges::find(kCoefficients, name, &Coefficient::name);
  EDGED_CHECK(found != std::end(kCoefficients), "the simulator has no coefficient {}", name);
  return this->*found->value;
}

CameraModel SimulatedCameraConfig::model() const {
  LensCoefficients k{};
  std::size_t count = 0;
  for (const std::string_view name : coefficient_names(lens_model(distortion))) k.at(count++) = coefficient(name);
  return {width, height, fx, fy, cx, cy, distortion, k};
}

void SimulatorConfig::visit(ConfigFields& fields) {
  fields.add("seed", seed, {"", 0, 2147483647, "same seed, same bits; motion, scene and noise all follow from it"});
  fields.add("duration_s", duration_s, {"s", 0.1, 3600, "length of the recording, the rest at its start included"});
  fields.add("max_motion_px", max_motion_px,
             {"px", 0.05, 5, "image motion between renders; the cost grows with its inverse"});
  fields.group("motion", motion);
  fields.group("scene", scene);
  fields.group("camera", camera);
  fields.group("events", events);
  fields.group("frames", frames);
  fields.group("imu", imu);
  fields.group("height", external.height);
  fields.group("velocity", external.velocity);
  fields.group("disturbance", disturbance);
  fields.group("flicker", flicker);
}

SE3 SimulatorConfig::davis240c_extrinsics() {
  Eigen::Matrix3d R;
  R << 0.999905117, -0.012237498, 0.006324569, 0.012178017, 0.999882045, 0.009359045, -0.006438354, -0.009281136,
      0.999936202;
  return {R, Eigen::Vector3d(0.006746964, 0.000727922, 0.034257361)};
}

class Simulator::Impl {
 public:
  explicit Impl(const SimulatorConfig& config);

  const DatasetInfo& info() const { return info_; }
  std::optional<Measurement> next();
  void leave_out(Modality unwanted) { wants_events_ &= unwanted != Modality::Events; }
  std::optional<GroundTruth> ground_truth() const;
  Calibration calibration() const;
  const DisturbedTrajectory& trajectory() const { return trajectory_; }
  std::size_t renderings() const { return renderings_; }
  Timestamp rendered_until() const { return t_.value_or(Timestamp()); }
  const Scene& scene() const { return renderer_.scene(); }

 private:
  void advance();
  Timestamp next_render_time() const;
  void prepare_imu();
  /// The external sensor with the next sample; null without any.
  ExternalModel* next_external();
  void collect_light(Timestamp from, Timestamp to);
  /// Rate of additional events per pixel until the next picture.
  double storm_hz() const;
  /// Begin and middle of the next exposure.
  Timestamp exposure_begin() const;
  Timestamp exposure_middle() const { return exposure_begin() + exposure_ / 2; }
  EventBatch take_events(Timestamp before);
  double image_speed(Timestamp t) const;
  bool disturbed(DisturbanceKind by, Timestamp t) const { return config_.disturbance.is(by, to_seconds(t)); }
  Kinematics truth(Timestamp t) const { return trajectory_.at(to_seconds(t)); }

  SimulatorConfig config_;
  DatasetInfo info_;
  DisturbedTrajectory trajectory_;
  Renderer renderer_;
  EventCamera event_camera_;
  FrameCamera frame_camera_;
  ImuModel imu_model_;
  std::vector<ExternalModel> external_models_;
  Duration time_offset_, exposure_;  // exposure_: of the next frame
  Timestamp end_;                    // of the cameras
  std::optional<Timestamp> t_;       // rendered up to here
  int frame_count_ = 0;              // read out so far
  std::int64_t imu_count_ = 0;
  std::vector<float> radiance_, previous_;  // input of the sensors: the last rendered image and the one before
  std::deque<Event> events_;                // rendered but not yet returned; frames_, too
  std::deque<Frame> frames_;
  std::optional<ImuSample> imu_;  // the next one
  std::size_t renderings_ = 0;
  bool wants_events_ = true;
};

Simulator::Impl::Impl(const SimulatorConfig& config)
    : config_(checked(config)),
      trajectory_(trajectory_of(config_)),
      renderer_(config.camera.model(), scene_of(trajectory_, config_),
                LensResidual(config.camera.residual_px, config.camera.width, noise_seed(config)), config.camera.flare),
      event_camera_(config.events, config.camera.width, config.camera.height, noise_seed(config)),
      frame_camera_(config.frames, config.camera.width, config.camera.height, noise_seed(config)),
      imu_model_(config.imu, static_cast<std::uint64_t>(config.seed)),
      time_offset_(duration_from_seconds(config.imu.time_offset_ms * 1e-3)),
      exposure_(exposure_of(config.frames.exposure_ms)),
      end_(whole_microseconds(config.duration_s)) {
  info_.name = config.name;
  info_.format = "simulator";
  info_.begin = Timestamp() + std::min(Duration(0), time_offset_);
  info_.end = end_ + std::max(Duration(0), time_offset_);
  info_.has_events = info_.has_frames = info_.has_imu = true;
  info_.event_camera += config.mount.suffix;
  info_.frame_camera += config.mount.suffix;
  info_.event_sensor = cv::Size(config.camera.width, config.camera.height);
  for (std::size_t i = 0; i < kExternalSensors; ++i) {
    ExternalModel model(config.external, i, static_cast<std::uint64_t>(config.seed), time_offset_);
    if (!model.peek(trajectory_, config.duration_s)) continue;
    info_.external.emplace_back(external_sensors()[i].name);
    external_models_.push_back(std::move(model));
  }
}

std::optional<GroundTruth> Simulator::Impl::ground_truth() const {
  GroundTruth truth_body;
  for (Timestamp t; t <= end_; t += std::chrono::milliseconds(5))
    truth_body.trajectory.push_back({t + time_offset_, truth(t).T_W_B});
  return truth_body;
}

Calibration Simulator::Impl::calibration() const {
  const RigCamera events{"events" + config_.mount.suffix, Modality::Events, config_.camera.model(), config_.T_B_M(),
                         time_offset_};
  RigCamera frames = events;
  frames.name = "frames" + config_.mount.suffix, frames.modality = Modality::Frames;
  Calibration calibration;
  calibration.rig = {"simulator", {events, frames}};
  calibration.imu = config_.imu.noise();
  return calibration;
}

std::optional<Measurement> Simulator::Impl::next() {
  for (;;) {
    prepare_imu();
    // All that is stamped before `complete` has been rendered: a frame appears after the events of its second half.
    const bool finished = t_ && *t_ >= end_;
    const Timestamp complete = finished ? kForever : (t_ ? std::min(*t_, exposure_middle()) : Timestamp::min());
    const Timestamp imu = imu_ ? imu_->t : kForever;
    ExternalModel* const sensor = next_external();
    const Timestamp external = sensor ? time_of(*sensor->peek(trajectory_, config_.duration_s)) : kForever;
    const Timestamp event = events_.empty() ? kForever : events_.front().t;
    const Timestamp frame = frames_.empty() ? kForever : frames_.front().t;
    const Timestamp first = std::min({external, imu, event, frame});
    if (first == kForever && finished) return std::nullopt;
    if (first >= complete) {
      advance();
    } else if (external == first) {
      return sensor->pop();
    } else if (imu == first) {
      return *std::exchange(imu_, std::nullopt);
    } else if (event == first) {
      const Timestamp after_frame = frame == kForever ? kForever : frame + Duration(1);
      return take_events(std::min({external, imu, after_frame, complete, event + kLongestBatch}));
    } else {
      Frame taken = std::move(frames_.front());
      frames_.pop_front();
      return taken;
    }
  }
}

EventBatch Simulator::Impl::take_events(Timestamp before) {
  EventBatch batch{"events" + config_.mount.suffix, {}};
  while (!events_.empty() && events_.front().t < before) {
    batch.events.push_back(events_.front());
    events_.pop_front();
  }
  return batch;
}

void Simulator::Impl::prepare_imu() {
  while (!imu_) {
    // Sample k is taken at k / rate on the camera's clock; one beyond the end lets users interpolate there.
    const double t_cam_s = static_cast<double>(imu_count_) / config_.imu.rate_hz;
    if (t_cam_s >= to_seconds(end_) + 1.0 / config_.imu.rate_hz) return;
    imu_ = imu_model_.measure(timestamp_from_seconds(t_cam_s) + time_offset_, trajectory_.at(t_cam_s));
    if (config_.disturbance.is(DisturbanceKind::ImuGap, t_cam_s)) imu_.reset();
    ++imu_count_;
  }
}

ExternalModel* Simulator::Impl::next_external() {
  ExternalModel* first = nullptr;
  Timestamp t = kForever;
  for (ExternalModel& model : external_models_) {
    const std::optional<ExternalSample>& sample = model.peek(trajectory_, config_.duration_s);
    if (!sample || time_of(*sample) >= t) continue;
    first = &model;
    t = time_of(*sample);
  }
  return first;
}

Timestamp Simulator::Impl::exposure_begin() const {
  return whole_microseconds((frame_count_ + 0.1) / config_.frames.rate_hz);
}

double Simulator::Impl::image_speed(Timestamp t) const {
  const Kinematics k = truth(t);
  const Eigen::Vector3d v_B = k.T_W_B.rotation().conjugate() * k.v_W + k.omega_B.cross(config_.T_B_M().translation());
  const Eigen::Quaterniond R_C_B = config_.T_B_M().rotation().conjugate();
  return renderer_.max_image_speed(R_C_B * v_B, R_C_B * k.omega_B);
}

Timestamp Simulator::Impl::next_render_time() const {
  if (!wants_events_ && *t_ < exposure_begin()) return std::min(exposure_begin(), end_);
  // A margin of a tenth for the motion between the evaluated pixels.
  const double reach = 0.9 * config_.max_motion_px;
  const double speed = std::max(image_speed(*t_), 1e-3);
  double step = std::min(kLongestStep_s, reach / speed);
  step = std::min(step, reach / std::max(image_speed(*t_ + duration_from_seconds(step)), 1e-3));
  Timestamp t = *t_ + std::max(kMicrosecond, whole_microseconds(step).time_since_epoch());
  const Timestamp begin = exposure_begin(), stop = begin + exposure_;
  if (*t_ < begin) t = std::min(t, begin);
  if (*t_ < stop) t = std::min(t, stop);
  if (const auto& flicker = renderer_.scene().flicker)
    t = std::min(t, std::max(*t_ + kMicrosecond, whole_microseconds(flicker->next_knot_s(to_seconds(*t_)))));
  return std::min(t, end_);
}

void Simulator::Impl::advance() {
  const Timestamp t = t_ ? next_render_time() : Timestamp();
  previous_.swap(radiance_);
  radiance_ = renderer_.render(truth(t).T_W_B * config_.T_B_M(), to_seconds(t)).radiance;
  ++renderings_;
  const float light = static_cast<float>(config_.disturbance.light(to_seconds(t)));
  if (light != 1.0F)
    for (float& radiance : radiance_) radiance *= light;
  if (wants_events_)
    for (const Event& event : event_camera_.update(t, radiance_, storm_hz()))
      if (!disturbed(DisturbanceKind::EventsMissing, event.t)) events_.push_back(event);
  if (t_) collect_light(*t_, t);
  t_ = t;
}

double Simulator::Impl::storm_hz() const {
  if (!t_ || !disturbed(DisturbanceKind::EventStorm, *t_)) return 0.0;
  return 1e6 * config_.disturbance.strength / static_cast<double>(renderer_.width() * renderer_.height());
}

void Simulator::Impl::collect_light(Timestamp from, Timestamp to) {
  if (from < exposure_begin()) return;
  // Both ends of each exposure are rendered, so that an interval is inside or outside an exposure.
  frame_camera_.expose(previous_, radiance_, to_seconds(to - from));
  if (to < exposure_begin() + exposure_) return;
  Frame frame{exposure_middle(), "frames" + config_.mount.suffix, frame_camera_.read_out()};
  if (!disturbed(DisturbanceKind::FramesMissing, frame.t)) frames_.push_back(std::move(frame));
  ++frame_count_;
  exposure_ = exposure_of(frame_camera_.exposure_ms());
}

Simulator::Simulator(const SimulatorConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Simulator::Simulator(Simulator&& other) noexcept = default;
Simulator& Simulator::operator=(Simulator&& other) noexcept = default;
Simulator::~Simulator() = default;

const DatasetInfo& Simulator::info() const { return impl_->info(); }
std::optional<Measurement> Simulator::next() { return impl_->next(); }
void Simulator::leave_out(Modality unwanted) { impl_->leave_out(unwanted); }
std::optional<GroundTruth> Simulator::ground_truth() const { return impl_->ground_truth(); }
Calibration Simulator::calibration() const { return impl_->calibration(); }
const DisturbedTrajectory& Simulator::trajectory() const { return impl_->trajectory(); }
std::size_t Simulator::renderings() const { return impl_->renderings(); }
Timestamp Simulator::rendered_until() const { return impl_->rendered_until(); }
const Scene& Simulator::scene() const { return impl_->scene(); }

}  // namespace edged
