// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The start of the estimator: from rest when the IMU and the cameras say rest, else by visual-inertial alignment in motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/camera/rig.hpp"
#include "edged/estimator/alignment.hpp"
#include "edged/estimator/estimator_config.hpp"
#include "edged/estimator/estimator_input.hpp"
#include "edged/estimator/standstill.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

/// What a packet brought the start.
struct StartResult {
  std::optional<Window> window;  ///< the start: the newest state is that of the packet
  std::string waiting_for;       ///< else what is missing, with numbers
};

class Initializer {
 public:
  Initializer(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config)
      : rig_(rig), noise_(noise), config_(config) {}

  /// Inputs in time order, each already known to the standstill detector.
  StartResult add(const EstimatorInput& input, const StandstillDetector& standstill);

 private:
  bool buffer_view(const EstimatorInput& input);
  Window start_at_rest(const EstimatorInput& input, const StandstillDetector& standstill) const;
  void make_room();
  StartResult start_in_motion() const;
  Window aligned_window(const Alignment& alignment) const;
  std::string doubt_about(Window& window) const;
  std::string scale_text(double sigma) const;

  Rig rig_;
  ImuNoise noise_;
  EstimatorConfig config_;
  std::vector<InitFrame> buffer_;       ///< views
  std::vector<ImuSample> pending_imu_;  ///< since the last view
  std::string motion_lacks_ = "corners to follow";  ///< what kept the last view from starting in motion
};

}  // namespace edged
