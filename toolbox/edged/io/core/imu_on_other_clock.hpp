// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording whose IMU was stamped by a clock that runs at a wrong rate.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "edged/dataset.hpp"

namespace edged {

/// Corrects the stamps of the IMU to the clock of the other sensors: t_first + (t - t_first) / rate. The recording is
/// in the order of the wrong stamps, so it is read by two readers at the same time: one for the IMU, one for all else.
class ImuOnOtherClock final : public Dataset {
 public:
  /// for_imu: the same recording as `others`, opened once more.
  ImuOnOtherClock(std::unique_ptr<Dataset> others, std::unique_ptr<Dataset> for_imu, double rate);

  const DatasetInfo& info() const override { return others_->info(); }
  std::optional<Measurement> next() override;
  void leave_out(Modality unwanted) override { others_->leave_out(unwanted); }
  std::optional<GroundTruth> ground_truth() const override { return others_->ground_truth(); }
  std::map<std::string, std::size_t> repairs() const override { return others_->repairs(); }

 private:
  std::optional<ImuSample> next_sample();
  std::optional<Measurement> next_of_others();

  std::unique_ptr<Dataset> others_, imu_;
  double rate_;
  std::optional<Timestamp> first_;
  std::optional<ImuSample> sample_;
  std::optional<Measurement> held_;
};

}  // namespace edged
