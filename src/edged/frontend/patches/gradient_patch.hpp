// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The reference patch of a feature on event frames. What an event frame shows depends on the motion: edges along it are
// missing. The gradient of the brightness does not depend on it, and tells what any motion would show.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "edged/frontend/patches/patch.hpp"

namespace edged {

/// The changes of the log brightness that an event frame shows (EventFrame::increments).
struct BrightnessIncrements {
  cv::Mat image;       ///< CV_8UC1, 128 where there are none; empty for frames
  double share = 0.0;  ///< time that its events cover over the time since the image before
};

class GradientPatch {
 public:
  GradientPatch() = default;
  /// From the image of a feature whose motion is not known yet: it is taken to be that of the next one.
  GradientPatch(const BrightnessIncrements& seen, const Eigen::Vector2d& feature);

  /// Where the newest image shows the feature, independent of contrast; nothing if that is not near, or if no motion so
  /// far was in this direction. place: of the patch in the image, as expected; moved: since the image before [px].
  std::optional<Eigen::Vector2d> align(const BrightnessIncrements& seen, const PatchPlace& place,
                                       const Eigen::Vector2d& moved, const PatchConfig& config) const;
  /// Learns from the newest image. place: of the patch; confirmed: a reference patch has matched there. Otherwise only
  /// what no motion so far has shown is learned.
  void learn(const BrightnessIncrements& seen, const PatchPlace& place, const Eigen::Vector2d& moved, bool confirmed);

 private:
  static constexpr int kPixels = Patch::kSize * Patch::kSize;

  void add(const Patch& increments, const Eigen::Vector2d& moved);
  /// Weights of products_ for a motion.
  Eigen::Vector2d weights(const Eigen::Vector2d& moved) const;
  bool spans(const Eigen::Vector2d& moved) const;
  /// What the motion would show, with full contrast.
  Patch expected(const Eigen::Vector2d& moved) const;

  // Least squares for the gradient of all pixels, with motions in pixels of the patch: the sums of moved moved^T and of
  // moved times increment.
  Eigen::Matrix2d squares_ = Eigen::Matrix2d::Zero();
  Eigen::Matrix<float, 2, kPixels> products_ = Eigen::Matrix<float, 2, kPixels>::Zero();
  std::optional<Patch> first_;                        // of the first image, until the next one
  Eigen::Vector2d behind_ = Eigen::Vector2d::Zero();  // how far the events of the first image were behind the feature
};

}  // namespace edged
