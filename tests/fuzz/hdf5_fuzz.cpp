// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes through the filters of HDF5 chunks: the first byte chooses the filter, two more the size of the chunk.
#include <array>
#include <cstdlib>

#include "edged/io/hdf5/h5_filters.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  if (size < 3) return 0;
  constexpr std::array kFilters{H5Filter::Lzf, H5Filter::Blosc, H5Filter::Zstd, H5Filter::Ecf};
  const std::size_t chunk_bytes = data[1] + 256U * data[2];
  try {
    if (undo_h5_filter(kFilters[data[0] % 4], {data + 3, size - 3}, chunk_bytes).size() < chunk_bytes) std::abort();
  } catch (const Damage&) {
    return 0;  // the one refusal that is allowed
  }
  return 0;
}
