// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording with one text file per sensor, which are merged by stamp. The formats differ only in the TextLayout.
#pragma once

#include <functional>
#include <memory>
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

/// The recording of these files. Throws InputError if no sensor has a readable line.
std::unique_ptr<Dataset> open_text(TextLayout layout);

}  // namespace edged
