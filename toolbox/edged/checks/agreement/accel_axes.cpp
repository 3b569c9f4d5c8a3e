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
constexpr std::size_t kSignsOnly = 4;  // candidates without an exchange
// The specific force of a multirotor hardly turns in the body, so that axes which turn about it fit, too: an exchange
// must explain far more than the given axes, and than none that turn. (At most 0.31 and 0.47 of their errors in most
// flights with exchanged axes; with correct ones at least 0.46 and 0.61.)
constexpr double kOfGiven = 0.35, kOfUnturned = 0.55;

}  // namespace

AccelAxes::AccelAxes() {
  std::array<int, 3> order{0, 1, 2};
  std::size_t i = 0;
  do {
    for (const unsigned negated : {0U, 1U, 2U, 3U}) {
      const Eigen::Vector3d sign((negated & 1U) != 0 ? -1 : 1, (negated & 2U) != 0 ? -1 : 1, 1);
      axes_[i].setZero();
      for (int row = 0; row < 3; ++row) axes_[i](row, order.at(static_cast<std::size_t>(row))) = sign[row];
      if (i >= kSignsOnly) axes_[i] *= axes_[i].determinant();  // an IMU that is turned, not mirrored
      ++i;
    }
  } while (std::ranges::next_permutation(order).found);
}

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
    const Eigen::Matrix3d R_now_before = q_now_before.toRotationMatrix();
    for (std::size_t i = 0; i < axes_.size(); ++i)
      errors_[i] += (axes_[i] * now.accel - R_now_before * (axes_[i] * before.accel)).squaredNorm();
    unturned_ += (now.accel - before.accel).squaredNorm();
    ++pairs_;
  }
  means_.pop_front();
}

std::optional<std::string> AccelAxes::better() const {
  const double most = std::min(kOfGiven * errors_.front(), kOfUnturned * unturned_);  // of an exchange
  std::size_t least = 0;
  for (std::size_t i = 1; i < axes_.size(); ++i)
    if (errors_[i] < errors_[least] && (i < kSignsOnly || errors_[i] < most)) least = i;
  if (pairs_ < kFewest || errors_[least] > kClearlyLess * errors_.front()) return std::nullopt;
  std::string text;
  for (Eigen::Index row = 0, column = 0; row < 3; ++row) {
    const double sign = axes_[least].row(row).cwiseAbs().maxCoeff(&column) * axes_[least].row(row).sum();
    text += fmt::format("{}{}{}", row == 0 ? "(" : ", ", sign < 0 ? "-" : "", "xyz"[column]);
  }
  return text + ")";
}

}  // namespace edged
