// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Initialization of the estimator: at rest if IMU and cameras detect a standstill, else in motion by visual-inertial
// alignment.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/initialization/alignment.hpp"
#include "edged/estimator/standstill/standstill.hpp"
#include "edged/estimator/window/estimator_input.hpp"
#include "edged/estimator/window/window.hpp"
#include "edged/options/estimator.hpp"
#include "edged/rig.hpp"

namespace edged {

/// The initial window: its newest state is that of the packet.
struct StartWindow {
  Window window;
  bool by_baselines = false;          ///< the scale is known by baselines between cameras, not by motion
  double scale_sigma = 0.0;           ///< sigma of ln scale; 0 at rest, where no landmark has been scaled yet
  std::set<FeatureId> outliers = {};  ///< features of dynamic objects
};

/// The result of initialization for a packet.
struct InitializationResult {
  std::optional<StartWindow> start;
  std::string waiting_for = {};  ///< what is missing without a start, with numbers
  double inlier_share = 1.0;     ///< see Alignment
};

/// Standard deviation of ln scale, from the distance between the origin (the start) and the window's farthest state.
double scale_sigma(const Window& window);

class Initializer {
 public:
  /// `biases` are those of the IMU that an earlier estimate has found.
  Initializer(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config,
              const std::optional<BiasPrior>& biases = {})
      : rig_(rig), noise_(noise), config_(config), known_biases_(biases) {}

  /// Inputs in time order. rest, which has processed the input already: for an initialization at rest. An
  /// initialization in motion must have a scale sigma of at most most_scale_sigma. running: the estimate at the input,
  /// where there is one already.
  InitializationResult add(const EstimatorInput& input, const StandstillDetector& rest, double most_scale_sigma,
                           const OdomState* running = nullptr);

 private:
  bool buffer_view(const EstimatorInput& input);
  bool view_due(const EstimatorInput& input) const;
  Window start_at_rest(const EstimatorInput& input, const StandstillDetector& standstill) const;
  void make_room();
  InitializationResult start_in_motion(double most_scale_sigma, const OdomState* running);
  /// Whether samples of height and velocity sensors are used, too.
  enum class External { Unused, Used };
  InitializationResult start_by(External external, double most_scale_sigma, const OdomState* running);
  InitializationResult start_from(const Alignment& alignment, External external, double most_scale_sigma);
  Window aligned_window(const Alignment& alignment, External external) const;
  void solve_start(Window& window) const;
  void estimate_noise(Window& window) const;
  std::string rejection_reason(const Window& window, double most_tilt_deg, double most_speed_sigma) const;
  BiasPrior biases() const;
  int views() const { return static_cast<int>(buffer_.size()); }
  /// Whether baselines between cameras determine the scale.
  bool knows_scale(const Alignment& alignment) const { return alignment.baseline_sigma <= config_.init_scale_sigma; }

  Rig rig_;
  ImuNoise noise_;  ///< as of the newest input
  EstimatorConfig config_;
  std::optional<BiasPrior> known_biases_;                ///< by an earlier estimate
  std::vector<InitFrame> buffer_;                        ///< views, the oldest first
  std::vector<ImuSample> pending_imu_;                   ///< since the last view
  std::vector<ExternalSample> pending_external_;         ///< since the last view
  std::optional<Timestamp> since_;                       ///< begin of the first input
  Timestamp next_solve_;                                 ///< a rejected window is not solved again with every view
  std::string missing_in_motion_ = "features to track";  ///< why the last view did not initialize in motion
};

}  // namespace edged
