// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Flicker of lamps in the events of one camera: its frequency, and which events it causes.
#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// The light of a lamp.
struct LampCycle {
  double hz = 0.0;
  Timestamp crest;  ///< when its brightness rises fastest

  /// Phase at t, from the crest on [rad].
  double phase(Timestamp t) const { return 2.0 * std::numbers::pi * hz * to_seconds(t - crest); }
};

/// The spectrum of the polarities of the events in a window of time.
class PolaritySpectrum {
 public:
  static constexpr Duration kBin = std::chrono::microseconds(500);
  static constexpr std::size_t kBins = 512;
  static constexpr Duration kWindow = kBin * kBins;

  /// since: the begin of the window, within the window.
  void add(Duration since, bool positive) {
    ++(positive ? positive_ : negative_)[static_cast<std::size_t>(since / kBin)];
  }
  /// Events in order, the first of them not before the begin, all of them within the window.
  void add(Timestamp begin, std::span<const Event> events);
  void clear() { positive_.fill(0), negative_.fill(0); }

  /// Events, weighted by a Hann window.
  double weight() const;
  /// The swing of `cycles` in the window: positive minus negative events at the crest minus at the trough, over all
  /// events.
  double swing(std::size_t cycles) const { return std::abs(component(balanced(), cycles)) / weight(); }
  /// The light; nothing unless polarities swing together. begin: of the window.
  std::optional<LampCycle> lamp(Timestamp begin) const;

 private:
  using Signal = std::array<double, kBins>;

  Signal balanced() const;
  static std::complex<double> component(const Signal& signal, std::size_t cycles);

  std::array<std::uint32_t, kBins> positive_{}, negative_{};
};

/// Finds a frequency at which the polarities of all events swing together. Motion does not do that: an edge brightens
/// some pixels while it darkens others. Needs two windows of 0.26 s. Memory: 4 kB.
class FlickerDetector {
 public:
  /// True when a window has ended before this event: lamp() may have changed. Stamps should not decrease.
  bool add(Timestamp t, bool positive) {
    const bool ended = t >= window_begin_ + PolaritySpectrum::kWindow;
    if (ended) end_window(t);
    spectrum_.add(since_begin(t), positive);
    return ended;
  }
  /// Events in order, at once. False, without effect, if a window ends before one of them.
  bool add(std::span<const Event> events) {
    if (events.front().t < window_begin_ || events.back().t >= window_begin_ + PolaritySpectrum::kWindow) return false;
    spectrum_.add(window_begin_, events);
    return true;
  }
  /// The lamp, by the windows that have ended; nothing without flicker.
  const std::optional<LampCycle>& lamp() const { return lamp_; }
  /// By those that had ended at t, which is within the present window or the one before.
  const std::optional<LampCycle>& lamp_at(Timestamp t) const { return t < window_begin_ ? before_ : lamp_; }
  /// From the begin of the window; 0 before it.
  Duration since_begin(Timestamp t) const { return std::max(t - window_begin_, Duration(0)); }

 private:
  void end_window(Timestamp t);

  Timestamp window_begin_ = Timestamp::min();
  PolaritySpectrum spectrum_;
  std::optional<LampCycle> found_, lamp_;
  std::optional<LampCycle> before_;  // lamp_ in the window before
  int missed_ = 0;                   // windows without flicker since the last one with it
};

/// Drops the events by which the light of a pixel only returns to what it was within the last cycle of the lamp, while
/// it flickers. Memory: 64 bytes for each pixel while it does.
class FlickerFilter {
 public:
  FlickerFilter(int width, int height)
      : width_(static_cast<std::size_t>(width)), pixels_(width_ * static_cast<std::size_t>(height)) {}

  /// Stamps must not decrease. x and y are within the sensor.
  bool drops(const Event& event) {
    if (detector_.add(event.t, event.positive)) prepare();
    return detector_.lamp() && returns(event);
  }
  /// Whether it drops none of these events, in order. False, without effect, if they are to be asked for one by one.
  bool drops_none(std::span<const Event> events) { return !detector_.lamp() && detector_.add(events); }
  const FlickerDetector& detector() const { return detector_; }

 private:
  /// Stamps [us] with the polarity in the lowest bit, newest first; no pixel has more events in a cycle that matter.
  using Recent = std::array<std::uint32_t, 16>;

  void prepare();
  bool returns(const Event& event);

  std::size_t width_, pixels_;
  FlickerDetector detector_;
  std::uint32_t reach_us_ = 0;
  std::vector<Recent> recent_;  // of each pixel; empty without flicker
};

}  // namespace edged
