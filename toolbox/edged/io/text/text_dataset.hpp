// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording with one text file per sensor, which are merged by stamp. The formats differ only in the TextLayout.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/stamped_lines.hpp"
#include "edged/io/text/event_text.hpp"

namespace edged {

struct EventFile {
  SourcePath file;
  std::string camera;
  int width = 0, height = 0;
  EventColumns columns = {};
};

struct FrameFile {
  std::string camera;
  StampedLines<FrameEntry>::Spec lines;
};

/// The files of a recording, and the format of their lines.
struct TextLayout {
  DatasetInfo info;               ///< name, format and pose_frame
  std::vector<EventFile> events;  ///< one per camera, with different names, as are the frames
  std::vector<FrameFile> frames;
  std::optional<StampedLines<ImuSample>::Spec> imu;
  std::function<std::optional<GroundTruth>(Repairs&)> ground_truth;  ///< may be empty
};

class TextDataset final : public Dataset {
 public:
  /// Throws InputError if no sensor has a readable line.
  explicit TextDataset(TextLayout layout);

  const DatasetInfo& info() const override { return layout_.info; }
  std::optional<Measurement> next() override;
  void leave_out(Modality unwanted) override;
  std::optional<GroundTruth> ground_truth() const override;
  std::map<std::string, std::size_t> repairs() const override;

 private:
  void open_streams();
  void name_cameras();
  void find_ends();
  struct EventStream {
    std::string camera;
    EventTextStream events;
  };
  struct FrameStream {
    std::string camera;
    StampedLines<FrameEntry> lines;
    cv::Size size = {};  ///< size of the first image
  };
  Timestamp next_event_stamp();
  Timestamp next_frame_stamp() const;
  EventBatch take_events(Timestamp end);
  std::optional<Frame> load_next_frame();

  TextLayout layout_;
  Repairs repairs_;
  mutable Repairs ground_truth_repairs_;  ///< made in the last reading, so that repeated readings are not counted twice
  std::vector<EventStream> events_;
  std::vector<FrameStream> frames_;
  std::optional<StampedLines<ImuSample>> imu_;
};

}  // namespace edged
