// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the estimator that were chosen, not derived: each with its unit, its effect and its reason. A number
// in brackets names the decision page (docs/decisions). What a user may set is in edged/options/estimator.hpp.
#pragma once

#include <cstddef>

#include "edged/core/angles.hpp"
#include "edged/time.hpp"

namespace edged {

struct FactorTuning {
  double min_depth_share = 1e-3;       ///< share of the anchor depth: a nearer landmark counts as behind the camera
  double cauchy_scale = 1.0;           ///< [sigma] scale of visual and depth residuals: larger ones lose weight
  double external_cauchy_scale = 2.0;  ///< [sigma] of height and velocity, whose samples are averaged [032]
  double standstill_position_sigma_m = 2e-3, standstill_rotation_sigma = 1e-3;  ///< [rad] motion during a rest [021]
  double equal_calibration_sigma = 1e-4;  ///< [rad], shares of the field of view, [m]: of two cameras behind one lens
};
inline constexpr FactorTuning kFactorTuning{};

/// Landmarks and their observations.
struct LandmarkTuning {
  double min_parallax_deg = 0.6;      ///< between the rays of a feature that becomes a landmark
  double certain_sigmas = 2.0;        ///< by which an inverse depth is certain in what is known of translations [016]
  double translation_sigmas = 2.0;    ///< of chance: more points with parallax are before a camera than behind it [016]
  double max_innovation_sigma = 6.0;  ///< observations farther from their prediction by the IMU are removed [023]
  double track_correlation_time_s = 2.0;  ///< errors along a track correlate by exp(-dt / this) [018]
  std::size_t min_observations = 4;       ///< observations of a landmark whose mean residual is judged [019]
  std::size_t min_landmarks = 12;  ///< landmarks of a camera, for a median of residuals that outliers do not move
  double min_median_sigma = 0.2;   ///< [sigma] of the residuals of a camera, so that exact data keep landmarks
  double relinearised_intrinsics = 1e-3;  ///< a change by this leaves 1e-5 of the field of view of second order [020]
};
inline constexpr LandmarkTuning kLandmarkTuning{};

/// Depth factors (paper Eq. 5) [004].
struct DepthTuning {
  double scale_walk = 0.02;  ///< random walk of ln s [1/sqrt(s)]: the source is trained for other scenes
  double noise_share = 0.5;  ///< share of sigma_ln of the source: errors that change with time, which s does not model
  double min_sigma_ln = 0.05;      ///< lower bound for a residual
  double min_interval_s = 0.5;     ///< between two factors: the errors of the source are correlated in time
  int min_landmarks = 8;           ///< in the region
  std::size_t max_landmarks = 12;  ///< in one factor, which couples them and so costs time
  double min_depth_share = 0.01;   ///< share of the anchor depth: nearer landmarks are almost behind the camera
  double gate_sigma = 3.0;         ///< a depth farther from the landmarks is not used
};
inline constexpr DepthTuning kDepthTuning{};

struct SolverTuning {
  /// Added to a matrix with ones on its diagonal, times 1e3 after a step that fails. Close to Gauss-Newton: with more
  /// damping the scale, common to many blocks, does not converge.
  double damping = 1e-9, damping_factor = 1e3;
  double converged = 1e-6;       ///< a step with a smaller relative decrease of the cost is the last
  double keep_matrix = 0.1;      ///< after a smaller relative decrease the next step keeps the factorization [017]
  double rest_stretch = 10.0;    ///< factor on the longest IMU interval between keyframes, at rest [021]
  std::size_t band_states = 40;  ///< poses further apart are coupled by revisits, not by tracks [028]
};
inline constexpr SolverTuning kSolverTuning{};

/// Standstill [021].
struct StandstillTuning {
  std::size_t blocks = 8;   ///< means of samples in a window: they keep motion and lose white noise
  double min_cover = 0.98;  ///< share of a window that samples must cover
  Duration max_gap = std::chrono::milliseconds(100);  ///< in the samples: interpolated ones resemble those of a rest
  double max_gyro_mean = 0.15;                        ///< [rad/s] a larger mean rate is motion, not bias
  std::size_t min_features = 8;                       ///< common to two views: fewer do not determine the image motion
  double max_image_motion = 4e-3;                ///< [rad] median travel of the features over the window: under a pixel
  double quiet_window_s = 0.7;                   ///< duration of a rest for which the IMU alone suffices
  double quiet_gyro = 0.008, quiet_accel = 0.1;  ///< [rad/s], [m/s^2] spread then, near a sensor's own noise
  double glide_stretch = 3.0;  ///< factor on quiet_window_s where the whole image moves: the motion may be uniform
  double glide_share = 0.7;    ///< share of the features that move as their median does, where the whole image moves
  double glide_spread = 0.5;   ///< share of the median travel: features this close to it move alike
  /// A mean rate is a turn, not a bias, if features move by this share of it or more; a turn about the optical axis
  /// hardly moves those in the middle. Rates that move them by less than min_turn times max_image_motion are ignored.
  double turn_share = 0.2, min_turn = 4.0;
  double block_spread = 7.0;        ///< sigmas of a mean between the extremes of eight: 2.8 on average
  int common_rounds = 3;            ///< refinements of the half of the features that agree best
  double max_common_motion = 4e-4;  ///< [rad] travel over the window that features share; at rest 1e-5
  double common_sigmas = 5.0;  ///< of that travel by its own scatter: less is noise; the half that agrees scatters less
  double apart = 2.0;          ///< times max_image_motion at rest by features that do not move together: a lamp wanders
  double moving_sigma = 3.5;   ///< a speed beyond so many sigmas is motion
  double contradicted = 2.0;   ///< times max_image_motion: an estimate that moves the image by more would show in it
  double usual_depth_m = 1.5;  ///< of the scene, where no landmark tells it
  double unfelt_speed = 0.2;   ///< [m/s] of gentle motion, whose accelerations a quiet IMU hides
  Duration min_shaking = std::chrono::milliseconds(500);     ///< a body that starts to move has moved the image by then
  Duration noise_interval = std::chrono::milliseconds(200);  ///< between measurements of the noise at rest
};
inline constexpr StandstillTuning kStandstillTuning{};

/// The attitude filter before the start.
struct AttitudeTuning {
  double gyro_bias_sigma = 0.05;                 ///< [rad/s] of a consumer gyro, unknown at first
  double first_motion = 1.0, min_motion = 0.05;  ///< [m/s^2] sigma of the body's accelerations
  double motion_time_s = 0.5;                    ///< for which an acceleration lasts: a hand, a drone
  double motion_memory_s = 2.0;                  ///< over which their size is estimated
};
inline constexpr AttitudeTuning kAttitudeTuning{};

/// Height and velocity sensors [032].
struct ExternalTuning {
  double gate_sigma = 4.0;            ///< with the uncertainty of the window included
  double start_gate_sigma = 10.0;     ///< before an initialization is solved: only gross errors are rejected
  double level_sigma_m = 1e3;         ///< sigma of the level before the first height
  double velocity_scale_walk = 2e-3;  ///< random walk of its scale error [1/sqrt(s)]: slip, temperature
  Duration new_level = std::chrono::milliseconds(1000);  ///< time of rejected heights after which the level has changed
  Duration velocity_lasts = std::chrono::milliseconds(500);  ///< time for which a velocity bounds the drift
};
inline constexpr ExternalTuning kExternalTuning{};

/// Initialization at rest and in motion [025]; views are those of the start-up buffer.
struct InitializationTuning {
  double gauge_sigma_m = 1e-4, gauge_sigma_rad = 1e-4;  ///< hold position and yaw of the first state
  double zero_velocity_sigma = 0.01;                    ///< [m/s] of a body at rest
  double rest_gyro_bias_sigma = 0.005;                  ///< [rad/s] where the rest has measured the bias
  /// IMU before a start in a rest that shakes, whose mean is as uncertain as its noise [022].
  Duration noise_measured = std::chrono::milliseconds(900);
  double rest_accel_sigma = 0.03;      ///< [m/s^2] of the mean acceleration at rest: a calm IMU may still move a little
  double max_gravity_error = 1.0;      ///< [m/s^2] of that mean: beyond it the unit is wrong, ...
  double gravity_sigmas = 3.5;         ///< ... if vibration does not explain it
  double gyro_bias_sigma = 0.02;       ///< [rad/s] after a start in motion, around the bias that the alignment finds
  double pair_gyro_bias_sigma = 0.05;  ///< [rad/s] around zero where cameras share features: in so short a time the
                                       ///< alignment takes slow motion for a bias
  double accel_bias_sigma = 0.15;      ///< [m/s^2] around zero, of consumer IMUs

