// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/enhance.hpp"

#include <algorithm>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/events/tuning.hpp"

namespace edged {
namespace {

// OpenCV's kernels are not normalised: their response to a slope of one grey level per pixel.
constexpr double kSobelPerSlope = 8.0, kScharrPerSlope = 32.0;

cv::Mat gaussian(const cv::Mat& image, double sigma_px) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, cv::Size(), sigma_px, sigma_px, cv::BORDER_REFLECT_101);
  return blurred;
}

cv::Mat equalise(const cv::Mat& image, const EnhanceConfig& config) {
  cv::Mat equalised;
  cv::createCLAHE(config.clahe_clip, cv::Size(kEventsTuning.clahe_tiles, kEventsTuning.clahe_tiles))
      ->apply(image, equalised);
  return equalised;
}

cv::Mat sharpen(const cv::Mat& clahe, const cv::Mat& blurred, const EnhanceConfig& config) {
  const bool paper = config.sharpening == Sharpening::Paper;
  const cv::Mat minus = paper ? blurred : gaussian(clahe, kEventsTuning.unsharp_sigma_px);
  cv::Mat sharpened;
  cv::addWeighted(clahe, 1.0 + config.sharpen_lambda, minus, -config.sharpen_lambda, 0.0, sharpened);
  return sharpened;
}

/// gain * |gradient|, saturating.
cv::Mat magnitude(const cv::Mat& gx, const cv::Mat& gy, MagnitudeNorm norm, double gain) {
  cv::Mat sum, scaled;
  if (norm == MagnitudeNorm::L1) {
    cv::add(cv::abs(gx), cv::abs(gy), sum);
  } else {
    cv::magnitude(gx, gy, sum);
  }
  sum.convertTo(scaled, CV_8U, gain);
  return scaled;
}

cv::Mat equalised_alone(const cv::Mat& image, const EnhanceConfig&) { return image; }

cv::Mat canny(const cv::Mat& image, const EnhanceConfig& config) {
  cv::Mat edges;
  cv::Canny(image, edges, kSobelPerSlope * config.canny_low, kSobelPerSlope * config.canny_high, 3,
            config.norm == MagnitudeNorm::L2);
  return edges;
}

cv::Mat laplacian(const cv::Mat& image, const EnhanceConfig& config) {
  cv::Mat second, edges;
  cv::Laplacian(image, second, CV_32F, 1);
  cv::Mat(cv::abs(second)).convertTo(edges, CV_8U, config.edge_gain);
  return edges;
}

cv::Mat sobel(const cv::Mat& image, const EnhanceConfig& config) {
  cv::Mat gx, gy;
  cv::Sobel(image, gx, CV_32F, 1, 0, 3);
  cv::Sobel(image, gy, CV_32F, 0, 1, 3);
  return magnitude(gx, gy, config.norm, config.edge_gain / kSobelPerSlope);
}

cv::Mat scharr(const cv::Mat& image, const EnhanceConfig& config) {
  cv::Mat gx, gy;
  cv::Scharr(image, gx, CV_32F, 1, 0);
  cv::Scharr(image, gy, CV_32F, 0, 1);
  return magnitude(gx, gy, config.norm, config.edge_gain / kScharrPerSlope);
}

/// A row of the table of edge filters.
struct EdgeFilter {
  EdgeMethod method;
  std::string_view name;                                               ///< the option's choice
  cv::Mat (*find)(const cv::Mat& image, const EnhanceConfig& config);  ///< I_edge; null: no enhancement
};

constexpr EdgeFilter kEdgeFilters[] = {
    {EdgeMethod::None, "none", nullptr}, {EdgeMethod::Clahe, "clahe", equalised_alone},
    {EdgeMethod::Canny, "canny", canny}, {EdgeMethod::Laplacian, "laplacian", laplacian},
    {EdgeMethod::Sobel, "sobel", sobel}, {EdgeMethod::Scharr, "scharr", scharr}};

cv::Mat find_edges(const cv::Mat& image, const EnhanceConfig& config) {
  const auto filter = std::ranges::find(kEdgeFilters, config.method, &EdgeFilter::method);
  EDGED_CHECK(filter != std::end(kEdgeFilters) && filter->find, "edge method {}", static_cast<int>(config.method));
  return filter->find(image, config);
}

cv::Mat erode(const cv::Mat& edges, int kernel_px) {
  cv::Mat thin;
  cv::erode(edges, thin, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(kernel_px, kernel_px)));
  return thin;
}

}  // namespace

