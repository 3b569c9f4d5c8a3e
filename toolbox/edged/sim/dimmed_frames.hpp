// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Simulates less light in the frames of a recording; all else is unchanged.
#pragma once

#include <memory>
#include <optional>

#include "edged/dataset.hpp"

namespace edged {

/// The frame of a typical 8-bit camera at a share `factor` of the light, with unchanged exposure and gain: fewer
/// electrons (10000 correspond to 255 grey levels) with shot noise, and a read noise of 1.2 grey levels. The stamp is
/// the seed of the noise, so a frame does not depend on where reading begins.
class DimmedFrames final : public Dataset {
 public:
  DimmedFrames(std::unique_ptr<Dataset> bright, double factor);

  const DatasetInfo& info() const override { return bright_->info(); }
  std::optional<Measurement> next() override;
  void leave_out(Modality unwanted) override { bright_->leave_out(unwanted); }
  std::optional<GroundTruth> ground_truth() const override { return bright_->ground_truth(); }
  std::map<std::string, std::size_t> repairs() const override { return bright_->repairs(); }

 private:
  cv::Mat dim(const Frame& frame) const;

  std::unique_ptr<Dataset> bright_;
  double factor_;
};

}  // namespace edged