  double spacing_s = 0.08, stereo_spacing_s = 0.04;  ///< between views, at most; where cameras share features
  double turn = 5.0 * kDegree;                       ///< [rad] a rotation by this adds the next view earlier
  int min_views = 8, stereo_min_views = 3;  ///< with shared features depths are known: three views determine the rest
  int max_views = 24;                       ///< bounds the time of a solve
  double max_span_s = 7.0;                  ///< span of all views: tracks last, and biases stay, for so long
  double max_pending_imu_s = 10.0;          ///< without an image: the buffer begins anew
  Duration solve_every = std::chrono::milliseconds(250);  ///< a rejected window is not solved again with every view

  int iterations = 25, refine_iterations = 8;  ///< solver iterations of the first round and of later ones
  std::ptrdiff_t min_landmarks = 15;           ///< landmarks of the solved window
  double noise_inflation = 2.5,
         min_noise = 0.3;               ///< noise of observations over the spread of their residuals; over the given
  double max_free_gravity_error = 0.3;  ///< relative, with the magnitude of gravity left free
  double alignment_slack = 1.5;     ///< the solved window may know the scale better than the alignment by this factor
  double max_rms_sigma = 2.0;       ///< residuals in the solved window: above it the start is wrong
  double max_tilt_sigma_deg = 2.0;  ///< the accelerometer bias alone causes 0.9
  double max_bias_sigmas = 4.0;     ///< accelerometer bias over its sigma: above it the start is wrong
  double max_speed_sigma = 0.06;    ///< [m/s] of the newest state, worst direction, where cameras share features
};
inline constexpr InitializationTuning kInitializationTuning{};

/// Visual-inertial alignment and its hypotheses, which tell the scene from dynamic objects [025].
struct AlignmentTuning {
  double ray_sigma = 5e-3;                    ///< [rad] of a feature's ray: calibration and tracking at the start
  double huber_sigma = 1.5;                   ///< residuals beyond it count linearly
  std::size_t min_pair_features = 10;         ///< common to two views that determine the gyro bias
  double gyro_bias_sigma = 0.15;              ///< [rad/s] around zero, weak against the views
  double usual_depth_m = 3.0;                 ///< turns algebraic errors of rays, which are lengths, into angles
  std::size_t min_observations = 3;           ///< observations of a feature
  std::size_t min_tracks = 10;                ///< tracks that agree on a motion
  std::size_t patch_tracks = 12;              ///< tracks of which a hypothesis consists
  double patches = 8.0;                       ///< into which hypotheses divide the view
  int iterations = 12, patch_iterations = 4;  ///< iterations of Gauss-Newton
  double inlier_sigma = 0.6;                  ///< RMS of the reprojection errors of a track
  double static_share = 0.8;  ///< share of inliers from which on the motion is relative to the static scene
  double min_support = 0.4;   ///< share of the best support: a hypothesis with less is dropped
  int bias_rounds = 2;        ///< rounds that estimate the gyro bias from inliers alone
  double cell_rad = 0.25;     ///< size of a cell of directions, whose tracks share one vote
};
inline constexpr AlignmentTuning kAlignmentTuning{};

/// What baselines between cameras determine of the scale [041].
struct StereoScaleTuning {
  int min_pairs = 15;
  double max_information = 100.0;  ///< information of one pair: a wrong match must not count for all
  double noise_sigmas = 3.5;  ///< times sqrt(pairs): information that the noise of far points may have, of either sign
  double baseline_error = 0.01,
         rotation_error = 5e-4;  ///< errors of the calibration, shared by all pairs: relative, [rad]
};
inline constexpr StereoScaleTuning kStereoScaleTuning{};

struct EstimatorTuning {
  double max_speed = 60.0, max_gyro_bias = 0.5,
         max_accel_bias = 3.0;  ///< [m/s], [rad/s], [m/s^2]: beyond is divergence
  double noise_gain = 0.05;     ///< a packet: adaptation of a camera's noise to its residuals [018]
  double min_noise_scale = 0.05, max_noise_scale = 4.0;  ///< bounds of the adapted noise over the given one
  /// Share of event_noise_inflation: all of it down to this share of the sigma of frames, none of it from the other on.
  double full_event_inflation = 1.0 / 2.0, no_event_inflation = 1.0 / 5.0;
  double max_imu_strain = 0.5;          ///< [sigma] above it the observations lose weight [023]
  double shaking_strain = 0.35;         ///< [sigma] while the IMU shakes its noise rises to less, as is usual [022]
  double max_imu_noise_scale = 10.0;    ///< of that rise, as that by corrections
  int noise_rounds = 5;                 ///< solutions for it: with less weight the residuals grow
  double strain_gain = 0.25;            ///< a packet: exponent of the noise inflation by the strain
  double events_alone_inflation = 1.4;  ///< factor on reported sigmas: dynamic objects mislead events more easily [024]
  double gyro_saturation_noise = 6.0;   ///< times an observation's sigma [022]: images blur, features are tracked
                                        ///< without a prediction, and errors common to an image rotate the estimate

