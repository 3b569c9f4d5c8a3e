// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Bytes read front to back, from a disk or out of an archive.
#pragma once

#include <cstddef>
#include <span>

namespace edged {

/// The bytes of a file from its begin on.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `to` from its front and says how far; 0 only at the end of the file. Throws Damage where the archive is
  /// damaged, InputError where the file system fails.
  virtual std::size_t read(std::span<char> to) = 0;
};

}  // namespace edged
