// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads rows by hyperslabs. All sizes are checked, as those in a damaged file may be wrong.
#include "edged/io/hdf5/h5.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "edged/core/check.hpp"
#include "edged/io/hdf5/h5_filters.hpp"
#include "edged/io/hdf5/hdf5.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostChunkBytes = std::size_t{256} << 20U;
constexpr std::size_t kUsualCacheBytes = std::size_t{1} << 20U;  // default of the library for each data set
constexpr std::uint64_t kMostRatio = 20'000;                     // no compression reaches this ratio

/// Refuses links to other files. For link and data set access.
void stay_in_file(hid_t access) {
  H5Pset_elink_cb(
      access, [](const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) -> herr_t { return -1; },
      nullptr);
}

/// Link access within the file.
H5Handle within_file() {
  H5Handle access(H5Pcreate(H5P_LINK_ACCESS), H5Pclose);
  stay_in_file(access.get());
  return access;
}

/// Bytes of an uncompressed chunk; 0 without chunks. Throws Damage if the data lie in other files: a file of events
/// must not name any file of the system.
std::size_t chunk_bytes_of(hid_t data) {
  const H5Handle creation(H5Dget_create_plist(data), H5Pclose);
  std::array<hsize_t, H5S_MAX_RANK> sides;
  if (creation && (H5Pget_external_count(creation.get()) > 0 || H5Pget_layout(creation.get()) == H5D_VIRTUAL))
    throw Damage("its data lie in other files");
  if (!creation || H5Pget_layout(creation.get()) != H5D_CHUNKED) return 0;
  const int rank = H5Pget_chunk(creation.get(), static_cast<int>(sides.size()), sides.data());
  const H5Handle type(H5Dget_type(data), H5Tclose);
  if (rank < 0 || !type) throw Damage("a data set without a layout");
  std::uint64_t bytes = H5Tget_size(type.get());
  for (int i = 0; i < rank; ++i) {
    if (sides[i] > kMostChunkBytes / std::max<std::uint64_t>(bytes, 1)) throw Damage("chunks that are too large");
    bytes *= sides[i];
  }
  return bytes;
}

/// Opens for reading. If the check of the end of the file fails, opens without it and sets `cut`.
H5Handle open_for_reading(const std::filesystem::path& file, bool& cut) {
  const H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), false, true);  // another program may have it open, or the disk may be read-only
  H5Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (opened) return opened;
  // The setting with which h5clear, a tool of the library, repairs files.
  const hbool_t skip = true;
  if (H5Pset(access.get(), "skip_eof_check", &skip) < 0) return opened;
  cut = true;
  return H5Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
}

}  // namespace

void prepare_h5() {
  static const bool prepared = [] {
    H5dont_atexit();  // the handler uses freed memory after a file that could not be closed because of a full disk
    H5open();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    register_h5_filters();
    return true;
  }();
  std::ignore = prepared;
}

H5Array::H5Array(H5Handle data, std::string path) : data_(std::move(data)), path_(std::move(path)) {
  const H5Handle type(H5Dget_type(data_.get()), H5Tclose), space(H5Dget_space(data_.get()), H5Sclose);
  const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : -1;
  if (!type || rank < 0) throw Damage("a data set without type or shape");
  type_ = H5Tget_class(type.get());
  unsigned_ = type_ == H5T_INTEGER && H5Tget_sign(type.get()) == H5T_SGN_NONE;
  shape_.resize(static_cast<std::size_t>(rank));
  static_assert(sizeof(hsize_t) == sizeof(std::uint64_t));
  std::vector<hsize_t> sides(shape_.size());
  H5Sget_simple_extent_dims(space.get(), sides.data(), nullptr);
  std::copy(sides.begin(), sides.end(), shape_.begin());
  const std::size_t value_bytes = std::max<std::size_t>(H5Tget_size(type.get()), 1);
  for (std::size_t i = 1; i < shape_.size(); ++i) {
    if (shape_[i] > kMostChunkBytes / value_bytes / std::max<std::size_t>(columns_, 1))
      throw Damage("rows that are too large");
    columns_ *= shape_[i];
  }
  const std::uint64_t held = H5Dget_storage_size(data_.get());
  if (rows() / kMostRatio > (held + kMostChunkBytes) / std::max<std::size_t>(columns_ * value_bytes, 1))
    throw Damage("its stated size is far larger than its data");
  chunk_bytes_ = chunk_bytes_of(data_.get());
  if (chunk_bytes_ == 0) return;
  const H5Handle creation(H5Dget_create_plist(data_.get()), H5Pclose);
  chunk_shape_.resize(shape_.size());
  H5Pget_chunk(creation.get(), rank, chunk_shape_.data());
  const int filters = H5Pget_nfilters(creation.get());
  filtered_ = filters > 0;
  for (int i = 0; i < filters; ++i) {
    std::size_t none = 0;
    const auto filter =
        H5Pget_filter2(creation.get(), static_cast<unsigned>(i), nullptr, &none, nullptr, 0, nullptr, nullptr);
    deflated_ = deflated_ || filter == H5Z_FILTER_DEFLATE;
  }
}

