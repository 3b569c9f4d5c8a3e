// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/odometry.hpp"

#include <memory>
#include <utility>

#include "edged/camera/output_frame.hpp"
#include "edged/pipeline/input/measurement_validator.hpp"
#include "edged/pipeline/input/packetizer.hpp"
#include "edged/pipeline/localization/localization.hpp"
#include "edged/pipeline/localization/state_prediction.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/pipeline/packet_step.hpp"
#include "edged/pipeline/vision/image_vision.hpp"

namespace edged {

struct Odometry::Impl {
  Impl(const Rig& rig, const ImuNoise& noise, Mode mode, const OdometryConfig& config, const FeedConfig& feed)
      : Impl(rig, used_cameras(rig, mode, config.cameras), noise, config, feed) {}
  Impl(const Rig& rig, const Rig& used, const ImuNoise& noise, const OdometryConfig& config, const FeedConfig& feed)
      : given(rig),
        validator(rig, used, feed.delays),
        new_packetizer([used, packets = config.packets](const PacketizerCounters& so_far) {
          return Packetizer(used, packets, so_far);
        }),
        packetizer(new_packetizer({})),
        localization(used, noise, config, timings, feed.keeps_measurements),
        vision(std::make_unique<ImageVision>(without_offsets(used), config, feed.inference, timings)) {}

  std::optional<Packet> next_packet();
  Step process(Packet packet);

  Rig given;
  MeasurementValidator validator;  // any thread's
  StatePrediction prediction;      // any thread's
  std::function<Packetizer(const PacketizerCounters& so_far)> new_packetizer;
  Packetizer packetizer;
  std::optional<Measurement> begins_epoch;  // held back until the packets of the time before are done
  bool finished = false;
  StageTimings timings;
  Localization localization;
  std::unique_ptr<Vision> vision;
};

std::optional<Packet> Odometry::Impl::next_packet() {
  const auto timer = timings.measure_often("packetize");
  while (true) {
    if (std::optional<Packet> packet = packetizer.next()) return packet;
    if (begins_epoch) {
      packetizer = new_packetizer(packetizer.counters());
      localization.begin_epoch();
      vision->begin_epoch();
      packetizer.add(*std::exchange(begins_epoch, std::nullopt));
    } else if (std::optional<MeasurementValidator::Item> item = validator.next(); item && item->begins_epoch) {
      packetizer.finish();
      begins_epoch = std::move(item->measurement);
    } else if (item) {
      packetizer.add(std::move(item->measurement));
    } else if (!finished && validator.ended()) {
      packetizer.finish();
      finished = true;
    } else {
      return std::nullopt;
    }
  }
}

Step Odometry::Impl::process(Packet packet) {
  const auto timer = timings.measure("process");
  Step step = process_packet(std::move(packet), localization, *vision);
  step.rig = rig_for_poses(given, localization.rig());
  return step;
}

Odometry::Odometry(const Rig& rig, const ImuNoise& imu_noise, Mode mode, const OdometryConfig& config,
                   const FeedConfig& feed)
    : impl_((config.validate(), imu_noise.validate(), std::make_unique<Impl>(rig, imu_noise, mode, config, feed))) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&& other) noexcept = default;
Odometry& Odometry::operator=(Odometry&& other) noexcept = default;

void Odometry::add(Measurement measurement) {
  // The prediction first: a step may end at the sample as soon as the intake has it.
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) impl_->prediction.add(*sample);
  impl_->validator.add(std::move(measurement));
}

void Odometry::finish() { impl_->validator.finish(); }

std::optional<Step> Odometry::next() {
  std::optional<Packet> packet = impl_->next_packet();
  if (!packet) return std::nullopt;
  Step step = impl_->process(std::move(*packet));
  impl_->prediction.correct(is_tracking(step.status) ? std::optional(step.state) : std::nullopt);
  return step;
}

std::optional<NavState> Odometry::newest_state() const { return impl_->prediction.newest(); }
std::optional<NavState> Odometry::state_at(Timestamp t) const { return impl_->prediction.at(t); }
void Odometry::load_map(std::string_view bytes) { impl_->localization.load_map(bytes); }
bool Odometry::awaiting_relocalization() const { return impl_->localization.awaiting_relocalization(); }
std::optional<std::string> Odometry::save_map() const { return impl_->localization.save_map(); }
FinalTrajectory Odometry::final_trajectory(const OptimizationProgress& progress) const {
  return impl_->localization.final_trajectory(progress);
}
Rig Odometry::rig() const { return impl_->localization.rig(); }
std::optional<CalibrationCovariance> Odometry::calibration_covariance(const std::string& camera) const {
  return impl_->localization.calibration_covariance(camera);
}
OdometryCounters Odometry::counters() const {
  return {impl_->validator.counters(), impl_->packetizer.counters(), impl_->localization.external_counters()};
}
const StageTimings& Odometry::timings() const { return impl_->timings; }

void drive(Odometry& odometry, const std::function<std::optional<Measurement>()>& source,
           const std::function<bool(Step)>& observe) {
  for (bool more = true; more;) {
    std::optional<Measurement> measurement = source();
    more = measurement.has_value();
    if (more) {
      odometry.add(std::move(*measurement));
    } else {
      odometry.finish();
    }
    while (std::optional<Step> step = odometry.next()) {
      if (!observe(std::move(*step))) return;
    }
  }
}

}  // namespace edged
