// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/rate_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "edged/checks/agreement/gyro_integral.hpp"

namespace edged {
namespace {

constexpr Duration kFarthestTurns = std::chrono::milliseconds(100);  // between the middles of turns of one motion
constexpr Duration kBlock = std::chrono::seconds(30);                // of the gyro, integrated at a time
constexpr Duration kLeastOverlap = std::chrono::seconds(3);
constexpr double kOverlapShare = 0.4;    // of the shorter of the two
constexpr double kLeastChange = 0.03;    // RMS of the changes of a turn rate [rad/s]: below it noise decides
constexpr double kLeastRateMatch = 0.5;  // correlation at the right offset; two people in view of events leave 0.56
// Than at any other offset: 1.67 times and more at the right one of simulated recordings, up to 1.58 with the gyro of
// another time.
constexpr double kFarClearer = 1.65;
constexpr Duration kPeak = std::chrono::milliseconds(200);  // least half width of a peak

const Eigen::Vector3d kUnknown = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

std::size_t steps(Duration length) {
  return static_cast<std::size_t>(std::max(length / RateSeries::kStep, Duration::rep{0}));
}

Timestamp middle(const Turn& turn) { return turn.begin + (turn.end - turn.begin) / 2; }

/// The sum over i of a[i] * b[i + lag] for each lag; negative ones are at the end.
cv::Mat cross(const cv::Mat& a_spectrum, const cv::Mat& b_spectrum) {
  cv::Mat product, result;
  cv::mulSpectrums(b_spectrum, a_spectrum, product, 0, true);
  cv::idft(product, result, cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return result;
}

/// The spectra that the sums over any overlap need.
struct Spectra {
  cv::Mat known, square, axis[3];

  Spectra(const RateSeries& series, int length) {
    cv::Mat known_at(1, length, CV_64F, cv::Scalar(0)), square_at = known_at.clone(), axis_at[3];
    for (cv::Mat& axis_row : axis_at) axis_row = known_at.clone();
    for (std::size_t i = 0; i < series.rates.size(); ++i) {
      const Eigen::Vector3d& rate = series.rates[i];
      if (!rate.allFinite()) continue;
      const int at = static_cast<int>(i);
      known_at.at<double>(at) = 1.0;
      square_at.at<double>(at) = rate.squaredNorm();
      for (int k = 0; k < 3; ++k) axis_at[k].at<double>(at) = rate[k];
    }
    cv::dft(known_at, known);
    cv::dft(square_at, square);
    for (int k = 0; k < 3; ++k) cv::dft(axis_at[k], axis[k]);
  }
};

/// Pearson's correlation over the three axes together, each about its mean in the overlap, by lag.
struct Correlations {
  cv::Mat count, both, camera_square, gyro_square, camera_sum[3], gyro_sum[3];

  Correlations(const Spectra& camera, const Spectra& gyro)
      : count(cross(camera.known, gyro.known)),
        both(cross(camera.axis[0], gyro.axis[0]) + cross(camera.axis[1], gyro.axis[1]) +
             cross(camera.axis[2], gyro.axis[2])),
        camera_square(cross(camera.square, gyro.known)),
        gyro_square(cross(camera.known, gyro.square)) {
    for (int k = 0; k < 3; ++k) {
      camera_sum[k] = cross(camera.axis[k], gyro.known);
      gyro_sum[k] = cross(camera.known, gyro.axis[k]);
    }
  }

  double overlap(int at) const { return std::round(count.at<double>(at)); }

  double operator()(int at) const {
    const double n = overlap(at);
    double covariance = both.at<double>(at), c = camera_square.at<double>(at), g = gyro_square.at<double>(at);
    for (int k = 0; k < 3; ++k) {
      const double of_camera = camera_sum[k].at<double>(at), of_gyro = gyro_sum[k].at<double>(at);
      covariance -= of_camera * of_gyro / n;
      c -= of_camera * of_camera / n;
      g -= of_gyro * of_gyro / n;
    }
    const double least = n * kLeastChange * kLeastChange;
    return c > least && g > least ? std::clamp(covariance / std::sqrt(c * g), -1.0, 1.0) : 0.0;
  }
};

double known_in(const RateSeries& series) {
  return static_cast<double>(
      std::ranges::count_if(series.rates, [](const Eigen::Vector3d& r) { return r.allFinite(); }));
}

/// How far a correlation is from chance (Fisher's transformation): times the root of their number, in sigmas of
/// independent values.
double clearness_of(double correlation) { return std::atanh(std::clamp(correlation, 0.0, 1.0 - 1e-9)); }

/// Where the parabola through three values has its top, from the middle one on [steps].
double top_of(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace

RateSeries camera_rates(std::span<const Turn> turns, const Eigen::Matrix3d& R_B_C) {
  RateSeries series;
  if (turns.empty()) return series;
  series.begin = middle(turns.front());
  series.rates.assign(steps(middle(turns.back()) - series.begin) + 1, kUnknown);
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
    const Timestamp from = middle(turns[i]), to = middle(turns[i + 1]);
    if (to <= from || to - from > kFarthestTurns) continue;
    const auto rate = [&](const Turn& turn) {
      return Eigen::Vector3d(R_B_C * turn.phi_C / to_seconds(turn.end - turn.begin));
    };
    const Eigen::Vector3d first = rate(turns[i]), second = rate(turns[i + 1]);
    for (std::size_t at = steps(from - series.begin + RateSeries::kStep - Duration(1)); at < series.rates.size();
         ++at) {
      const Timestamp t = series.begin + static_cast<Duration::rep>(at) * RateSeries::kStep;
      if (t > to) break;
      series.rates[at] = first + (second - first) * (to_seconds(t - from) / to_seconds(to - from));
    }
  }
  return series;
}

RateSeries gyro_rates(std::span<const ImuSample> samples, Duration window) {
  RateSeries series;
  if (samples.empty() || window <= Duration(0)) return series;
  series.begin = samples.front().t;
  const Timestamp end = samples.back().t;
  series.rates.assign(steps(end - series.begin) + 1, kUnknown);
  const auto first_from = [&](Timestamp t) { return std::ranges::lower_bound(samples, t, {}, &ImuSample::t); };
  std::size_t at = 0;
  for (Timestamp block = series.begin; block <= end; block += kBlock) {
    GyroIntegral gyro;
    const auto last = first_from(block + kBlock + 2 * window);
    for (auto sample = first_from(block - 2 * window); sample != last; ++sample) gyro.add(*sample);
    for (; at < series.rates.size(); ++at) {
      const Timestamp t = series.begin + static_cast<Duration::rep>(at) * RateSeries::kStep;
      if (t >= block + kBlock) break;
      const auto phi = gyro.between(t - window / 2, t + window / 2);
      if (phi) series.rates[at] = *phi / to_seconds(window);
    }
  }
  return series;
}

void use_speeds(RateSeries& series) {
  for (Eigen::Vector3d& rate : series.rates) rate = Eigen::Vector3d(rate.norm(), 0.0 * rate.y(), 0.0 * rate.z());
}

std::optional<RateMatch> match_rates(const RateSeries& camera, const RateSeries& gyro) {
  const int of_camera = static_cast<int>(camera.rates.size()), of_gyro = static_cast<int>(gyro.rates.size());
  if (of_camera == 0 || of_gyro == 0) return std::nullopt;
  const int length = cv::getOptimalDFTSize(of_camera + of_gyro);
  const Correlations correlations(Spectra(camera, length), Spectra(gyro, length));
  const double enough =
      std::max(static_cast<double>(steps(kLeastOverlap)), kOverlapShare * std::min(known_in(camera), known_in(gyro)));
  const int lags = of_camera + of_gyro - 1, first = 1 - of_camera;
  const auto at = [&](int i) { return (first + i + length) % length; };
  std::vector<double> correlation(static_cast<std::size_t>(lags)), clearness(correlation.size()),
      score(correlation.size());
  for (int i = 0; i < lags; ++i) {
    const double overlap = correlations.overlap(at(i));
    if (overlap < enough) continue;
    const auto place = static_cast<std::size_t>(i);
    correlation[place] = correlations(at(i));
    clearness[place] = clearness_of(correlation[place]);
    score[place] = clearness[place] * std::sqrt(overlap);
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(score) - score.begin());
  if (score[best] <= 0.0) return std::nullopt;
  std::size_t low = best, high = best;
  while (low > 0 && (score[low] > score[best] / 2 || best - low < steps(kPeak))) --low;
  while (high + 1 < score.size() && (score[high] > score[best] / 2 || high - best < steps(kPeak))) ++high;
  std::vector<double> others = clearness;
  std::fill(others.begin() + static_cast<std::ptrdiff_t>(low), others.begin() + static_cast<std::ptrdiff_t>(high) + 1,
            0.0);
  const auto next = static_cast<std::size_t>(std::ranges::max_element(others) - others.begin());
  const auto shift_of = [&](double place) {
    return gyro.begin - camera.begin + duration_from_seconds((first + place) * to_seconds(RateSeries::kStep));
  };
  const double before = best > 0 ? score[best - 1] : 0.0, after = best + 1 < score.size() ? score[best + 1] : 0.0;
  RateMatch match;
  match.shift = shift_of(static_cast<double>(best) + top_of(before, score[best], after));
  match.correlation = correlation[best];
  match.next_shift = shift_of(static_cast<double>(next));
  match.next_correlation = correlation[next];
  match.overlap = static_cast<Duration::rep>(correlations.overlap(at(static_cast<int>(best)))) * RateSeries::kStep;
  match.unique = match.correlation > kLeastRateMatch && clearness[best] > kFarClearer * others[next];
  return match;
}

}  // namespace edged
