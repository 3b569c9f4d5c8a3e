// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib/calib.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "common/command.hpp"
#include "common/files.hpp"
#include "common/interrupt.hpp"
#include "common/reading.hpp"
#include "edged/checks/statistics/allan_deviation.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

using nlohmann::ordered_json;

constexpr std::array kAxisNames = {"gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"};
constexpr std::size_t kAxes = kAxisNames.size(), kGyroAxes = 3;  // the others: of the accelerometer
constexpr double kShortest_s = 60.0, kLongEnough_s = 3600.0;
constexpr double kMostTurn = 0.02,
                 kMostPush = 0.2;           // [rad/s], [m/s^2] of the mean of a second off the first one: at rest
constexpr std::size_t kFirstSamples = 200;  // of which the period is taken
constexpr double kGap = 1.5;                // [periods]
constexpr double kClear = 3.0;              // [sigma] of a random walk that is significant

using Readings = Eigen::Array<double, kAxes, 1>;

Readings readings_of(const ImuSample& sample) {
  Readings all;
  all << sample.gyro_B.array(), sample.accel_B.array();
  return all;
}

/// Allan deviations of all axes of a body at rest.
class RestingImu {
 public:
  void add(const ImuSample& sample) {
    if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) return;
    if (last_ && sample.t <= *last_) return;
    if (!begin_) begin_ = sample.t;
    if (axes_.empty()) {
      first_.push_back(sample);
      last_ = sample.t;
      if (first_.size() == kFirstSamples) begin_clusters();
      return;
    }
    take(sample);
  }

  double length_s() const { return begin_ ? to_seconds(*last_ - *begin_) : 0.0; }
  double rate_Hz() const { return 1.0 / period_s_; }
  const std::vector<AllanDeviation>& axes() const { return axes_; }
  std::size_t gaps() const { return gaps_; }

 private:
  void begin_clusters() {
    std::vector<double> periods;
    for (std::size_t i = 1; i < first_.size(); ++i) periods.push_back(to_seconds(first_[i].t - first_[i - 1].t));
    period_s_ = median(periods);
    axes_.assign(kAxes, AllanDeviation(period_s_));
    last_ = first_.front().t;
    for (const ImuSample& sample : first_) take(sample);
  }

  void take(const ImuSample& sample) {
    if (to_seconds(sample.t - *last_) > kGap * period_s_) {
      ++gaps_;
      for (AllanDeviation& axis : axes_) axis.skip_gap();
    }
    last_ = sample.t;
    const Readings readings = readings_of(sample);
    for (std::size_t axis = 0; axis < kAxes; ++axis) axes_[axis].add(readings[static_cast<Eigen::Index>(axis)]);
    second_ += readings;
    if (++in_second_ * period_s_ >= 1.0) end_second();
  }

  void end_second() {
    second_ /= static_cast<double>(in_second_);
    if (!first_second_) first_second_ = second_;
    const Readings off = (second_ - *first_second_).abs();
    if (off.head<kGyroAxes>().maxCoeff() > kMostTurn || off.tail<kAxes - kGyroAxes>().maxCoeff() > kMostPush)
      throw InputError::format(
          "the IMU moves {:.1f} s after the beginning; record it at rest, on something that does not shake, or choose "
          "a part with --from and --to",
          to_seconds(*last_ - *begin_));
    second_.setZero();
    in_second_ = 0;
  }

  std::vector<ImuSample> first_;
  std::vector<AllanDeviation> axes_;
  std::optional<Timestamp> begin_, last_;
  double period_s_ = 0.0;
  std::size_t gaps_ = 0, in_second_ = 0;
  Readings second_ = Readings::Zero();
  std::optional<Readings> first_second_;
};

/// What a run takes: of the worst axis; a walk that is not significant is the most that it may be.
struct WorstNoise {
  double white = 0.0, walk = 0.0;
  bool significant = false;  ///< the walk
};

bool is_significant(const SignalNoise& noise) { return noise.walk > kClear * noise.walk_sigma; }

double walk_of(const SignalNoise& noise) { return std::max(noise.walk, kClear * noise.walk_sigma); }

WorstNoise worst(std::span<const SignalNoise> axes) {
  WorstNoise out;
  for (const SignalNoise& noise : axes) {
    out.white = std::max(out.white, noise.white);
    if (walk_of(noise) > out.walk) out.significant = is_significant(noise);
    out.walk = std::max(out.walk, walk_of(noise));
  }
  return out;
}

