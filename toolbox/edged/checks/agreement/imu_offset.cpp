// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/imu_offset.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/checks/agreement/gyro_agreement.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr Duration kPiece = std::chrono::seconds(20);
constexpr Duration::rep kAllPieces = 3, kOneInPieces = 3;  // at first all pieces, then one of so many
constexpr std::size_t kMostWithRays = 16;                  // pieces that keep the rays of their turns, by memory
constexpr double kLikeGyro = 0.5;           // most of the rotation in a piece that the gyro leaves unexplained
constexpr double kLikeScale = 0.4;          // of the logarithm of the ratio of both rates: by chance it may be any
constexpr double kMostPieceSigma_s = 0.02;  // a shift of 64 ms is refuted
constexpr double kLeastPieceSigma_s =
    3e-4;                           // of the offset in a piece: turns share errors that their scatter does not show
constexpr double kSureDrift = 3.0;  // sigmas from none

GyroIntegral gyro_between(std::span<const ImuSample> samples, Timestamp begin, Timestamp end) {
  GyroIntegral gyro;
  const auto last = std::ranges::lower_bound(samples, end, {}, &ImuSample::t);
  for (auto sample = std::ranges::lower_bound(samples, begin, {}, &ImuSample::t); sample != last; ++sample)
    gyro.add(*sample);
  return gyro;
}

/// A line through the offsets, and its uncertainty, which their scatter may enlarge.
struct OffsetLine {
  double middle_s = 0.0, x_s = 0.0, slope = 0.0;  ///< the offset is x_s at middle_s
  double sigma_s = 0.0, slope_sigma = 0.0;
};

OffsetLine line_through(std::span<const PieceOffset> offsets, bool with_slope) {
  OffsetLine line;
  double weight = 0.0, tt = 0.0, tx = 0.0, squares = 0.0;
  for (const PieceOffset& o : offsets) {
    const double w = 1.0 / square(o.sigma_s);
    weight += w, line.middle_s += w * o.t_s, line.x_s += w * o.x_s;
  }
  line.middle_s /= weight;
  line.x_s /= weight;
  for (const PieceOffset& o : offsets) {
    const double w = 1.0 / square(o.sigma_s), t = o.t_s - line.middle_s;
    tt += w * t * t, tx += w * t * (o.x_s - line.x_s);
  }
  if (with_slope) line.slope = tx / tt;
  for (const PieceOffset& o : offsets)
    squares += square((o.x_s - line.x_s - line.slope * (o.t_s - line.middle_s)) / o.sigma_s);
  const double freedom = static_cast<double>(offsets.size()) - (with_slope ? 2.0 : 1.0);
  const double scatter = freedom > 0.0 ? std::sqrt(std::max(1.0, squares / freedom)) : 1.0;
  line.sigma_s = scatter / std::sqrt(weight);
  if (with_slope) line.slope_sigma = scatter / std::sqrt(tt);
  return line;
}

/// The offset of each piece, all on a line where that is certain.
void refine(std::span<const PieceOffset> offsets, ImuOffset& found) {
  constexpr std::size_t kFewestForDrift = 3;
  found.pieces = offsets.size();
  if (offsets.empty()) return;
  OffsetLine line = line_through(offsets, false);
  if (offsets.size() >= kFewestForDrift) {
    const OffsetLine drifting = line_through(offsets, true);
    found.rate_sigma = drifting.slope_sigma;
    if (std::abs(drifting.slope) > kSureDrift * drifting.slope_sigma) line = drifting;
  }
  found.offset = duration_from_seconds(line.x_s - line.slope * line.middle_s);
  found.rate = 1.0 / (1.0 + line.slope);
  found.sigma_s = line.sigma_s;
}

