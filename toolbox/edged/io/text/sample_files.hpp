// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Text files of IMU samples and of external sensors (height, velocity) beside a recording.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/dataset.hpp"
#include "edged/io/archive/source_path.hpp"

namespace edged {

/// The recording, with its IMU samples, if any, replaced by those of the file. Throws InputError, with both time spans,
/// if they do not overlap, unless the file has a clock of its own, and as find_imu_table().
std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file,
                                       bool own_clock = false);

/// The recording, with the samples of that sensor replaced by those of the file. A line has the columns of
/// `layout_of(sensor)`, or of a heading: columns in any order, units in brackets. The unit of stamps, if not named,
/// follows from their size. Throws InputError for a heading that lacks a column, and if the clocks differ.
std::unique_ptr<Dataset> with_external_file(std::unique_ptr<Dataset> recording, const ExternalSensor& sensor,
                                            const SourcePath& file);

/// The recording with the files of the folder: NAME.txt, NAME.csv or NAME0/data.csv of each external sensor.
std::unique_ptr<Dataset> with_external_files(std::unique_ptr<Dataset> recording, const SourcePath& folder);

/// The file names that with_external_files searches in a folder.
std::set<std::string> external_file_names();

}  // namespace edged
