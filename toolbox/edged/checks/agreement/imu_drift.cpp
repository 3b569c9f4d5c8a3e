// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/imu_drift.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/checks/agreement/imu_offset.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr Duration kMinute = std::chrono::seconds(60), kFollowed = std::chrono::seconds(20);
constexpr Duration kGap = std::chrono::seconds(1);  // in the camera's stamps, or one is damaged
constexpr double kLeastSigma_s = 1e-3;              // of the offset: what remains is the online calibration's
constexpr double kCrystals = 5e-5;                  // sigma of the drift at first
constexpr double kWander_per_sqrt_s = 3e-7;         // of the drift, by temperature: 2 ppm a minute
constexpr double kFastest = 2e-4;                   // change of the line

}  // namespace

ImuDrift::ImuDrift(RigCamera camera, double sigma_s) : camera_(std::move(camera)) {
  P_ = Eigen::Vector2d(square(std::max(sigma_s, kLeastSigma_s)), square(kCrystals)).asDiagonal();
}

void ImuDrift::add(const Measurement& measurement, ClockLine& line) {
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    if (visual_ && (samples_.empty() || sample->t > samples_.back().t)) samples_.push_back(*sample);
    return;
  }
  const std::string* name = camera_of(measurement);
  const auto t = first_stamp(measurement);
  if (!name || *name != camera_.name || !t) return;
  if (!begin_ || *t < *begin_) begin_ = *t;
  if (!updated_s_) updated_s_ = to_seconds(*t);
  if (*t - *begin_ >= kMinute) {
    if (*t - *begin_ < kMinute + kGap) end_minute(*t, line);
    visual_.reset();
    samples_.clear();
    begin_ = *t;
  } else if (*t - *begin_ >= kMinute - kFollowed) {
    if (!visual_) visual_.emplace(camera_);
    visual_->add(measurement);
  }
}

/// Without rotation by what is expected, as the line may still catch up.
void ImuDrift::end_minute(Timestamp now, ClockLine& line) {
  if (visual_) {
    if (const auto found = offset_of(visual_->turns(), samples_, camera_, camera_.time_offset))
      update(to_seconds(samples_.front().t) + found->t_s, found->x_s, found->sigma_s);
  }
  // All that is missing until the end of the next minute.
  const double at_end_s = x_[0] + x_[1] * (to_seconds(now) - *updated_s_);
  const double turn = std::clamp(x_[1] + at_end_s / to_seconds(kMinute), -kFastest, kFastest);
  const Timestamp imu = line.t_imu + duration_from_seconds(to_seconds(now - line.t) * line.rate);
  line = {imu, now, 1.0 / (1.0 / line.rate + turn)};
  x_[1] -= turn;
  x_[0] += turn * (to_seconds(now) - *updated_s_);  // as if the line had turned then
  turned_ += turn;
  const double drift = turned_ + x_[1], sigma = std::sqrt(P_(1, 1));
  if (told_ || std::abs(drift) < 4 * sigma) return;
  told_ = true;
  spdlog::info(fmt::format("IMU clock: followed, it drifts by {:+.0f} +- {:.0f} ppm", -1e6 * drift, 1e6 * sigma));
}

void ImuDrift::update(double t_s, double missing_s, double sigma_s) {
  const double dt = std::max(0.0, t_s - *updated_s_);
  Eigen::Matrix2d F;
  F << 1.0, dt, 0.0, 1.0;
  x_ = F * x_;
  P_ = F * P_ * F.transpose();
  P_(1, 1) += square(kWander_per_sqrt_s) * dt;
  updated_s_ = t_s;
  const Eigen::Vector2d gain = P_.col(0) / (P_(0, 0) + square(sigma_s));
  x_ += gain * (missing_s - x_[0]);
  P_ -= gain * P_.row(0).eval();
}

}  // namespace edged
