// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/imu_on_other_clock.hpp"

#include <utility>

#include "edged/io/core/take_before.hpp"

namespace edged {

ImuOnOtherClock::ImuOnOtherClock(std::unique_ptr<Dataset> others, std::unique_ptr<Dataset> for_imu, double rate)
    : others_(std::move(others)), imu_(std::move(for_imu)), rate_(rate) {
  imu_->leave_out(Modality::Events);
  imu_->leave_out(Modality::Frames);
}

std::optional<Measurement> ImuOnOtherClock::next() {
  if (!held_) held_ = next_of_others();
  if (!sample_) sample_ = next_sample();
  if (!sample_) return std::exchange(held_, std::nullopt);
  if (auto before = take_before(held_, sample_->t)) return before;
  return std::exchange(sample_, std::nullopt);
}

std::optional<ImuSample> ImuOnOtherClock::next_sample() {
  while (auto measurement = imu_->next()) {
    auto* sample = std::get_if<ImuSample>(&*measurement);
    if (sample == nullptr) continue;
    if (!first_) first_ = sample->t;
    sample->t = *first_ + duration_from_seconds(to_seconds(sample->t - *first_) / rate_);
    return *sample;
  }
  return std::nullopt;
}

std::optional<Measurement> ImuOnOtherClock::next_of_others() {
  while (auto measurement = others_->next())
    if (!std::holds_alternative<ImuSample>(*measurement) && first_stamp(*measurement)) return measurement;
  return std::nullopt;
}

}  // namespace edged
