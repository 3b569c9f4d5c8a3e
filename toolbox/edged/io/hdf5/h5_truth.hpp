// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ground truth that is HDF5 itself: in the file of the events, or in one beside it (MVSEC, M3ED).
#pragma once

#include <functional>
#include <optional>

#include "edged/core/dataset.hpp"
#include "edged/io/hdf5/layouts.hpp"
#include "edged/io/repairs.hpp"

namespace edged {

/// Reads it when called; empty where there is none.
std::function<std::optional<GroundTruth>(Repairs&)> find_h5_truth(const H5File& events_file, const Hdf5Layout& layout);

}  // namespace edged
