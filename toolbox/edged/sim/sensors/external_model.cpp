// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/external_model.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace edged {
namespace {

constexpr std::uint64_t kFirstExternalStream = 20;  // one stream per sensor, from this number on

const ExternalErrors& errors_of(const ExternalModelConfig& config, std::size_t index) {
  return index == 0 ? config.height.errors : config.velocity.errors;
}

}  // namespace

void ExternalErrors::visit(ConfigFields& fields, const char* unit) {
  fields.add("rate_hz", rate_hz, {"Hz", 0, 1000, "samples per second; 0: there is no such sensor"});
  fields.add("noise", noise, {unit, 0, 100, "standard deviation of a sample, stated in it"});
  fields.add("walk", walk,
             {unit, 0, 100, "random walk of its offset, per square root of a second; not stated in its samples"});
  fields.add("scale_error", scale_error, {"1", -0.9, 9, "reads 1 + this times the truth"});
  fields.add("outlier_share", outlier_share, {"1", 0, 1, "share of the samples that are wrong"});
  fields.add("outlier", outlier, {unit, 0, 1000, "standard deviation of these"});
  fields.add("gap_at_s", gap_at_s, {"s", 0, 3600, "when samples begin to be missing, on the camera's clock"});
  fields.add("gap_s", gap_s, {"s", 0, 3600, "for how long"});
  fields.add("late_ms", late_ms, {"ms", 0, 5000, "delay of the stamps after the measurement"});
}

void HeightModelConfig::visit(ConfigFields& fields) {
  errors.visit(fields, "m");
  fields.add("zero_m", zero_m, {"m", -1e4, 1e4, "reads this at the height of the origin"});
}

void VelocityModelConfig::visit(ConfigFields& fields) {
  errors.visit(fields, "m/s");
  fields.add("x_m", p_B_S.x(), {"m", -10, 10, "where it sits in the body"});
  fields.add("y_m", p_B_S.y(), {"m", -10, 10, "where it sits in the body"});
  fields.add("z_m", p_B_S.z(), {"m", -10, 10, "where it sits in the body"});
}

ExternalModel::ExternalModel(const ExternalModelConfig& config, std::size_t index, std::uint64_t seed, Duration shift)
    : config_(config),
      index_(index),
      errors_(errors_of(config, index)),
      shift_(shift + duration_from_seconds(1e-3 * errors_.late_ms)),
      random_(seed, kFirstExternalStream + index) {}

/// The stamps lie between those of the IMU, as those of an unsynchronised sensor.
double ExternalModel::sample_s() const {
  if (errors_.rate_hz <= 0.0) return std::numeric_limits<double>::infinity();
  return (static_cast<double>(count_) + 0.37) / errors_.rate_hz;
}

ExternalNumbers ExternalModel::true_numbers(const Kinematics& truth) const {
  if (index_ == 0) return {{truth.T_W_B.translation().z() + config_.height.zero_m}, {errors_.noise}};
  const Eigen::Vector3d v_B =
      truth.T_W_B.rotation().conjugate() * truth.v_W + truth.omega_B.cross(config_.velocity.p_B_S);
  return {{v_B.x(), v_B.y(), v_B.z()}, std::vector<double>(3, errors_.noise)};
}

std::optional<ExternalSample> ExternalModel::measure(const Kinematics& truth) {
  const double t_s = sample_s();
  // The same random numbers are generated for any configuration, so a gap or outliers change nothing else.
  const Eigen::Vector3d noise = random_.normal3(), walk = random_.normal3(), wrong = random_.normal3();
  const bool is_outlier = random_.uniform() < errors_.outlier_share;
  ExternalNumbers numbers = true_numbers(truth);
  for (std::size_t i = 0; i < numbers.values.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    numbers.values[i] = (1.0 + errors_.scale_error) * numbers.values[i] + offset_[axis] + errors_.noise * noise[axis];
    if (is_outlier) numbers.values[i] += errors_.outlier * wrong[axis];
  }
  offset_ += errors_.walk / std::sqrt(errors_.rate_hz) * walk;
  if (t_s >= errors_.gap_at_s && t_s < errors_.gap_at_s + errors_.gap_s) return std::nullopt;
  return external_sensors()[index_].sample(timestamp_from_seconds(t_s) + shift_, numbers);
}

}  // namespace edged
