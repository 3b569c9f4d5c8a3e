// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// external.csv: the samples of height and velocity sensors, for the report.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <fstream>

#include "edged/core/external_sensor.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

/// The file is created with the first sample.
class ExternalLog : public RunObserver {
 public:
  explicit ExternalLog(const RunContext& run) : run_(run) {}

  void on_measurement(const Measurement& measurement) override {
    const auto* sample = std::get_if<ExternalSample>(&measurement);
    if (sample == nullptr) return;
    const ExternalSensor& sensor = sensor_of(*sample);
    if (!file_.is_open()) {
      file_.open(run_.folder / "external.csv");
      file_ << "sensor,t_ns,values,sigmas\n";
    }
    const ExternalNumbers numbers = sensor.numbers(*sample);
    file_ << fmt::format("{},{},{},{}\n", sensor.name, to_ns(time_of(*sample)), fmt::join(numbers.values, ","),
                         fmt::join(numbers.sigmas, ","));
    ++counts_[std::string(sensor.name)];
  }

  void on_summary(RunEnd& end) override {
    file_.flush();
    end.summary.external = counts_;
    end.summary.external_in_packets = run_.odometry.counters().packets.external;
  }

 private:
  const RunContext& run_;
  std::ofstream file_;
  std::map<std::string, std::size_t> counts_;
};

}  // namespace

std::unique_ptr<RunObserver> observe_external(RunContext& run) { return std::make_unique<ExternalLog>(run); }

}  // namespace edged
