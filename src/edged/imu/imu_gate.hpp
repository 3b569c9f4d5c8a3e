// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Refuses IMU samples that no working sensor gives: what is missing then is a gap.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "edged/counters.hpp"
#include "edged/measurement.hpp"

namespace edged {

struct ImuFaultInfo {
  std::string_view key;     ///< in Python
  std::string_view text;    ///< of so many IMU samples
  std::string_view remedy;  ///< what the user can do
};
/// In the order of ImuFault.
const ByImuFault<ImuFaultInfo>& imu_fault_infos();

struct ImuFaultRecord {
  std::size_t count = 0;  ///< samples
  Timestamp from;         ///< of the longest stretch; of the first sample, where stretches have no length
  Duration longest{0};    ///< in which a reading was repeated
  unsigned axes = 0;      ///< bits of the axes that were repeated: gyro x, y, z, accelerometer x, y, z
};
using ImuFaultRecords = ByImuFault<ImuFaultRecord>;

/// A sample passes at once, unless it leaves its neighbours or repeats them: then it is held until the next ones tell,
/// at most as long as chance explains the repetition. Samples that share a stamp are held until the next stamp.
class ImuGate {
 public:
  /// Counts continue from so_far.
  explicit ImuGate(const ImuFaultCounts& so_far = {});

  /// The samples that pass now, in order; valid until the next call.
  std::span<const ImuSample> push(const ImuSample& sample);
  /// The end of the stream: all that is held.
  std::span<const ImuSample> finish();
  /// Those of the last call.
  std::span<const ImuSample> passed() const { return passed_; }

  const ImuFaultRecords& faults() const { return faults_; }
  ImuFaultCounts counts() const;

 private:
  using Reading = Eigen::Matrix<double, 6, 1>;  ///< gyro, accelerometer
  struct Repetition {
    double surprise = 0.0;  ///< - ln of the probability that the sensor's resolution repeats readings so long
    unsigned axes = 0;      ///< bits
    Timestamp since;        ///< the first of the equal readings
  };
  static Reading reading_of(const ImuSample& sample);
  std::optional<ImuFault> fault_of(const ImuSample& sample) const;
  void share_stamp(const ImuSample& sample);
  void end_burst();
  void judge(const ImuSample& sample);
  void count_repeats(const ImuSample& sample);
  Repetition repetition() const;
  ImuFault fault_of(const Repetition& repeated) const;
  bool leaves(const ImuSample& sample) const;
  bool returns(const ImuSample& jump, const ImuSample& sample) const;
  void pass(const ImuSample& sample);
  void count(ImuFault fault, Timestamp from, Duration length = Duration(0), unsigned axes = 0);

  ImuFaultRecords faults_{};
  std::vector<ImuSample> passed_;           // by this call
  std::optional<ImuSample> newest_, last_;  // received, passed
  // Bursts: samples with one stamp.
  std::vector<ImuSample> burst_;
  Timestamp burst_before_;
  Duration spacing_{0};  // of the samples of the last one
  // Repetition.
  std::array<std::size_t, 6> repeats_{};      // of the newest reading of each axis
  std::array<Timestamp, 6> repeats_since_{};  // the first of the equal ones
  std::vector<ImuSample> held_;
  std::size_t neighbours_ = 0;                  // in this window
  Reading seen_ = Reading::Zero();              // the reading before
  Reading quantum_ = Reading::Constant(1e300);  // smallest change so far: the resolution
  Reading step_ = Reading::Zero();              // largest change of late, halved with each
  // Learnt from samples that passed.
  Reading equal_ = Reading::Zero(), weight_ = Reading::Zero();  // equal neighbours in this window; - ln of their share
  Reading largest_ = Reading::Zero();                           // magnitudes
  // Spikes of the gyro.
  std::optional<ImuSample> jump_;
  double usual_jump_ = 0.0;  // [rad/s]
  bool learnt_ = false;      // a whole window
  bool bursts_ = false;      // samples come with one stamp
};

}  // namespace edged
