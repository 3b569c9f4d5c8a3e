// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Ground truth in HDF5: in the file of the events, or in another file of its folder (MVSEC, M3ED).
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "edged/dataset.hpp"
#include "edged/io/hdf5/layouts.hpp"
#include "edged/io/parse/repairs.hpp"

namespace edged {

/// Ground truth, read on demand.
struct TruthSource {
  std::string frame = "body";                                     ///< X of its T_W_X
  std::function<std::optional<GroundTruth>(Repairs&)> read = {};  ///< empty without ground truth
};

TruthSource find_h5_truth(const H5File& events_file, const Hdf5Layout& layout);

}  // namespace edged
