// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Bytes read sequentially, from a disk or from an archive.
#pragma once

#include <cstddef>
#include <span>

namespace edged {

/// The bytes of a file, from its beginning on.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Reads bytes into `to` and returns their number, 0 only at the end of the file. Throws Damage for a damaged
  /// archive, InputError for an error of the file system.
  virtual std::size_t read(std::span<char> to) = 0;
};

}  // namespace edged
