// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/raw_type.hpp"

#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <cstring>
#include <new>

#include "edged/core/check.hpp"

namespace edged::ros2 {
namespace {

constexpr std::size_t kAlignment = 4;  // of messages on the wire [bytes]

/// Cyclone counts the references, and deletes by free_message.
struct Serdata : ddsi_serdata {
  Serdata(const ddsi_sertype* of, ddsi_serdata_kind what) {
    ddsi_serdata_init(this, of, what);
    hash = of->serdata_basehash;  // one instance, as there is no key
  }
  std::string bytes;  ///< padded to kAlignment
  Origin origin;
};

const Serdata& raw(const ddsi_serdata* message) { return *static_cast<const Serdata*>(message); }

// Cyclone is written in C: no exception may pass through it. Null is a message that cannot be had.
Serdata* allocate(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t bytes) try {
  auto* message = new Serdata(type, kind);
  message->bytes.reserve(bytes + kAlignment);
  return message;
} catch (const std::bad_alloc&) {
  return nullptr;
}

void pad(std::string& bytes) { bytes.append((kAlignment - bytes.size() % kAlignment) % kAlignment, '\0'); }

// RTPS 2.2, 8.3.3, 9.4.4 and 9.4.5.3 [bytes]: in the packet, and in the submessage DATA or DATA_FRAG.
constexpr std::size_t kPrefix = 8, kPrefixSize = 12, kWriterId = 12, kWriterIdSize = 4, kNumber = 16;

/// The origin of the submessage that the fragment is from. Cyclone has brought its number into the order of bytes of
/// this machine.
Origin origin_of(const nn_rdata& fragment) {
  if (fragment.submsg_zoff == 0) return {};
  const unsigned char* packet = NN_RMSG_PAYLOAD(fragment.rmsg);
  const unsigned char* submessage = packet + NN_RDATA_SUBMSG_OFF(&fragment);
  Origin origin;
  std::memcpy(origin.writer.data(), packet + kPrefix, kPrefixSize);
  std::memcpy(origin.writer.data() + kPrefixSize, submessage + kWriterId, kWriterIdSize);
  std::uint32_t high = 0, low = 0;
  std::memcpy(&high, submessage + kNumber, sizeof high);
  std::memcpy(&low, submessage + kNumber + sizeof high, sizeof low);
  origin.number = (std::uint64_t{high} << 32) | low;
  return origin;
}

/// Fragments are in order; their ranges may overlap.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  Serdata* message = allocate(type, kind, size);
  if (message && fragment) message->origin = origin_of(*fragment);
  for (; message && fragment; fragment = fragment->nextfrag) {
    const std::size_t done = message->bytes.size();
    if (fragment->maxp1 <= done) continue;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    message->bytes.append(reinterpret_cast<const char*>(payload) + (done - fragment->min), fragment->maxp1 - done);
  }
  if (message) pad(message->bytes);
  return message;
}

ddsi_serdata* from_parts(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                         const ddsrt_iovec_t* parts, std::size_t size) {
  Serdata* message = allocate(type, kind, size);
  for (ddsrt_msg_iovlen_t i = 0; message && i < count; ++i)
    message->bytes.append(static_cast<const char*>(parts[i].iov_base), parts[i].iov_len);
  if (message) pad(message->bytes);
  return message;
}

ddsi_serdata* from_key(const ddsi_sertype* type, const ddsi_keyhash*) { return allocate(type, SDK_KEY, 0); }

/// Samples of C are neither written nor taken: there are dds_writecdr and dds_takecdr.
ddsi_serdata* from_sample(const ddsi_sertype*, ddsi_serdata_kind, const void*) { return nullptr; }
bool to_sample(const ddsi_serdata*, void*, void**, void*) { return false; }
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return false; }

ddsi_serdata* to_untyped(const ddsi_serdata* message) {
  Serdata* key = allocate(message->type, SDK_KEY, 0);
  if (key) key->type = nullptr;
  return key;
}

void to_bytes(const ddsi_serdata* message, std::size_t offset, std::size_t size, void* to) {
  std::memcpy(to, raw(message).bytes.data() + offset, size);
}

ddsi_serdata* lend(const ddsi_serdata* message, std::size_t offset, std::size_t size, ddsrt_iovec_t* part) {
  part->iov_base = const_cast<char*>(raw(message).bytes.data() + offset);  // which is only read
  part->iov_len = size;
  return ddsi_serdata_ref(message);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata*, char* to, std::size_t size) {
  if (size > 0) *to = '\0';
  return 0;
}

const ddsi_serdata_ops kMessageOps = {
    .eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; },
    .get_size = [](const ddsi_serdata* message) { return static_cast<std::uint32_t>(raw(message).bytes.size()); },
    .from_ser = from_fragments,
    .from_ser_iov = from_parts,
    .from_keyhash = from_key,
    .from_sample = from_sample,
    .to_ser = to_bytes,
    .to_ser_ref = lend,
    .to_ser_unref = [](ddsi_serdata* message, const ddsrt_iovec_t*) { ddsi_serdata_unref(message); },
    .to_sample = to_sample,
    .to_untyped = to_untyped,
    .untyped_to_sample = untyped_to_sample,
    .free = [](ddsi_serdata* message) { delete static_cast<Serdata*>(message); },
    .print = print,
    .get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* hash, bool) { *hash = {}; },
};

const ddsi_sertype_ops kTypeOps = {
    .version = ddsi_sertype_v0,
    .free =
        [](ddsi_sertype* type) {
          ddsi_sertype_fini(type);
          delete type;
        },
    .zero_samples = [](const ddsi_sertype*, void*, std::size_t) {},
    .realloc_samples =
        [](void** samples, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
          for (std::size_t i = 0; i < count; ++i) samples[i] = nullptr;
        },
    .free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {},
    .equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; },
    .hash = [](const ddsi_sertype*) { return std::uint32_t{0}; },
};

}  // namespace

ddsi_sertype* make_raw_type(const std::string& name) {
  auto* type = new ddsi_sertype{};
  ddsi_sertype_init(type, name.c_str(), &kTypeOps, &kMessageOps, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

ddsi_serdata* make_raw_message(const ddsi_sertype* type, std::string_view cdr) {
  auto* message = new Serdata(type, SDK_DATA);
  message->bytes.reserve(cdr.size() + kAlignment);
  message->bytes = cdr;
  pad(message->bytes);
  return message;
}

RawMessage::~RawMessage() { ddsi_serdata_unref(message_); }

ByteSpan RawMessage::cdr() const { return as_bytes(raw(message_).bytes); }

Origin RawMessage::origin() const { return raw(message_).origin; }

}  // namespace edged::ros2
