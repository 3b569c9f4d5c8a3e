// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/distortion.hpp"

#include <algorithm>
#include <array>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

/// In the order of OpenCV. radtan has the first five, rational the first eight.
constexpr std::array<std::string_view, 14> kOpenCvNames = {"k1", "k2", "p1", "p2", "k3", "k4", "k5",
                                                           "k6", "s1", "s2", "s3", "s4", "tx", "ty"};

bool is_of_opencv(const LensModel& lens) {
  return lens.model == DistortionModel::RadTan || lens.model == DistortionModel::Rational;
}

/// As in OpenCV, where the number of coefficients chooses between these models. `rational`, our own name, is kept.
const LensModel* opencv_model(const std::string& name, const std::vector<double>& k) {
  const std::size_t fewest = lens_model(DistortionModel::RadTan).max_coefficients,
                    most = lens_model(DistortionModel::Rational).max_coefficients;
  bool rational = name == "rational" && k.size() >= most;
  for (std::size_t i = fewest; i < std::min(most, k.size()); ++i) rational |= k[i] != 0.0;
  return &lens_model(rational ? DistortionModel::Rational : DistortionModel::RadTan);
}

/// Throws InputError for a nonzero coefficient that the model lacks.
void refuse_others(const LensModel& lens, const std::vector<double>& k) {
  const auto from = k.begin() + static_cast<std::ptrdiff_t>(std::min(lens.max_coefficients, k.size()));
  const auto first = std::find_if(from, k.end(), [](double x) { return x != 0.0; });
  if (first == k.end()) return;
  const auto place = static_cast<std::size_t>(first - k.begin());
  const bool named = is_of_opencv(lens) && place < kOpenCvNames.size();
  throw InputError::format(
      "distortion {} has {} coefficient{}, here are {}, and {} = {} is not supported: calibrate with one of {}",
      lens.name, lens.max_coefficients, lens.max_coefficients == 1 ? "" : "s", k.size(),
      named ? std::string(kOpenCvNames[place]) : fmt::format("number {}", place + 1), *first, lens_model_names());
}

}  // namespace

Distortion make_distortion(std::string_view given, const std::vector<double>& k) {
  const std::string name = given.empty() ? "none" : lower_case(given);
  const LensModel* lens = find_lens_model(name);
  if (!lens) {
    const bool zeros = std::all_of(k.begin(), k.end(), [](double x) { return x == 0.0; });
    if (zeros && !k.empty()) return {};
    throw InputError::format("distortion {} is not supported; these are: {}", name, lens_model_names());
  }
  if (is_of_opencv(*lens)) lens = opencv_model(name, k);
  if (!k.empty() && k.size() != lens->min_coefficients && k.size() < lens->max_coefficients)
    throw InputError::format(
        "{} takes {}{} numbers ({}), here are {}", lens->name, lens->min_coefficients,
        lens->max_coefficients > lens->min_coefficients ? fmt::format(" or {}", lens->max_coefficients) : "",
        lens->coefficients, k.size());
  refuse_others(*lens, k);
  Distortion out{lens->model, {}};
  std::copy_n(k.begin(), std::min(lens->max_coefficients, k.size()), out.k.begin());
  return out;
}

}  // namespace edged
