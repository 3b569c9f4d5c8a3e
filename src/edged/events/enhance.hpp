// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Enhancement of event frames (paper Algorithm 1): blur, equalise, sharpen, find edges, thin them, blend. All gains are
// fixed: nothing is scaled by what the frame holds, so that brightness stays constant for the tracker.
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "edged/core/config.hpp"

namespace edged {

/// I_edge of Algorithm 1.
enum class EdgeMethod {
  None,       ///< no enhancement at all: the event frame passes unchanged
  Clahe,      ///< I_edge = I_enh, the equalised frame itself (the paper tests it, its algorithm leaves it out)
  Canny,      ///< one pixel wide, 0 or 255
  Laplacian,  ///< magnitude of the second derivative, four neighbours
  Sobel,      ///< magnitude of the slope, 3x3
  Scharr,     ///< the same with a kernel of better rotational symmetry
};

enum class Sharpening {
  None,
  Paper,    ///< I_clahe + lambda (I_clahe - I_blur): amplifies what the equalisation did, not the detail
  Unsharp,  ///< I_clahe + lambda (I_clahe - G * I_clahe): unsharp masking
};

enum class MagnitudeNorm {
  L2,  ///< sqrt(gx^2 + gy^2): the same for edges of every direction
  L1,  ///< |gx| + |gy|: up to 1.41 times stronger on diagonals
};

struct EnhanceConfig {
  EdgeMethod method = EdgeMethod::None;
  double blur_sigma_px = 0.8;
  double clahe_clip = 2.0;
  int clahe_tiles = 4;
  Sharpening sharpening = Sharpening::None;
  double sharpen_lambda = 0.5;
  double unsharp_sigma_px = 2.0;
  double edge_gain = 2.0;
  MagnitudeNorm norm = MagnitudeNorm::L2;
  double canny_low = 8.0;
  double canny_high = 20.0;
  int erosion_px = 0;
  double event_weight = 0.7;  ///< alpha of Algorithm 1
  double edge_weight = 0.3;   ///< beta

  void visit(ConfigFields& fields);

  /// Throws InputError with the reason when options contradict each other. `group` is the prefix of the keys it names.
  void validate(const std::string& group = "enhance") const;
};

/// Algorithm 1 on a CV_8UC1 event frame: saturate(event_weight * I_event + edge_weight * I_edge), CV_8UC1. With
/// EdgeMethod::None the frame itself, not a copy. The config must be valid.
cv::Mat enhance(const cv::Mat& event_frame, const EnhanceConfig& config);

struct EnhanceStage {
  std::string name;  ///< fit for a file name
  cv::Mat image;     ///< CV_8UC1
};

/// Every image on the way, in order: event_frame, blur, clahe, sharpened, edge, eroded, result. Steps that are off are
/// left out; EdgeMethod::None gives event_frame and result.
std::vector<EnhanceStage> enhancement_stages(const cv::Mat& event_frame, const EnhanceConfig& config);

}  // namespace edged