std::string kalibr_yaml(const RestingImu& imu, const std::vector<SignalNoise>& axes) {
  const std::span all(axes);
  const WorstNoise gyro = worst(all.first(kGyroAxes)), accel = worst(all.subspan(kGyroAxes));
  return fmt::format(
      "# Of {:.0f} s at rest by the Allan deviation, the worst axis. In motion, errors of scale and sampling add to "
      "it: for\n# a run use about 5 (gyro) and 2.5 (accelerometer) times the noise.\n"
      "accelerometer_noise_density: {:.3g}  # m/s^2/sqrt(Hz)\n"
      "accelerometer_random_walk: {:.3g}  # m/s^3/sqrt(Hz){}\n"
      "gyroscope_noise_density: {:.3g}  # rad/s/sqrt(Hz)\n"
      "gyroscope_random_walk: {:.3g}  # rad/s^2/sqrt(Hz){}\n"
      "rostopic: /imu\n"
      "update_rate: {:.1f}  # Hz\n",
      imu.length_s(), accel.white, accel.walk, accel.significant ? "" : ", at most", gyro.white, gyro.walk,
      gyro.significant ? "" : ", at most", imu.rate_Hz());
}

std::string text_of(const RestingImu& imu, const std::vector<SignalNoise>& axes) {
  std::string text = fmt::format("{:.0f} s at {:.0f} Hz, {} gaps\n{:<8} {:>12} {:>12} {:>20}\n", imu.length_s(),
                                 imu.rate_Hz(), imu.gaps(), "axis", "noise", "instability", "random walk");
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const SignalNoise& noise = axes[axis];
    text += fmt::format("{:<8} {:>12.3g} {:>12.3g} {:>20}\n", kAxisNames[axis], noise.white, noise.instability,
                        is_significant(noise) ? fmt::format("{:.2g} +- {:.1g}", noise.walk, noise.walk_sigma)
                                              : fmt::format("at most {:.2g}", walk_of(noise)));
  }
  text += "units: gyro rad/s, accelerometer m/s^2; noise per sqrt(Hz), random walk per s per sqrt(Hz)\n";
  if (imu.length_s() < kLongEnough_s)
    text += fmt::format("the random walk shows in an hour or more; this is {:.0f} min\n", imu.length_s() / 60.0);
  return text;
}

ordered_json json_of(const RestingImu& imu, const std::vector<SignalNoise>& axes) {
  ordered_json json = {{"seconds", imu.length_s()}, {"rate_Hz", imu.rate_Hz()}, {"gaps", imu.gaps()}};
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const SignalNoise& noise = axes[axis];
    ordered_json points = ordered_json::array();
    for (const AllanDeviation::Point& point : imu.axes()[axis].points())
      points.push_back({{"tau_s", point.tau_s}, {"deviation", point.deviation}});
    json["axes"].push_back({{"axis", kAxisNames[axis]},
                            {"noise", noise.white},
                            {"instability", noise.instability},
                            {"random_walk", noise.walk},
                            {"random_walk_sigma", noise.walk_sigma},
                            {"allan_deviation", std::move(points)}});
  }
  return json;
}

void read_all(Dataset& dataset, RestingImu& imu, bool quiet) {
  dataset.leave_out(Modality::Events);
  dataset.leave_out(Modality::Frames);
  read_through(dataset, quiet, "read", [&imu](const Measurement& measurement) {
    if (const auto* sample = std::get_if<ImuSample>(&measurement)) imu.add(*sample);
    return true;
  });
}

}  // namespace

int measure_imu_noise(const CalibOptions& options) {
  catch_interrupts();
  if (!options.out.empty()) check_writable(options.out, "--out");
  const Recording recording = open_uncalibrated(options.source_of_file());
  const std::string& name = recording.dataset->info().name;
  RestingImu imu;
  read_all(*recording.dataset, imu, options.quiet);
  if (interrupt_signal() != 0) return exit_code_of_interrupt();
  if (imu.length_s() < kShortest_s || imu.axes().empty())
    throw InputError::format(
        "{}: {:.1f} s of IMU samples; record {:.0f} s at rest, for the random walk an hour or more", name,
        imu.length_s(), kShortest_s);
  std::vector<SignalNoise> axes;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const std::vector<AllanDeviation::Point> points = imu.axes()[axis].points();
    if (points.size() < 3)
      throw InputError::format("{}: {} does not change: a dead sensor, or not in its unit", name, kAxisNames[axis]);
    axes.push_back(fit_noise(points));
  }
  print_result(options.json, json_of(imu, axes), text_of(imu, axes));
  if (options.out.empty()) return kExitOk;
  write_file(options.out, kalibr_yaml(imu, axes));
  if (!options.json)
    fmt::print("written {}\nnext: edged calib CALIBRATION --imu {} --out head.yaml\n", options.out.string(),
               options.out.string());
  return kExitOk;
}

}  // namespace edged
