// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A part of a recording, as if it had started later and ended earlier.
#pragma once

#include <memory>
#include <optional>

#include "edged/dataset.hpp"

namespace edged {

/// Seconds since the recording's begin: from <= t < to.
struct PieceBounds {
  double from_s = 0.0;
  std::optional<double> to_s;  ///< nothing: up to the end
};

/// Each sensor's measurements are kept by their own stamps. The truth keeps a pose on either side of the piece.
class RecordingPiece final : public Dataset {
 public:
  /// If the recording does not know its begin, that is the stamp of its first measurement, which is read here. Throws
  /// InputError for a range without measurements: here, or in next() if the end of the recording is unknown.
  RecordingPiece(std::unique_ptr<Dataset> whole, const PieceBounds& bounds);

  const DatasetInfo& info() const override { return info_; }
  std::optional<Measurement> next() override;
  void leave_out(Modality unwanted) override;
  std::size_t skip_events(double share) override { return whole_->skip_events(share); }
  std::optional<GroundTruth> ground_truth() const override;
  std::map<std::string, std::size_t> repairs() const override { return whole_->repairs(); }

 private:
  std::optional<Measurement> read();
  /// The part of it that lies in the piece, if any; notes which sensors have passed its end.
  std::optional<Measurement> cut(Measurement measurement);
  bool all_past() const { return !(left_.events || left_.frames || left_.imu); }

  std::unique_ptr<Dataset> whole_;
  DatasetInfo info_;
  PieceBounds bounds_;
  Timestamp from_, to_;
  std::optional<Measurement> first_;  // read ahead to find the begin
  Timestamp newest_ = Timestamp::min();
  bool empty_ = true;  // next() has returned nothing yet
  struct {
    bool events, frames, imu;
  } left_;  // sensors that have not reached the piece's end
};

}  // namespace edged
