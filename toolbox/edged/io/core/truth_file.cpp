// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/truth_file.hpp"

#include <utility>

#include "edged/io/parse/trajectory_io.hpp"

namespace edged {
namespace {

class DatasetWithTruth final : public Dataset {
 public:
  DatasetWithTruth(std::unique_ptr<Dataset> recording, Trajectory poses)
      : recording_(std::move(recording)), truth_{std::move(poses), recording_->info().pose_frame} {}

  const DatasetInfo& info() const override { return recording_->info(); }
  std::optional<Measurement> next() override { return recording_->next(); }
  void leave_out(Modality unwanted) override { recording_->leave_out(unwanted); }
  std::optional<GroundTruth> ground_truth() const override { return truth_; }
  std::map<std::string, std::size_t> repairs() const override { return recording_->repairs(); }

 private:
  std::unique_ptr<Dataset> recording_;
  GroundTruth truth_;
};

}  // namespace

std::unique_ptr<Dataset> with_truth_file(std::unique_ptr<Dataset> recording, const SourcePath& file) {
  return std::make_unique<DatasetWithTruth>(std::move(recording), read_trajectory(file));
}

}  // namespace edged