std::vector<PieceOffset> offsets_of(std::span<const std::vector<Turn>> pieces, std::span<const ImuSample> samples,
                                    const RigCamera& camera, Duration shift) {
  std::vector<PieceOffset> offsets;
  for (const std::vector<Turn>& turns : pieces)
    if (const auto offset = offset_of(turns, samples, camera, shift)) offsets.push_back(*offset);
  return offsets;
}

Duration usual_length(std::span<const Turn> turns) {
  std::vector<double> lengths;
  for (const Turn& turn : turns) lengths.push_back(to_seconds(turn.end - turn.begin));
  return duration_from_seconds(median(std::move(lengths)));
}

}  // namespace

std::optional<PieceOffset> offset_of(std::span<const Turn> turns, std::span<const ImuSample> samples,
                                     const RigCamera& camera, Duration shift) {
  constexpr Duration kAroundTurns = std::chrono::seconds(1);  // the offsets that compare_with_gyro() tries, and more
  if (turns.empty()) return std::nullopt;
  const Timestamp begin = turns.front().begin + shift, end = turns.back().end + shift;
  const auto found = compare_with_gyro(turns, gyro_between(samples, begin - kAroundTurns, end + kAroundTurns), shift);
  if (!found || found->at_bound || found->mirrored || found->unexplained > kLikeGyro) return std::nullopt;
  if (found->time_sigma_s > kMostPieceSigma_s) return std::nullopt;
  if (std::abs(std::log(std::max(found->gyro_scale, 1e-3))) > kLikeScale) return std::nullopt;
  return PieceOffset{to_seconds(begin + (end - begin) / 2 - samples.front().t),
                     to_seconds(camera.time_offset - found->time_offset),
                     std::hypot(found->time_sigma_s, kLeastPieceSigma_s)};
}

ImuOffset find_imu_offset(std::span<const std::vector<Turn>> pieces, std::span<const ImuSample> samples,
                          const RigCamera& camera, bool has_extrinsics) {
  ImuOffset found;
  std::vector<Turn> all;
  for (const std::vector<Turn>& turns : pieces)
    for (const Turn& turn : turns) all.push_back({turn.begin, turn.end, turn.phi_C});
  RateSeries of_camera = camera_rates(all, camera.T_B_C.R()), of_gyro = gyro_rates(samples, usual_length(all));
  if (!has_extrinsics) use_speeds(of_camera), use_speeds(of_gyro);
  found.match = match_rates(of_camera, of_gyro);
  if (!found.match || !found.match->unique) return found;
  found.offset = camera.time_offset - found.match->shift;
  refine(offsets_of(pieces, samples, camera, found.match->shift), found);
  return found;
}

ImuOffsetSearch::ImuOffsetSearch(RigCamera camera, bool has_extrinsics)
    : camera_(std::move(camera)), has_extrinsics_(has_extrinsics) {}

void ImuOffsetSearch::add(const Measurement& measurement) {
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    const bool is_next = samples_.empty() || sample->t > samples_.back().t;
    if (is_next && sample->gyro_B.allFinite()) samples_.push_back(*sample);
    return;
  }
  const std::string* name = camera_of(measurement);
  const auto t = first_stamp(measurement);
  if (!name || *name != camera_.name || !t) return;
  if (!begin_) begin_ = t;
  const Duration::rep piece = (*t - *begin_) / kPiece;
  if (piece != piece_) end_piece();
  piece_ = piece;
  if (piece >= kAllPieces && piece % kOneInPieces != 0) return;
  if (!visual_) visual_.emplace(camera_);
  visual_->add(measurement);
}

void ImuOffsetSearch::end_piece() {
  if (visual_) pieces_.push_back(visual_->turns());
  visual_.reset();
  if (pieces_.size() <= kMostWithRays) return;
  for (Turn& turn : pieces_[pieces_.size() - kMostWithRays - 1]) turn.rays = {};
}

ImuOffset ImuOffsetSearch::result() {
  end_piece();
  return find_imu_offset(pieces_, samples_, camera_, has_extrinsics_);
}

}  // namespace edged