bool H5Array::has_fields(std::initializer_list<const char*> names) const {
  const H5Handle type(H5Dget_type(data_.get()), H5Tclose);
  return std::ranges::all_of(names, [&](const char* name) { return H5Tget_member_index(type.get(), name) >= 0; });
}

std::size_t H5Array::checked_size(std::uint64_t first, std::uint64_t count) const {
  if (first > rows() || count > rows() - first) throw Damage(path_ + " ends too early");
  if (columns_ > 0 && count > kMostChunkBytes / columns_) throw Damage(path_ + " has rows that are too large");
  return count * columns_;
}

/// Detects chunks that are shorter than the layout requires, before the library reads them: it would read beyond their
/// end.
void H5Array::check_chunks(std::uint64_t first, std::uint64_t count) const {
  if (chunk_shape_.empty() || first + count <= checked_rows_) return;
  const hsize_t rows = chunk_shape_.front();
  for (hsize_t row = std::max(first, checked_rows_) / rows * rows; row < first + count; row += rows) {
    std::vector<hsize_t> offset(shape_.size(), 0);
    offset.front() = row;
    for (std::size_t side = 1; side > 0;) {
      check_chunk(offset);
      for (side = shape_.size() - 1; side > 0; --side) {
        if ((offset[side] += chunk_shape_[side]) < shape_[side]) break;
        offset[side] = 0;
      }
    }
    if (row <= checked_rows_) checked_rows_ = row + rows;
  }
}

void H5Array::check_chunk(const std::vector<hsize_t>& offset) const {
  const auto too_short = [&] { return Damage(fmt::format("{} has a damaged chunk at row {}", path_, offset.front())); };
  hsize_t bytes = 0;
  std::uint32_t skipped = 0;  // mask of filters that were not applied
  if (!filtered_) {
    // This searches all chunks, which is too slow for very many.
    constexpr std::uint64_t kMostChunksSearched = 20'000;
    haddr_t address = 0;
    if (rows() / chunk_shape_.front() > kMostChunksSearched) return;
    if (H5Dget_chunk_info_by_coord(data_.get(), offset.data(), &skipped, &address, &bytes) < 0) throw too_short();
    if (address != HADDR_UNDEF && bytes < chunk_bytes_) throw too_short();
    return;
  }
  if (H5Dget_chunk_storage_size(data_.get(), offset.data(), &bytes) < 0) throw too_short();
  if (bytes > 2 * chunk_bytes_ + 65536) throw too_short();
  if (bytes == 0) return;  // never written
  Bytes packed(bytes);
  if (H5Dread_chunk(data_.get(), H5P_DEFAULT, offset.data(), &skipped, packed.data()) < 0) throw too_short();
  if (skipped != 0) {
    if (bytes < chunk_bytes_) throw too_short();
  } else if (deflated_) {
    Bytes plain(chunk_bytes_ + 64);  // a checksum may follow the data
    auto plain_bytes = static_cast<uLongf>(plain.size());
    if (uncompress(plain.data(), &plain_bytes, packed.data(), packed.size()) != Z_OK || plain_bytes < chunk_bytes_)
      throw too_short();
  }
}

void H5Array::read_as(hid_t memory_type, std::uint64_t first, std::uint64_t count, void* to) const {
  if (checked_size(first, count) == 0) return;
  if (type_ != H5T_INTEGER && type_ != H5T_FLOAT && type_ != H5T_ENUM && type_ != H5T_COMPOUND)
    throw Damage(path_ + " holds no numbers");
  check_chunks(first, count);
  const H5ChunkScope scope(chunk_bytes_);
  const H5Handle space(H5Dget_space(data_.get()), H5Sclose);
  std::vector<hsize_t> start(shape_.size(), 0), extent(shape_.begin(), shape_.end());
  if (!shape_.empty()) {
    start.front() = first;
    extent.front() = count;
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
  }
  // The memory has the shape of the selection. Otherwise the library copies element by element.
  const H5Handle memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose);
  if (H5Dread(data_.get(), memory_type, memory.get(), space.get(), H5P_DEFAULT, to) < 0)
    throw Damage(fmt::format("{} cannot be read at rows {} to {}", path_, first, first + count));
}