void EnhanceConfig::visit(ConfigFields& fields) {
  std::vector<std::pair<std::string_view, EdgeMethod>> methods;
  for (const EdgeFilter& filter : kEdgeFilters) methods.emplace_back(filter.name, filter.method);
  fields.choice("method", method, methods,
                {.effect = "Edge map for the enhancement of the event frame (Algorithm 1). none: no enhancement."});
  fields.add("blur_sigma_px", blur_sigma_px, {"px", 0, 10, "Gaussian blur before the equalization. 0: off."});
  fields.add("clahe_clip", clahe_clip,
             {"", 0, 100, "Clip limit of the contrast-limited equalization. 1 is weak, 4 strong, 0 off."});
  fields.choice(
      "sharpening", sharpening,
      {{"none", Sharpening::None}, {"paper", Sharpening::Paper}, {"unsharp", Sharpening::Unsharp}},
      {.effect = "Sharpening after the equalization: as in the paper (CLAHE minus blur), or unsharp masking."});
  fields.add("sharpen_lambda", sharpen_lambda, {"", 0, 10, "Strength of the sharpening."});
  fields.add(
      "edge_gain", edge_gain,
      {"px", 0.01, 100,
       "Grey levels of the edge map per gradient of 1 grey/px (Sobel, Scharr) or per Laplacian of 1 grey/px^2."});
  fields.choice("norm", norm, {{"l2", MagnitudeNorm::L2}, {"l1", MagnitudeNorm::L1}},
                {.effect = "Norm of the gradient (Sobel, Scharr, Canny)."});
  fields.add("canny_low", canny_low, {"grey/px", 0, 255, "Lower gradient threshold of Canny."});
  fields.add("canny_high", canny_high, {"grey/px", 0, 255, "Upper gradient threshold of Canny."});
  fields.add("erosion_px", erosion_px,
             {"px", 0, 15, "Side length of the square that erodes the edge map, odd. 0: off."});
  fields.add("event_weight", event_weight,
             {"", 0, 4, "alpha of Algorithm 1: weight of the event frame in the result."});
  fields.add("edge_weight", edge_weight,
             {"", 0, 4, "beta of Algorithm 1: weight of the edge map. Sums above 1 saturate."});
}

void EnhanceConfig::validate(const std::function<std::string(std::string_view)>& key) const {
  const auto refuse = [&key](bool contradiction, std::string_view text, auto... names) {
    if (contradiction) throw InputError(fmt::format(fmt::runtime(text), key(names)...));
  };
  refuse(erosion_px > 0 && erosion_px % 2 == 0,
         "{} is even, which would shift the edges by half a pixel: give an odd number, or 0 for none", "erosion_px");
  if (method == EdgeMethod::None) return;
  refuse(event_weight + edge_weight <= 0.0, "{} and {} are both 0, which leaves a black image: raise one of them",
         "event_weight", "edge_weight");
  refuse(method == EdgeMethod::Canny && erosion_px > 0,
         "{0} with {1} = canny: Canny's edges are one pixel wide and erosion would delete them all; set {0} = 0 or "
         "take sobel, scharr or laplacian",
         "erosion_px", "method");
  refuse(method == EdgeMethod::Clahe && erosion_px > 0,
         "{0} with {1} = clahe: there is no edge map to thin; set {0} = 0 or take sobel, scharr or laplacian",
         "erosion_px", "method");
  refuse(method == EdgeMethod::Canny && canny_low > canny_high,
         "{} is above {}: an edge must continue above the lower one; swap them", "canny_low", "canny_high");
  refuse(method == EdgeMethod::Clahe && clahe_clip <= 0.0,
         "{} = clahe with {} = 0: the equalisation is off; raise clahe_clip or set method = none", "method",
         "clahe_clip");
  refuse(sharpening == Sharpening::Paper && clahe_clip <= 0.0,
         "{} = paper with {} = 0: without equalisation clahe minus blur is zero; raise clahe_clip or take sharpening = "
         "unsharp",
         "sharpening", "clahe_clip");
  refuse(sharpening != Sharpening::None && sharpen_lambda <= 0.0,
         "{} with {} = 0 sharpens nothing: raise it, or set sharpening = none", "sharpening", "sharpen_lambda");
}

cv::Mat enhance(const cv::Mat& event_frame, const EnhanceConfig& config) {
  EDGED_CHECK(event_frame.type() == CV_8UC1, "event frame of type {}", event_frame.type());
  if (config.method == EdgeMethod::None) return event_frame;
  const cv::Mat blurred = config.blur_sigma_px > 0.0 ? gaussian(event_frame, config.blur_sigma_px) : event_frame;
  cv::Mat image = config.clahe_clip > 0.0 ? equalise(blurred, config) : blurred;
  if (config.sharpening != Sharpening::None) image = sharpen(image, blurred, config);
  cv::Mat edges = find_edges(image, config), result;
  if (config.erosion_px > 0) edges = erode(edges, config.erosion_px);
  cv::addWeighted(event_frame, config.event_weight, edges, config.edge_weight, 0.0, result);
  return result;
}

}  // namespace edged
