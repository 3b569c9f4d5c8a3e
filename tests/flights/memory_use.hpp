// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How much memory the process holds.
#pragma once

#include <malloc.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <string>

namespace edged {

/// Resident memory [MB], without what the allocator keeps for later.
inline double resident_mb() {
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  double total = 0, resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

/// The most that has been resident since forget_most_resident() [MB]; NaN where the kernel does not tell.
inline double most_resident_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0.0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  }
  return std::numeric_limits<double>::quiet_NaN();
}
inline void forget_most_resident() { std::ofstream("/proc/self/clear_refs") << 5; }

}  // namespace edged
