// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// external.csv: the samples of height and velocity sensors, for the report.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include "common/files.hpp"
#include "common/text.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

/// What becomes of the samples is counted; those not counted came before the first pose, while lost, or after the last
/// packet. The file is created with the first sample.
class ExternalSamples : public RunObserver {
 public:
  explicit ExternalSamples(const RunContext& run) : run_(run) {}

  void on_measurement(const Measurement& measurement) override {
    const auto* sample = std::get_if<ExternalSample>(&measurement);
    if (sample == nullptr) return;
    const ExternalSensor& sensor = sensor_of(*sample);
    if (!file_) file_.emplace(run_.folder / "external.csv", "sensor,t_ns,values,sigmas\n");
    const ExternalNumbers numbers = sensor.numbers(*sample);
    file_->add(fmt::format("{},{},{},{}\n", sensor.name, to_ns(time_of(*sample)), fmt::join(numbers.values, ","),
                           fmt::join(numbers.sigmas, ",")));
    ++samples_[std::string(sensor.name)];
  }

  void on_summary(RunEnd& end) override {
    for (std::size_t i = 0; i < external_sensors().size(); ++i) {
      const auto came = samples_.find(std::string(external_sensors()[i].name));
      if (came == samples_.end()) continue;
      const auto& [name, count] = *came;
      const std::size_t used = end.counters.external.used[i], rejected = end.counters.external.rejected[i],
                        late = end.counters.packets.external_late[i];
      Figures& figures = end.summary.outputs;
      figures.json["external"][name] = {{"samples", count}, {"used", used}, {"rejected", rejected}, {"late", late}};
      figures.line(name, fmt::format("{} used", used),
                   fmt::format("of {}; {} rejected, {} late", quantity(count, "sample"), rejected, late));
    }
  }

 private:
  const RunContext& run_;
  std::optional<TableFile> file_;
  std::map<std::string, std::size_t> samples_;  ///< by sensor
};

}  // namespace

RunOutput external_samples_output() { return always<ExternalSamples>({"external.csv"}); }

}  // namespace edged
