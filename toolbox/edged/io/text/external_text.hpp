// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Samples of external sensors (height, velocity) from text files beside a recording.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "edged/core/external_sensor.hpp"
#include "edged/dataset.hpp"
#include "edged/io/source_path.hpp"

namespace edged {

/// The recording with the samples of the file instead of its own of that sensor. A line is `layout_of(sensor)`, or what
/// a first line names: columns in any order, units in brackets. Without a unit stamps are seconds, or what their size
/// says. Throws InputError for a first line that lacks a column, and where both are not on one clock.
std::unique_ptr<Dataset> with_external_file(std::unique_ptr<Dataset> recording, const ExternalSensor& sensor,
                                            const SourcePath& file);

/// The same with what lies in the folder: NAME.txt, NAME.csv or NAME0/data.csv of each sensor.
std::unique_ptr<Dataset> with_external_files(std::unique_ptr<Dataset> recording, const SourcePath& folder);

/// What with_external_files looks for in a folder, whether it is there or not.
std::set<std::string> external_file_names();

}  // namespace edged
