// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/autopilot_config.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <string_view>

#include "edged/core/check.hpp"
#include "edged/core/config/option_text.hpp"

namespace edged {
namespace {

constexpr std::string_view kAxesKey = "autopilot.axes";

struct Direction {
  std::string_view name;
  int row;  ///< 0 forward, 1 left, 2 up
  double sign;
};
constexpr std::array<Direction, 6> kDirections = {
    {{"forward", 0, 1.0}, {"back", 0, -1.0}, {"left", 1, 1.0}, {"right", 1, -1.0}, {"up", 2, 1.0}, {"down", 2, -1.0}}};

/// "-y" as a unit vector of B.
std::optional<Eigen::Vector3d> axis_of(std::string_view text) {
  const double sign = text.starts_with('-') ? -1.0 : 1.0;
  if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t axis = std::string_view("xyz").find(text);
  if (text.size() != 1 || axis == std::string_view::npos) return std::nullopt;
  return sign * Eigen::Vector3d::Unit(static_cast<Eigen::Index>(axis));
}

/// The rotation from B to forward, left, up by two of these directions; the third completes a right-handed frame.
std::optional<Eigen::Matrix3d> rotation_of_axes(std::string text) {
  std::ranges::replace(text, ',', ' ');
  std::istringstream in(text);
  std::array<std::optional<Eigen::Vector3d>, 3> rows;
  for (std::string word; in >> word;) {
    const std::size_t equals = std::min(word.find('='), word.size() - 1);
    const auto direction = std::ranges::find(kDirections, std::string_view(word).substr(0, equals), &Direction::name);
    const auto axis = axis_of(std::string_view(word).substr(equals + 1));
    if (direction == kDirections.end() || !axis || rows[static_cast<std::size_t>(direction->row)]) return std::nullopt;
    rows[static_cast<std::size_t>(direction->row)] = direction->sign * *axis;
  }
  const auto is_missing = [](const auto& row) { return !row; };
  if (std::ranges::count_if(rows, is_missing) != 1) return std::nullopt;
  const auto missing = std::ranges::find_if(rows, is_missing);
  const auto at = static_cast<std::size_t>(missing - rows.begin());
  *missing = rows[(at + 1) % 3]->cross(*rows[(at + 2) % 3]);
  Eigen::Matrix3d R;
  for (std::size_t i = 0; i < rows.size(); ++i) R.row(static_cast<Eigen::Index>(i)) = rows[i]->transpose();
  if (R.determinant() < 0.5) return std::nullopt;  // the two are one axis
  return R;
}

}  // namespace

void AutopilotConfig::visit(ConfigFields& fields) {
  fields.add(
      "axes", axes,
      {.effect = "How the IMU is mounted: its axes that point forward (back, left, right) and up (down), such "
                 "as \"forward=z up=-y\", or its roll pitch yaw [deg] in the vehicle's axes forward, left, up."});
  fields.add(
      "rate_hz", rate_hz,
      {"Hz", 5, 1000, "Messages per second to the autopilot, at most those of the IMU. PX4 takes none below 5."});
  fields.add("system_id", system_id, {"", 1, 255, "MAVLink: id of the vehicle, as in the autopilot."});
  fields.add("component_id", component_id,
             {"", 1, 255, "MAVLink: id of this sender; 197 is visual-inertial odometry."});
}

Eigen::Quaterniond AutopilotConfig::R_V_B() const {
  const Eigen::Quaterniond flu_to_frd(0.0, 1.0, 0.0, 0.0);  // half a turn about forward
  if (axes.find('=') == std::string::npos) return flu_to_frd * rotation_of_degrees(axes, kAxesKey);
  const std::optional<Eigen::Matrix3d> R = rotation_of_axes(axes);
  if (!R)
    throw InputError::format(
        "{}: '{}' does not say which axes of the IMU point where: give two, such as \"forward=x up=z\"", kAxesKey,
        axes);
  return flu_to_frd * Eigen::Quaterniond(*R);
}

}  // namespace edged
