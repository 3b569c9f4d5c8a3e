// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How much memory the process holds.
#pragma once

#include <malloc.h>
#include <unistd.h>

#include <fstream>

namespace edged {

/// Resident memory [MB], without what the allocator keeps for later.
inline double resident_mb() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

}  // namespace edged
