// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/gyro_integral.hpp"

#include <algorithm>

namespace edged {
namespace {

constexpr std::size_t kMostGyroSamples = 300'000;                 // of the gyro: five minutes of 1 kHz
constexpr Duration kLongestStep = std::chrono::milliseconds(50);  // between samples; a longer one is a gap

}  // namespace

void GyroIntegral::add(const ImuSample& sample) {
  if (stamps_.size() >= kMostGyroSamples || (!stamps_.empty() && sample.t <= stamps_.back())) return;
  if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) return;
  if (stamps_.empty()) {
    sum_.push_back(Eigen::Vector3d::Zero());
    attitude_.push_back(Eigen::Quaterniond::Identity());
    velocity_.push_back(Eigen::Vector3d::Zero());
    gaps_.push_back(0);
  } else {
    const Eigen::Vector3d step = (gyro_.back() + sample.gyro_B) / 2 * to_seconds(sample.t - stamps_.back());
    sum_.push_back(sum_.back() + step);
    const Eigen::Quaterniond before = attitude_.back();
    attitude_.push_back((before * so3::exp(step)).normalized());
    velocity_.push_back(velocity_.back() + (before * accel_.back() + attitude_.back() * sample.accel_B) / 2 *
                                               to_seconds(sample.t - stamps_.back()));
    gaps_.push_back(gaps_.back() + (sample.t - stamps_.back() > kLongestStep ? 1 : 0));
  }
  stamps_.push_back(sample.t);
  gyro_.push_back(sample.gyro_B);
  accel_.push_back(sample.accel_B);
}

std::optional<std::pair<std::size_t, std::size_t>> GyroIntegral::samples_after(Timestamp begin, Timestamp end) const {
  const auto place = [this](Timestamp t) {
    return static_cast<std::size_t>(std::ranges::upper_bound(stamps_, t) - stamps_.begin());
  };
  const std::size_t first = place(begin), last = place(end);
  if (first == 0 || last == stamps_.size()) return std::nullopt;
  if (gaps_[last] > gaps_[first - 1]) return std::nullopt;
  return std::pair(first, last);
}

Eigen::Vector3d GyroIntegral::step_to(std::size_t after, Timestamp t) const {
  const double step = to_seconds(stamps_[after] - stamps_[after - 1]), part = to_seconds(t - stamps_[after - 1]);
  const Eigen::Vector3d now = gyro_[after - 1] + (gyro_[after] - gyro_[after - 1]) * (part / step);
  return (gyro_[after - 1] + now) / 2 * part;
}

std::optional<Eigen::Vector3d> GyroIntegral::between(Timestamp begin, Timestamp end) const {
  const auto after = samples_after(begin, end);
  if (!after) return std::nullopt;
  const auto up_to = [this](std::size_t i, Timestamp t) -> Eigen::Vector3d { return sum_[i - 1] + step_to(i, t); };
  return up_to(after->second, end) - up_to(after->first, begin);
}

std::optional<Eigen::Vector3d> GyroIntegral::rotation_vector(Timestamp begin, Timestamp end) const {
  const auto after = samples_after(begin, end);
  if (!after) return std::nullopt;
  const auto up_to = [this](std::size_t i, Timestamp t) { return attitude_[i - 1] * so3::exp(step_to(i, t)); };
  return so3::log(up_to(after->first, begin).inverse() * up_to(after->second, end));
}

std::optional<Eigen::Quaterniond> GyroIntegral::attitude_at(Timestamp t) const {
  const auto after = samples_after(t, t);
  if (!after) return std::nullopt;
  return attitude_[after->first - 1] * so3::exp(step_to(after->first, t));
}

std::optional<Eigen::Vector3d> GyroIntegral::velocity_change(Timestamp begin, Timestamp end) const {
  const auto after = samples_after(begin, end);
  if (!after) return std::nullopt;
  const auto up_to = [this](std::size_t i, Timestamp t) -> Eigen::Vector3d {
    return velocity_[i - 1] + attitude_[i - 1] * accel_[i - 1] * to_seconds(t - stamps_[i - 1]);
  };
  return up_to(after->second, end) - up_to(after->first, begin);
}

}  // namespace edged
