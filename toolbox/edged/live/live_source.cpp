// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_source.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "edged/core/measurement_stamps.hpp"

namespace edged {

LiveSource::LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted,
                       std::function<void(const Measurement&)> on_due)
    : on_due_(std::move(on_due)),
      reader_(dataset, config, WhenFull::Shed, std::move(interrupted),
              [this](const Measurement& measurement, const std::function<bool()>& stopped) {
                if (const auto t = last_stamp(measurement)) clock_.wait_for(*t, stopped);
                if (on_due_ && !stopped()) on_due_(measurement);
              }) {}

std::optional<Measurement> LiveSource::next() {
  std::optional<Measurement> measurement = reader_.next();
  if (const auto line = report_.update(shed(), ShedReport::Clock::now())) spdlog::warn(*line);
  return measurement;
}

}  // namespace edged
