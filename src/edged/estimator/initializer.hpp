// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The start of the estimator: from rest when the IMU and the cameras say rest, else by visual-inertial alignment in
// motion.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/alignment.hpp"
#include "edged/estimator/estimator_input.hpp"
#include "edged/estimator/standstill.hpp"
#include "edged/estimator/window.hpp"
#include "edged/options/estimator.hpp"
#include "edged/rig.hpp"

namespace edged {

/// A window to go on from: its newest state is that of the packet.
struct StartWindow {
  Window window;
  double scale_sigma = 0.0;           ///< of ln scale; 0 from rest, where nothing has been scaled yet
  std::set<FeatureId> outliers = {};  ///< features of dynamic objects
};

/// What a packet brought the start.
struct StartResult {
  std::optional<StartWindow> start;
  std::string waiting_for = {};  ///< else what is missing, with numbers
  double explained = 1.0;        ///< see Alignment
};

/// Standard deviation of ln scale, as the way from the origin (the place of the start) to the window's farthest state
/// tells it.
double scale_sigma(const Window& window);

class Initializer {
 public:
  Initializer(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config)
      : rig_(rig), noise_(noise), config_(config) {}

  /// Inputs in time order. rest, which knows the input already: for a start from rest; null where that is not wanted. A
  /// start in motion must know the scale to most_scale_sigma. running: the estimate at the input, where there is one
  /// already.
  StartResult add(const EstimatorInput& input, const StandstillDetector* rest, double most_scale_sigma,
                  const OdomState* running = nullptr);

 private:
  bool buffer_view(const EstimatorInput& input);
  bool view_due(const EstimatorInput& input) const;
  Window empty_window() const;
  Window start_at_rest(const EstimatorInput& input, const StandstillDetector& standstill) const;
  void make_room();
  StartResult start_in_motion(double most_scale_sigma, const OdomState* running);
  /// External: what height and velocity sensors say is used, too.
  enum class External { Unused, Used };
  StartResult start_by(External external, double most_scale_sigma, const OdomState* running);
  StartResult start_from(const Alignment& alignment, External external, double most_scale_sigma);
  Window aligned_window(const Alignment& alignment, External external) const;
  void solve_start(Window& window) const;
  void weigh_observations(Window& window) const;
  std::string doubt_about(const Window& window, double most_tilt_deg) const;

  Rig rig_;
  ImuNoise noise_;
  EstimatorConfig config_;
  std::vector<InitFrame> buffer_;                    ///< views
  std::vector<ImuSample> pending_imu_;               ///< since the last view
  std::vector<ExternalSample> pending_external_;     ///< the same
  Timestamp next_solve_;                             ///< a refused window is not solved anew with every view
  std::string motion_lacks_ = "features to follow";  ///< what kept the last view from starting in motion
};

}  // namespace edged
