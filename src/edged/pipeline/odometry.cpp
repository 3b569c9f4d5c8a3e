// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/odometry.hpp"

#include <utility>

#include "edged/pipeline/input/measurement_validator.hpp"
#include "edged/pipeline/input/packetizer.hpp"
#include "edged/pipeline/localization/state_prediction.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/pipeline/packet_odometry.hpp"

namespace edged {

struct Odometry::Impl {
  Impl(const Rig& rig, const ImuNoise& noise, Mode mode, const OdometryConfig& config, const FeedConfig& feed)
      : Impl(rig, used_cameras(rig, mode, config.cameras), noise, config, feed) {}
  Impl(const Rig& rig, const Rig& used, const ImuNoise& noise, const OdometryConfig& config, const FeedConfig& feed)
      : intake(rig, used, feed.delays),
        new_packetizer([used, packets = config.packets](const PacketizerCounters& so_far) {
          return Packetizer(used, packets, so_far);
        }),
        packetizer(new_packetizer({})),
        packet_odometry(used, noise, config, feed.inference) {}

  std::optional<Packet> next_packet();

  Intake intake;               // any thread's
  StatePrediction prediction;  // any thread's
  std::function<Packetizer(const PacketizerCounters& so_far)> new_packetizer;
  Packetizer packetizer;
  std::optional<Measurement> begins_time;  // held back until the packets of the time before are done
  PacketOdometry packet_odometry;
  bool finished = false;
};

std::optional<Packet> Odometry::Impl::next_packet() {
  const auto timer = packet_odometry.timings().measure_often("packetize");
  while (true) {
    if (std::optional<Packet> packet = packetizer.next()) return packet;
    if (begins_time) {
      packetizer = new_packetizer(packetizer.counters());
      packet_odometry.begin_time();
      packetizer.add(*std::exchange(begins_time, std::nullopt));
    } else if (std::optional<Intake::Item> item = intake.next(); item && item->begins_time) {
      packetizer.finish();
      begins_time = std::move(item->measurement);
    } else if (item) {
      packetizer.add(std::move(item->measurement));
    } else if (!finished && intake.ended()) {
      packetizer.finish();
      finished = true;
    } else {
      return std::nullopt;
    }
  }
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
  impl_->intake.add(std::move(measurement));
}

void Odometry::finish() { impl_->intake.finish(); }

std::optional<Step> Odometry::next() {
  std::optional<Packet> packet = impl_->next_packet();
  if (!packet) return std::nullopt;
  PacketOdometry& packet_odometry = impl_->packet_odometry;
  const auto timer = packet_odometry.timings().measure("process");
  Step step = packet_odometry.process(std::move(*packet));
  impl_->prediction.correct(is_tracking(step.status) ? std::optional(step.state) : std::nullopt);
  return step;
}

std::optional<NavState> Odometry::newest_state() const { return impl_->prediction.newest(); }
std::optional<NavState> Odometry::state_at(Timestamp t) const { return impl_->prediction.at(t); }
void Odometry::load_map(std::string_view bytes) { impl_->packet_odometry.localization().load_map(bytes); }
bool Odometry::awaiting_relocalization() const {
  return impl_->packet_odometry.localization().awaiting_relocalization();
}
std::optional<std::string> Odometry::save_map() const { return impl_->packet_odometry.localization().save_map(); }
FinalTrajectory Odometry::final_trajectory() const { return impl_->packet_odometry.localization().final_trajectory(); }
Rig Odometry::rig() const { return impl_->packet_odometry.localization().rig(); }
std::optional<CalibrationCovariance> Odometry::calibration_covariance(const std::string& camera) const {
  return impl_->packet_odometry.localization().calibration_covariance(camera);
}
OdometryCounters Odometry::counters() const {
  return {impl_->intake.counters(), impl_->packetizer.counters(),
          impl_->packet_odometry.localization().external_counters()};
}
const StageTimings& Odometry::timings() const { return impl_->packet_odometry.timings(); }

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
