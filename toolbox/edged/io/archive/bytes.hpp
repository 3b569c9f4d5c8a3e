// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads and writes binary files, and little-endian numbers in bytes that may be damaged.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace edged {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

static_assert(std::endian::native == std::endian::little, "binary formats are copied into numbers as they are");

/// A view of the same bytes as text.
inline std::string_view as_text(ByteSpan bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
inline ByteSpan as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Bytes that violate the format. The reader of the format catches and counts it.
class Damage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads numbers from bytes, one after the other. Throws Damage if the bytes end too early.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : all_(bytes) {}

  template <typename T>
  requires std::is_arithmetic_v<T> T number() {
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  ByteSpan take(std::size_t count) {
    if (count > left()) throw Damage("ends too early");
    const ByteSpan part = all_.subspan(at_, count);
    at_ += count;
    return part;
  }

  std::string_view text(std::size_t count) { return as_text(take(count)); }

  std::size_t at() const { return at_; }
  std::size_t left() const { return all_.size() - at_; }

 private:
  ByteSpan all_;
  std::size_t at_ = 0;
};

/// Appends the bytes of a number in the order of the memory.
template <typename T>
requires std::is_arithmetic_v<T>
void append_number(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

/// The bytes of a file, from its beginning on.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Reads bytes into `to` and returns their number, 0 only at the end of the file. Throws Damage for a damaged
  /// archive, InputError for an error of the file system.
  virtual std::size_t read(std::span<char> to) = 0;
};

/// Refuses pipes and devices, of which a reader may wait forever, by an InputError.
void require_regular_file(const std::filesystem::path& file);

/// Of a file that has become shorter since it was opened, or whose disk fails.
[[noreturn]] void refuse_shortened_file(const std::string& name);

/// A file for random access.
class BinaryFile {
 public:
  /// Throws InputError when it cannot be opened.
  explicit BinaryFile(const std::filesystem::path& file);

  std::uint64_t size() const { return size_; }
  /// `count` bytes from `offset` on, fewer at the end that the file had when it was opened. Throws InputError if that
  /// is gone.
  Bytes read(std::uint64_t offset, std::size_t count);

 private:
  std::string name_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
};

/// A new file, written sequentially. All members throw InputError if it cannot be written.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& file);

  std::uint64_t size() const { return size_; }
  void write(std::string_view bytes);
  /// Replaces bytes that were written earlier, for values that are known only at the end.
  void overwrite(std::uint64_t offset, std::string_view bytes);
  /// Writes all buffered bytes to the disk.
  void flush();

 private:
  void check() const;

  std::string name_;
  std::ofstream file_;
  std::uint64_t size_ = 0;
};

}  // namespace edged
