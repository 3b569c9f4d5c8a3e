// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The one interface of everything that can be run: a recording on disk or the simulator.
#pragma once

#include <cstddef>
#include <map>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/state.hpp"

namespace edged {

/// The true motion, where the recording has it.
struct GroundTruth {
  Trajectory trajectory;  ///< T_W_X, in time order
  /// X: "body" or the name of the camera whose pose it is; stamps are on that sensor's clock.
  std::string frame = "body";
};

/// One of the streams that lie in a recording, read or not.
struct StreamInfo {
  std::string name;       ///< topic, or name in the file
  std::string type;       ///< type of its messages
  std::size_t count = 0;  ///< number of messages; 0 where it is not known
  /// "events", "frames", "imu", "truth", an external sensor, of several cameras of a kind the name; "" where it is not
  /// read.
  std::string role;
};

/// A camera whose measurements a recording delivers.
struct RecordedCamera {
  std::string name;  ///< camera of its measurements
  Modality modality = Modality::Frames;
  std::string stream = {};  ///< its topic, stream or file; "" where there is only one
  cv::Size sensor = {};     ///< size of an event camera [px]; empty where it is not known
};

/// What is known of a recording before it is read through.
struct DatasetInfo {
  std::string name;    ///< folder name or simulator preset
  std::string format;  ///< "ecd", "euroc", "simulator", ...
  /// The frame whose poses are compared with the ground truth: that of the ground truth; "body" without one.
  std::string pose_frame = "body";
  std::optional<Timestamp> begin;  ///< first stamp of any sensor, if known cheaply
  std::optional<Timestamp> end;    ///< last stamp, if known cheaply (for the progress line)
  bool has_events = false, has_frames = false, has_imu = false;
  std::vector<std::string> external;    ///< names of the external sensors that it has, as of `external_sensors()`
  std::vector<StreamInfo> streams;      ///< streams, in formats that name them
  cv::Size event_sensor;                ///< size of the event camera [px]; empty where it is not known
  std::string event_camera = "events";  ///< camera name of its event batches
  std::string frame_camera = "frames";  ///< camera name of its frames
  /// Cameras beside the first of a kind, which the two names above are: event cameras, then frame cameras.
  std::vector<RecordedCamera> more_cameras = {};
};

/// All cameras whose measurements the recording delivers: event cameras, then frame cameras, of each kind the first
/// first.
std::vector<RecordedCamera> recorded_cameras(const DatasetInfo& info);

/// A time-ordered stream of measurements. Each sensor's stamps are on its own clock as recorded; the order is by stamp,
/// ties broken external samples, IMU, events, frame, and of a kind the first camera. Streams: holds a bounded part of
/// the recording in memory at any time; if the clocks of the sensors differ by more, only each sensor by itself is in
/// order.
class Dataset {
 public:
  virtual ~Dataset() = default;

  virtual const DatasetInfo& info() const = 0;

  /// The next measurement, or nothing at the end. An EventBatch ends before the next measurement that is none and spans
  /// at most a few milliseconds; those of two cameras overlap. Throws InputError for what cannot be repaired.
  virtual std::optional<Measurement> next() = 0;

  /// Declares measurements that are not needed: from now on next() may skip them without decoding. Nothing else
  /// changes, except that repairs() counts only what is read.
  virtual void leave_out(Modality /*unwanted*/) {}

  /// Asks for less where reading is too slow for its consumer: from now on next() may leave out that share of the
  /// events, 0 to 1, by blocks evenly spread over time, as early as the format allows. Returns how many it has left out
  /// so far.
  virtual std::size_t skip_events(double /*share*/) { return 0; }

  virtual std::optional<GroundTruth> ground_truth() const { return std::nullopt; }

  /// Repairs made so far, by kind ("events out of order", "frame missing", ...) with their counts.
  virtual std::map<std::string, std::size_t> repairs() const { return {}; }
};

}  // namespace edged
