// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads HDF5 files by rows. Wraps the C library in handles that close themselves, with Damage and InputError as errors.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "edged/io/archive/bytes.hpp"

namespace edged {

/// An object of the library, which the destructor closes. False if it could not be opened.
class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);

  H5Handle() = default;
  H5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  H5Handle& operator=(H5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~H5Handle() {
    if (id_ >= 0) close_(id_);
  }

  explicit operator bool() const { return id_ >= 0; }
  hid_t get() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// Registers the filters and disables error messages of the library. To be called before a file is opened or created.
void prepare_h5();

template <typename T>
hid_t h5_native_type() {
  static_assert(std::is_arithmetic_v<T>);
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (sizeof(T) == 1) return std::is_signed_v<T> ? H5T_NATIVE_INT8 : H5T_NATIVE_UINT8;
  if constexpr (sizeof(T) == 2) return std::is_signed_v<T> ? H5T_NATIVE_INT16 : H5T_NATIVE_UINT16;
  if constexpr (sizeof(T) == 4) return std::is_signed_v<T> ? H5T_NATIVE_INT32 : H5T_NATIVE_UINT32;
  return std::is_signed_v<T> ? H5T_NATIVE_INT64 : H5T_NATIVE_UINT64;
}

/// A data set of a file, read by rows. A row is the values of one first index.
class H5Array {
 public:
  /// Takes ownership of an open data set. Throws Damage for one that is not readable at all.
  H5Array(H5Handle data, std::string path);

  const std::string& path() const { return path_; }
  const std::vector<std::uint64_t>& shape() const { return shape_; }
  std::uint64_t rows() const { return shape_.empty() ? 1 : shape_.front(); }
  /// Values in a row.
  std::size_t columns() const { return columns_; }
  bool floating() const { return type_ == H5T_FLOAT; }
  bool compound() const { return type_ == H5T_COMPOUND; }
  /// True for unsigned integers.
  bool unsigned_integer() const { return unsigned_; }
  /// True for a compound type with these fields.
  bool has_fields(std::initializer_list<const char*> names) const;

  /// Rows [first, first + count), converted to T and clamped to its range. Throws Damage.
  template <typename T>
  std::vector<T> read(std::uint64_t first, std::uint64_t count) const {
    std::vector<T> values(checked_size(first, count));
    read_as(h5_native_type<T>(), first, count, values.data());
    return values;
  }
  /// Reads into memory for count rows of a type of the library.
  void read_as(hid_t memory_type, std::uint64_t first, std::uint64_t count, void* to) const;

 private:
  std::size_t checked_size(std::uint64_t first, std::uint64_t count) const;
  void check_chunks(std::uint64_t first, std::uint64_t count) const;
  void check_chunk(const std::vector<hsize_t>& offset) const;

  H5Handle data_;
  std::string path_;
  std::vector<std::uint64_t> shape_;
  std::size_t columns_ = 1;
  std::size_t chunk_bytes_ = 0;       ///< 0: not in chunks
  std::vector<hsize_t> chunk_shape_;  ///< empty: not in chunks
  bool filtered_ = false, deflated_ = false;
  mutable std::uint64_t checked_rows_ = 0;  ///< the chunks before this row have been checked
  H5T_class_t type_ = H5T_NO_CLASS;
  bool unsigned_ = false;
};

/// An HDF5 file open for reading.
class H5File {
 public:
  /// Throws InputError if the library cannot open the file. A cut file is opened, too: data after its end read as
  /// zeros, and compressed ones throw Damage.
  explicit H5File(const std::filesystem::path& file);

  /// Nothing if there is no such data set or it is not readable, and for the path "".
  std::optional<H5Array> find(std::string_view path) const;
  bool has(const std::string& path) const;

  /// An attribute of an object: a text or an integer.
  std::optional<std::string> text_attribute(const std::string& object, const std::string& name) const;
  std::optional<std::int64_t> number_attribute(const std::string& object, const std::string& name) const;

  /// The first `most` data sets with their shapes: "/events/t (1000)".
  std::vector<std::string> list(std::size_t most) const;

  const std::filesystem::path& path() const { return path_; }
  bool cut() const { return cut_; }

 private:
  H5Handle open_data(const std::string& path, std::size_t cache_bytes) const;

  std::filesystem::path path_;
  H5Handle file_;
  bool cut_ = false;
};

}  // namespace edged
