// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/accel_axes.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/se3.hpp"

namespace edged {
namespace {

constexpr Duration kMean = std::chrono::milliseconds(250);  // removes vibration
constexpr std::size_t kApart = 8;  // number of means between compared ones, for a sufficient rotation
constexpr Duration kHole = std::chrono::milliseconds(50);  // a longer step: samples are missing
constexpr double kLeastTurn = 0.15;                        // [rad] between them
constexpr std::size_t kFewest = 8;                         // pairs
// Ratio of squared errors. Correct axes have at least 0.69 (mirrors, EuRoC, simulator).
constexpr double kClearlyLess = 0.5;

}  // namespace

AccelAxes::AccelAxes() : signs_{{{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}}} {}

void AccelAxes::add(const ImuSample& sample) {
  if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) return;
  if (last_ && (sample.t <= last_->t || sample.t - last_->t > kHole)) {
    means_.clear();
    current_ = Mean();
  } else if (last_) {
    const Eigen::Vector3d phi = (last_->gyro_B + sample.gyro_B) / 2 * to_seconds(sample.t - last_->t);
    q_0_B_ = (q_0_B_ * so3::exp(phi)).normalized();
  }
  if (current_.count > 0 && sample.t - current_.begin >= kMean) end_mean();
  if (current_.count == 0) current_.begin = sample.t;
  if (sample.t - current_.begin <= kMean / 2) current_.q_0_B = q_0_B_;
  current_.accel += sample.accel_B;
  ++current_.count;
  last_ = sample;
}

void AccelAxes::end_mean() {
  current_.accel /= static_cast<double>(current_.count);
  means_.push_back(current_);
  current_ = Mean();
  if (means_.size() <= kApart) return;
  const Mean &before = means_.front(), &now = means_.back();
  const Eigen::Quaterniond q_now_before = now.q_0_B.conjugate() * before.q_0_B;
  if (so3::log(q_now_before).norm() > kLeastTurn) {
    for (std::size_t i = 0; i < signs_.size(); ++i) {
      const Eigen::Vector3d then = signs_[i].cwiseProduct(before.accel);
      errors_[i] += (signs_[i].cwiseProduct(now.accel) - q_now_before * then).squaredNorm();
    }
    ++pairs_;
  }
  means_.pop_front();
}

std::optional<std::string> AccelAxes::better() const {
  const auto least = static_cast<std::size_t>(std::ranges::min_element(errors_) - errors_.begin());
  if (pairs_ < kFewest || errors_[least] > kClearlyLess * errors_.front()) return std::nullopt;
  const Eigen::Vector3d& sign = signs_[least];
  return fmt::format("({}x, {}y, z)", sign.x() < 0 ? "-" : "", sign.y() < 0 ? "-" : "");
}

}  // namespace edged
