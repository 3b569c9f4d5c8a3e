// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/flicker.hpp"

#include <cmath>
#include <numbers>

#include "edged/core/statistics.hpp"
#include "edged/events/tuning.hpp"

namespace edged {
namespace {

constexpr std::size_t kBins = PolaritySpectrum::kBins;
const double kWindow_s = to_seconds(PolaritySpectrum::kWindow);

/// cos and sin of 2 pi i / kBins.
const std::array<std::complex<double>, kBins>& circle() {
  static const auto values = [] {
    std::array<std::complex<double>, kBins> all;
    for (std::size_t i = 0; i < kBins; ++i)
      all[i] = std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(i) / kBins);
    return all;
  }();
  return values;
}

double hann(std::size_t bin) { return 0.5 - 0.5 * circle()[bin].real(); }

}  // namespace

void PolaritySpectrum::add(Timestamp begin, std::span<const Event> events) {
  for (auto event = events.begin(); event != events.end();) {
    const auto bin = (event->t - begin) / kBin;
    const Timestamp end = begin + (bin + 1) * kBin;
    const auto first = event;
    std::uint32_t positive = 0;
    for (; event != events.end() && event->t < end; ++event) positive += event->positive;
    positive_[static_cast<std::size_t>(bin)] += positive;
    negative_[static_cast<std::size_t>(bin)] += static_cast<std::uint32_t>(event - first) - positive;
  }
}

double PolaritySpectrum::weight() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) sum += hann(i) * (positive_[i] + negative_[i]);
  return sum;
}

/// Weighted, without the mean polarity, which stamps in steps would turn into components.
PolaritySpectrum::Signal PolaritySpectrum::balanced() const {
  double all = 0.0, balance = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) {
    const double up = positive_[i], down = negative_[i];
    all += hann(i) * (up + down), balance += hann(i) * (up - down);
  }
  const double mean = all > 0.0 ? balance / all : 0.0;
  Signal signal;
  for (std::size_t i = 0; i < kBins; ++i) {
    const double up = positive_[i], down = negative_[i];
    signal[i] = hann(i) * (up - down - mean * (up + down));
  }
  return signal;
}

std::complex<double> PolaritySpectrum::component(const Signal& signal, std::size_t cycles) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0, at = 0; i < kBins; ++i, at = (at + cycles) % kBins) sum += signal[i] * circle()[at];
  return sum;
}

std::optional<LampCycle> PolaritySpectrum::lamp(Timestamp begin) const {
  const double all = weight();
  if (all < kEventsTuning.lamp_min_events) return std::nullopt;
  const Signal signal = balanced();
  const auto first = static_cast<std::size_t>(kEventsTuning.lamp_min_hz * kWindow_s),
             last = static_cast<std::size_t>(kEventsTuning.lamp_max_hz * kWindow_s);
  std::vector<double> size;  // of the components from first to last
  for (std::size_t k = first; k <= last; ++k) size.push_back(std::abs(component(signal, k)));
  const auto peak = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
  const double usual = median(size);
  double noise = 0.0;
  for (std::size_t i = 0; i < kBins; ++i) noise += hann(i) * hann(i) * (positive_[i] + negative_[i]);
  const double power = size[peak] * size[peak];
  if (size[peak] < kEventsTuning.lamp_min_swing * all || power < kEventsTuning.lamp_min_power_ratio * noise ||
      power < kEventsTuning.lamp_min_power_ratio * usual * usual)
    return std::nullopt;
  // A sine between two components has both of them; by the Hann window their ratio gives its place.
  const double left = peak > 0 ? size[peak - 1] : 0.0, right = peak + 1 < size.size() ? size[peak + 1] : 0.0;
  const double beside = std::max(left, right), shift = (2.0 * beside - size[peak]) / (size[peak] + beside);
  const double hz = (static_cast<double>(first + peak) + (right > left ? shift : -shift)) / kWindow_s;
  // The Hann window is symmetric, so the component has the phase of the sine in the middle of the window.
  const double turns = std::arg(component(signal, first + peak)) / (2.0 * std::numbers::pi);
  const double since_middle_s = (turns - 0.5 * static_cast<double>(first + peak)) / hz;
  return LampCycle{hz, begin + kWindow / 2 + duration_from_seconds(since_middle_s)};
}

void FlickerDetector::end_window(Timestamp t) {
  const std::optional<LampCycle> last = found_;
  // After a gap a new window begins with the event.
  const bool follows = window_begin_ != Timestamp::min() && t < window_begin_ + 2 * PolaritySpectrum::kWindow;
  found_ = follows ? spectrum_.lamp(window_begin_) : std::nullopt;
  missed_ = found_ ? 0 : missed_ + 1;
  before_ = lamp_;
  if (found_ && last && std::abs(found_->hz - last->hz) < 1.0 / kWindow_s) {
    // The crests of two windows give the frequency more exactly than one spectrum does.
    const double between_s = to_seconds(found_->crest - last->crest), cycles = std::round(between_s * found_->hz);
    if (cycles > 0.0) found_->hz = cycles / between_s;
    lamp_ = found_;
  }
  if (missed_ >= kEventsTuning.lamp_missed_windows) lamp_.reset();
  spectrum_.clear();
  window_begin_ = follows ? window_begin_ + PolaritySpectrum::kWindow : t;
}

void FlickerFilter::prepare() {
  if (!detector_.lamp()) return recent_.clear();
  reach_us_ = static_cast<std::uint32_t>(1e6 * kEventsTuning.lamp_reach / detector_.lamp()->hz);
}

bool FlickerFilter::returns(const Event& event) {
  const std::uint32_t now =
      static_cast<std::uint32_t>(to_ns(event.t) / 1000) << 1U | static_cast<std::uint32_t>(event.positive);
  if (recent_.empty()) {
    Recent old;
    old.fill(now - 0x40000000U);
    recent_.assign(pixels_, old);
  }
  Recent& recent = recent_[event.y * width_ + event.x];
  // The least change of the light from any instant within the reach until now, in events of this polarity.
  int change = 1, least = 1, events = 0;
  for (const std::uint32_t past : recent) {
    if ((now - past) >> 1U > reach_us_) break;
    change += ((now ^ past) & 1U) != 0 ? -1 : 1;
    least = std::min(least, change);
    ++events;
  }
  std::copy_backward(recent.begin(), recent.end() - 1, recent.end());
  recent.front() = now;
  return kEventsTuning.lamp_events_per_surplus * least <= events;
}

}  // namespace edged