H5File::H5File(const std::filesystem::path& file) : path_(file) {
  require_regular_file(file);
  prepare_h5();
  file_ = open_for_reading(file, cut_);
  if (!file_)
    throw InputError::format(
        "{}: the HDF5 file cannot be opened: it is damaged or was not closed; copy it again, or try "
        "`h5clear -s -i` of hdf5-tools on a copy",
        file.string());
}

H5Handle H5File::open_data(const std::string& path, std::size_t cache_bytes) const {
  constexpr std::size_t kSlots = 521;
  const H5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), kSlots, cache_bytes, 1.0);
  stay_in_file(access.get());
  return {H5Dopen2(file_.get(), path.c_str(), access.get()), H5Dclose};
}

std::optional<H5Array> H5File::find(std::string_view named) const try {
  if (named.empty()) return std::nullopt;
  const std::string path(named);
  H5Handle data = open_data(path, kUsualCacheBytes);
  if (!data) return std::nullopt;
  // A chunk that exceeds the cache is decompressed again for each block of rows.
  const std::size_t chunk_bytes = chunk_bytes_of(data.get());
  if (chunk_bytes > kUsualCacheBytes) {
    data = H5Handle();
    data = open_data(path, chunk_bytes);
  }
  return H5Array(std::move(data), path);
} catch (const Damage&) {
  return std::nullopt;
}

bool H5File::has(const std::string& path) const {
  return bool(H5Handle(H5Oopen(file_.get(), path.c_str(), within_file().get()), H5Oclose));
}

std::optional<std::string> H5File::text_attribute(const std::string& object, const std::string& name) const {
  const H5Handle attribute(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, within_file().get()),
                           H5Aclose);
  const H5Handle type(attribute ? H5Aget_type(attribute.get()) : H5I_INVALID_HID, H5Tclose);
  if (!type || H5Tget_class(type.get()) != H5T_STRING) return std::nullopt;
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute.get(), type.get(), &text) < 0 || !text) return std::nullopt;
    std::string copy = text;
    H5free_memory(text);
    return copy;
  }
  constexpr std::size_t kMost = 65536;
  const std::size_t bytes = H5Aget_storage_size(attribute.get());
  if (bytes == 0 || bytes > kMost) return std::nullopt;
  std::string text(bytes, '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0) return std::nullopt;
  return std::string(text.c_str());
}

std::optional<std::int64_t> H5File::number_attribute(const std::string& object, const std::string& name) const {
  const H5Handle attribute(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, within_file().get()),
                           H5Aclose);
  const H5Handle space(attribute ? H5Aget_space(attribute.get()) : H5I_INVALID_HID, H5Sclose);
  std::int64_t number = 0;
  if (!space || H5Sget_simple_extent_npoints(space.get()) != 1) return std::nullopt;
  if (H5Aread(attribute.get(), H5T_NATIVE_INT64, &number) < 0) return std::nullopt;
  return number;
}

std::vector<std::string> H5File::list(std::size_t most) const {
  struct Visit {
    const H5File& file;
    std::size_t most;
    std::vector<std::string> found;
    std::size_t links = 0;
  } visit{*this, most, {}};
  const auto note = [](hid_t, const char* name, const H5L_info_t*, void* context) -> herr_t {
    constexpr std::size_t kMostLinks = 1000, kLongestName = 1000;  // links of a damaged file may form a cycle
    auto& v = *static_cast<Visit*>(context);
    if (++v.links > kMostLinks || std::strlen(name) > kLongestName) return 1;
    const auto array = v.file.find(std::string("/") + name);
    if (!array) return 0;
    v.found.push_back(fmt::format("{} ({})", array->path(), fmt::join(array->shape(), ", ")));
    return v.found.size() == v.most ? 1 : 0;
  };
  H5Lvisit(file_.get(), H5_INDEX_NAME, H5_ITER_INC, note, &visit);
  return visit.found;
}

bool is_hdf5(ByteSpan head) {
  constexpr std::string_view kSignature = "\x89HDF\r\n\x1a\n";
  // A user block may precede it. Its size is a power of two from 512 on.
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  if (text.starts_with(kSignature)) return true;
  for (std::size_t at = 512; at < text.size(); at *= 2)
    if (text.substr(at).starts_with(kSignature)) return true;
  return false;
}

}  // namespace edged
