// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/lens_agreement.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "edged/input_error.hpp"

namespace edged {
namespace {

/// The lens of `given` with another focal length and distortion; nothing where no camera has it.
std::optional<CameraModel> other_lens(const CameraModel& given, double focal_factor, DistortionModel distortion) {
  try {
    return CameraModel(given.width(), given.height(), focal_factor * given.fx(), focal_factor * given.fy(), given.cx(),
                       given.cy(), distortion, given.coefficients());
  } catch (const InputError&) {  // not monotone over the image, or too many coefficients
    return std::nullopt;
  }
}

/// The same corners through another lens.
std::vector<Turn> seen_through(const CameraModel& lens, const CameraModel& given, std::span<const Turn> turns) {
  std::vector<Turn> seen;
  const auto point = [&](const Eigen::Vector3d& ray) -> Eigen::Vector2d {
    return lens.pixel_to_point(given.distort_to_pixel(ray.hnormalized()));
  };
  for (const Turn& turn : turns) {
    std::vector<Eigen::Vector2d> begin, end;
    seen.push_back({turn.begin, turn.end});
    for (const auto& [from, to] : turn.rays) {
      begin.push_back(point(from));
      end.push_back(point(to));
      seen.back().rays.emplace_back(begin.back().homogeneous().normalized(), end.back().homogeneous().normalized());
    }
    const auto R = rotation_between(begin, end);
    if (R)
      seen.back().phi_C = so3::log(Eigen::Quaterniond(*R));
    else
      seen.pop_back();
  }
  return seen;
}

}  // namespace

std::optional<std::string> better_lens(const RigCamera& camera, std::span<const Turn> turns, const GyroIntegral& gyro,
                                       double unexplained) {
  using enum DistortionModel;
  // Right lenses of frames (simulator, mirrors, EuRoC) leave 0.006 to 0.16, and each other one at least 1.09 times as
  // much; of event frames, whose corners are few and late, another one may leave half, and of few corners among people
  // or under a moving lamp 0.55. The right one in place of a wrong one leaves 0.07 to 0.17.
  constexpr double kDoubtful = 0.05, kFarBetter = 0.4;
  if (camera.modality == Modality::Events || unexplained < kDoubtful) return std::nullopt;
  const CameraModel& given = camera.model;
  double least = kFarBetter * std::min(unexplained, 1.0);
  std::optional<std::string> best;
  const auto attempt = [&](double focal_factor, DistortionModel distortion, const std::string& text) {
    const auto lens = other_lens(given, focal_factor, distortion);
    if (!lens) return;
    const auto found = compare_with_gyro(seen_through(*lens, given, turns), gyro, camera.time_offset);
    if (found && !found->mirrored && found->unexplained < least) least = found->unexplained, best = text;
  };
  for (int thirds : {-4, -3, -2, -1, 1, 2, 3, 4}) {  // of an octave
    const double factor = std::exp2(thirds / 3.0);
    attempt(factor, given.distortion(),
            fmt::format("a focal length near {:.0f} px fits, not {:.0f} px", factor * given.fx(), given.fx()));
  }
  if (given.distortion() == RadTan) attempt(1.0, Equidistant, "its coefficients fit as equidistant, not as radtan");
  if (given.distortion() == Equidistant) attempt(1.0, RadTan, "its coefficients fit as radtan, not as equidistant");
  return best;
}

}  // namespace edged