  double same_velocity = 0.25, same_velocity_mps = 0.03;         ///< two starts that agree: relative, absolute [025]
  Duration confirmation_time = std::chrono::milliseconds(1000);  ///< an uncontradicted start needs no second one then
  double min_inlier_share = 0.65;      ///< share of another motion's support: a start below it follows a dynamic object
  double better_scale = 0.8;           ///< a start replaces another if its scale is more certain by this factor
  double start_sigma_inflation = 1.5;  ///< factor on sigmas by the measurements since the start

  double max_standstill_speed = 0.15;  ///< [m/s] a faster body is not at rest, unless the IMU alone detects it [021]
  double vision_rest_sigma = 0.05;     ///< [m/s] of a body at rest by its image alone, near the estimate
  Duration turning_after = std::chrono::milliseconds(500);  ///< without support: a body that moves has shown parallax
  int min_supporting = 8;         ///< landmarks in view that bound the drift, as many as Good needs
  double turning_sigma = 0.02;    ///< [m/s] least of a turn in place: the velocity changes while features are followed
  double flow_depth_sigma = 0.7;  ///< of ln depth of a scene that shows no parallax: a factor of two
  double consistent_sigma = 3.0;  ///< a turn in place is none if the speed is beyond so many of its sigmas
  double gyro_bias_drift = 3e-4;  ///< [rad/s] of a gyro's bias since it was last observed
  double rest_gyro_bias_sigma = 5e-4;  ///< [rad/s] where the IMU alone detects a rest: a body at rest turns no faster
};
inline constexpr EstimatorTuning kEstimatorTuning{};

}  // namespace edged
