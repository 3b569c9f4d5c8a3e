// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Creates HDF5 files for the tests, with all compressions that are read.
#pragma once

#include <gtest/gtest.h>
#include <lzf.h>
#include <zstd.h>

#include <cstring>
#include <filesystem>
#include <numeric>

#include "edged/io/hdf5/ecf_test_support.hpp"
#include "edged/io/hdf5/h5.hpp"
#include "edged/io/hdf5/h5_filters.hpp"
#include "edged/measurement.hpp"

namespace edged {

enum class H5Pack { None, Deflate, Blosc, Zstd, Lzf, Ecf };

/// A chunk, compressed as by the filter.
inline Bytes pack_h5_chunk(H5Pack pack, ByteSpan plain) {
  if (pack == H5Pack::Ecf) {
    std::vector<EcfEvent> events(plain.size() / sizeof(EcfEvent));
    std::memcpy(events.data(), plain.data(), plain.size());
    return encode_ecf(events, EcfPacking::Runs);
  }
  Bytes packed(plain.size() + plain.size() / 8 + 64);
  packed.resize(pack == H5Pack::Zstd ? ZSTD_compress(packed.data(), packed.size(), plain.data(), plain.size(), 3)
                                     : lzf_compress(plain.data(), static_cast<unsigned>(plain.size()), packed.data(),
                                                    static_cast<unsigned>(packed.size())));
  return packed;
}

/// A new file of HDF5.
class H5Maker {
 public:
  explicit H5Maker(const std::filesystem::path& file) {
    prepare_h5();
    file_ = H5Handle(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  }

  /// A data set of numbers; shape: {rows, ...}, {} for a single number. In chunks of chunk_rows, if given.
  template <typename T>
  void array(const std::string& path, const std::vector<T>& values, std::vector<hsize_t> shape,
             H5Pack pack = H5Pack::None, hsize_t chunk_rows = 0) {
    write(path, h5_native_type<T>(), sizeof(T), values.data(), std::move(shape), pack, chunk_rows);
  }

  template <typename T>
  void column(const std::string& path, const std::vector<T>& values, H5Pack pack = H5Pack::None,
              hsize_t chunk_rows = 0) {
    array(path, values, {values.size()}, pack, chunk_rows);
  }

  /// /CD/events of Metavision.
  void compound(const std::string& path, const std::vector<EcfEvent>& events, H5Pack pack, hsize_t chunk_rows) {
    const H5Handle type(H5Tcreate(H5T_COMPOUND, sizeof(EcfEvent)), H5Tclose);
    H5Tinsert(type.get(), "x", offsetof(EcfEvent, x), H5T_STD_U16LE);
    H5Tinsert(type.get(), "y", offsetof(EcfEvent, y), H5T_STD_U16LE);
    H5Tinsert(type.get(), "p", offsetof(EcfEvent, p), H5T_STD_I16LE);
    H5Tinsert(type.get(), "t", offsetof(EcfEvent, t), H5T_STD_I64LE);
    write(path, type.get(), sizeof(EcfEvent), events.data(), {events.size()}, pack, chunk_rows);
  }

  void text_attribute(const std::string& name, const std::string& text) {
    const H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose);
    H5Tset_size(type.get(), text.size() + 1);
    const H5Handle attribute(H5Acreate2(file_.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose);
    EXPECT_GE(H5Awrite(attribute.get(), type.get(), text.c_str()), 0);
  }

 private:
  void write(const std::string& path, hid_t type, std::size_t value_bytes, const void* values,
             std::vector<hsize_t> shape, H5Pack pack, hsize_t chunk_rows) {
    const H5Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose), creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links.get(), 1);
    const H5Handle space(
        shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
        H5Sclose);
    std::vector<hsize_t> chunk = shape;
    if (chunk_rows > 0) chunk.front() = chunk_rows;
    const std::size_t row =
        std::accumulate(shape.begin() + (shape.empty() ? 0 : 1), shape.end(), value_bytes, std::multiplies<>());
    if (chunk_rows > 0) H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
    if (pack == H5Pack::Deflate) H5Pset_deflate(creation.get(), 4);
    const auto parameters = blosc_parameters(value_bytes, chunk_rows * row);
    if (pack == H5Pack::Blosc)
      H5Pset_filter(creation.get(), static_cast<H5Z_filter_t>(H5Filter::Blosc), 0, parameters.size(),
                    parameters.data());
    const bool packed_here = pack == H5Pack::Zstd || pack == H5Pack::Lzf || pack == H5Pack::Ecf;
    const H5Filter filter = pack == H5Pack::Zstd ? H5Filter::Zstd : pack == H5Pack::Lzf ? H5Filter::Lzf : H5Filter::Ecf;
    if (packed_here) H5Pset_filter(creation.get(), static_cast<H5Z_filter_t>(filter), 0, 0, nullptr);
    const H5Handle data(
        H5Dcreate2(file_.get(), path.c_str(), type, space.get(), links.get(), creation.get(), H5P_DEFAULT), H5Dclose);
    ASSERT_TRUE(data) << path;
    if (!packed_here) {
      ASSERT_GE(H5Dwrite(data.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0) << path;
      return;
    }
    const auto* bytes = static_cast<const std::uint8_t*>(values);
    for (hsize_t at = 0; at < shape.front(); at += chunk_rows) {
      Bytes plain(chunk_rows * row, 0);
      std::memcpy(plain.data(), bytes + at * row, std::min(chunk_rows, shape.front() - at) * row);
      // The rest of the last chunk repeats its last row, so that stamps do not go back.
      for (hsize_t k = shape.front() - at; k < chunk_rows; ++k)
        std::memcpy(plain.data() + k * row, bytes + (shape.front() - 1) * row, row);
      const Bytes packed = pack_h5_chunk(pack, plain);
      std::vector<hsize_t> offset(shape.size(), 0);
      offset.front() = at;
      ASSERT_GE(H5Dwrite_chunk(data.get(), H5P_DEFAULT, 0, offset.data(), packed.size(), packed.data()), 0) << path;
    }
  }

  H5Handle file_;
};

/// x, y, t [us] and p of events in `group`, as in DSEC, VECtor, TUM-VIE, M3ED and EDS.
inline void put_event_columns(H5Maker& file, const std::string& group, const std::vector<Event>& events,
                              std::int64_t offset_us = 0, H5Pack pack = H5Pack::None, hsize_t chunk_rows = 0) {
  std::vector<std::uint16_t> x, y;
  std::vector<std::uint8_t> p;
  std::vector<std::int64_t> t;
  for (const Event& e : events) {
    x.push_back(e.x);
    y.push_back(e.y);
    p.push_back(e.positive);
    t.push_back(to_ns(e.t) / 1000 - offset_us);
  }
  file.column(group + "/x", x, pack, chunk_rows);
  file.column(group + "/y", y, pack, chunk_rows);
  file.column(group + "/t", t, pack, chunk_rows);
  file.column(group + "/p", p, pack, chunk_rows);
}

/// A new file with events as these columns in /events.
inline std::filesystem::path write_events(const std::filesystem::path& path, const std::vector<Event>& events,
                                          H5Pack pack = H5Pack::None, hsize_t chunk_rows = 0) {
  H5Maker file(path);
  put_event_columns(file, "/events", events, 0, pack, chunk_rows);
  return path;
}

}  // namespace edged
