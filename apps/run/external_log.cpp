// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// external.csv: the samples of height and velocity sensors, for the report.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <fstream>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
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
    ++summary_[std::string(sensor.name)].samples;
  }

  void on_summary(RunEnd& end) override {
    file_.flush();
    const OdometryCounters counters = run_.odometry.counters();
    for (std::size_t i = 0; i < external_sensors().size(); ++i) {
      const auto came = summary_.find(std::string(external_sensors()[i].name));
      if (came == summary_.end()) continue;
      came->second.used = counters.external.used[i];
      came->second.rejected = counters.external.rejected[i];
      came->second.late = counters.packets.external_late[i];
    }
    end.summary.external = summary_;
  }

 private:
  const RunContext& run_;
  std::ofstream file_;
  std::map<std::string, ExternalSummary> summary_;
};

}  // namespace

std::unique_ptr<RunObserver> observe_external(RunContext& run) { return std::make_unique<ExternalLog>(run); }

}  // namespace edged
