// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/ros/dds/cdr_type.hpp>

#include <dds/ddsi/q_radmin.h>
#include <dds/ddsrt/heap.h>
#include <dds/ddsrt/md5.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <new>
#include <numeric>

namespace cairn::ros {
namespace {

constexpr std::size_t kHeader = 4;

struct CdrType : ddsi_sertype {
  std::vector<std::uint8_t> key;  // sizes of its numbers, which follow the header
};

/// The sizes of the key's numbers, and all of them together.
const std::vector<std::uint8_t>& key_of(const ddsi_sertype* type) {
  return static_cast<const CdrType*>(type)->key;
}
std::size_t key_length(const ddsi_sertype* type) {
  const std::vector<std::uint8_t>& key = key_of(type);
  return std::accumulate(key.begin(), key.end(), std::size_t{0});
}

/// Padded to a multiple of four bytes, as in RTPS; `size` excludes the padding.
struct CdrData : ddsi_serdata {
  CdrData(const ddsi_sertype* cdr_type, ddsi_serdata_kind data_kind, Bytes value)
      : ddsi_serdata{}, bytes(std::move(value)), length(bytes.size()), key_bytes(key_length(cdr_type)) {
    ddsi_serdata_init(this, cdr_type, data_kind);
    bytes.resize((length + 3) / 4 * 4);
  }
  [[nodiscard]] std::span<const std::uint8_t> key() const { return {bytes.data() + kHeader, key_bytes}; }
  /// Cyclone finds instances by it.
  void set_hash() {
    hash = 2166136261U;  // FNV-1a
    for (const std::uint8_t byte : key()) hash = (hash ^ byte) * 16777619U;
  }
  Bytes bytes;
  std::size_t length = 0;
  std::size_t key_bytes = 0;  // 0: without a key, all samples belong to one instance
};

const CdrData& own(const ddsi_serdata* data) {
  return *static_cast<const CdrData*>(data);
}

/// No exception may cross Cyclone's C code: nullptr if memory runs out.
CdrData* make(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) noexcept {
  try {
    return new CdrData(type, kind, Bytes(size));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

// ---- samples ----

/// The value once its bytes are in place; nullptr if it is too short, or of another encoding, to have its key where it
/// is looked for.
CdrData* finished(CdrData* data) {
  if (data == nullptr || data->key_bytes == 0) return data;
  const bool has_key =
      data->length >= kHeader + data->key_bytes && data->bytes[0] == 0 && data->bytes[1] == 1;
  if (!has_key) {
    delete data;
    return nullptr;
  }
  data->set_hash();
  return data;
}

bool equal_keys(const ddsi_serdata* a, const ddsi_serdata* b) {
  return std::ranges::equal(own(a).key(), own(b).key());
}

std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(own(data).length);
}

/// From the network: fragments in order, possibly overlapping.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  CdrData* const data = make(type, kind, size);
  if (data == nullptr) return nullptr;
  std::uint32_t done = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    const std::uint32_t end = std::min(fragment->maxp1, static_cast<std::uint32_t>(size));
    if (end <= done || fragment->min > done) continue;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::copy(payload + (done - fragment->min), payload + (end - fragment->min), data->bytes.data() + done);
    done = end;
  }
  return finished(data);
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
  CdrData* const data = make(type, kind, size);
  if (data == nullptr) return nullptr;
  std::size_t done = 0;
  for (std::size_t i = 0; i < count && done < size; ++i) {
    const std::size_t length = std::min(pieces[i].iov_len, size - done);
    std::copy_n(static_cast<const std::uint8_t*>(pieces[i].iov_base), length, data->bytes.data() + done);
    done += length;
  }
  return finished(data);
}

/// A hash of more than 16 bytes does not say the key.
ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return key_length(type) == 0 ? make(type, SDK_KEY, kHeader) : nullptr;
}

/// A sample consists of the serialised bytes.
ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
  const auto& bytes = *static_cast<const Bytes*>(sample);
  const std::size_t wanted = kind == SDK_DATA ? bytes.size() : kHeader + key_length(type);
  CdrData* const data = make(type, kind, wanted);
  if (data != nullptr && wanted <= bytes.size()) std::copy_n(bytes.begin(), wanted, data->bytes.begin());
  return finished(data);
}

void to_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* to) {
  std::copy_n(own(data).bytes.data() + offset, size, static_cast<std::uint8_t*>(to));
}

ddsi_serdata* borrow_bytes(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                           ddsrt_iovec_t* piece) {
  piece->iov_base = const_cast<std::uint8_t*>(own(data).bytes.data()) + offset;
  piece->iov_len = size;
  return ddsi_serdata_ref(data);
}

void give_back_bytes(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(data);
}

bool to_sample(const ddsi_serdata* data, void* sample, void**, void*) {
  const CdrData& from = own(data);
  try {
    static_cast<Bytes*>(sample)->assign(from.bytes.begin(),
                                        from.bytes.begin() + static_cast<std::ptrdiff_t>(from.length));
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  const std::size_t length = kHeader + own(data).key_bytes;
  CdrData* const untyped = make(data->type, SDK_KEY, length);
  if (untyped == nullptr) return nullptr;
  std::copy_n(own(data).bytes.begin(), std::min(length, own(data).length), untyped->bytes.begin());
  untyped->hash = data->hash;
  untyped->type = nullptr;
  return untyped;
}

bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata* data, void* sample, void**, void*) {
  return to_sample(data, sample, nullptr, nullptr);
}

void free_data(ddsi_serdata* data) {
  delete static_cast<CdrData*>(data);
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata* data, char* to, std::size_t size) {
  return static_cast<std::size_t>(std::max(0, std::snprintf(to, size, "%zu bytes", own(data).length)));
}

/// The key in big endian if it fits, else its MD5 (RTPS 2.2, 9.6.3.8).
void keyhash_of(const ddsi_serdata* data, ddsi_keyhash* hash, bool must_be_md5) {
  std::ranges::fill(hash->value, static_cast<unsigned char>(0));
  if (own(data).key_bytes == 0) return;
  std::vector<std::uint8_t> key(own(data).key().begin(), own(data).key().end());
  auto at = key.begin();
  for (const std::uint8_t size : key_of(data->type)) {
    std::reverse(at, at + size);
    at += size;
  }
  if (key.size() <= std::size(hash->value) && !must_be_md5) {
    std::ranges::copy(key, std::begin(hash->value));
    return;
  }
  ddsrt_md5_state_t md5;
  ddsrt_md5_init(&md5);
  ddsrt_md5_append(&md5, key.data(), static_cast<unsigned>(key.size()));
  ddsrt_md5_finish(&md5, hash->value);
}

constexpr ddsi_serdata_ops data_operations() {
  ddsi_serdata_ops operations{};
  operations.eqkey = equal_keys;
  operations.get_size = size_of;
  operations.from_ser = from_fragments;
  operations.from_ser_iov = from_pieces;
  operations.from_keyhash = from_keyhash;
  operations.from_sample = from_sample;
  operations.to_ser = to_bytes;
  operations.to_ser_ref = borrow_bytes;
  operations.to_ser_unref = give_back_bytes;
  operations.to_sample = to_sample;
  operations.to_untyped = to_untyped;
  operations.untyped_to_sample = untyped_to_sample;
  operations.free = free_data;
  operations.print = print;
  operations.get_keyhash = keyhash_of;
  return operations;
}
const ddsi_serdata_ops kDataOperations = data_operations();

// ---- types ----

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete static_cast<CdrType*>(type);
}

// Cyclone never allocates samples here: they are taken as bytes (dds_takecdr).
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}

bool equal_types(const ddsi_sertype*, const ddsi_sertype*) {
  return true;  // their names have been compared
}
std::uint32_t hash_of_type(const ddsi_sertype*) {
  return 0;
}

ddsi_sertype_ops type_operations() {
  ddsi_sertype_ops operations{};
  operations.version = ddsi_sertype_v0;
  operations.free = free_type;
  operations.zero_samples = zero_samples;
  operations.realloc_samples = realloc_samples;
  operations.free_samples = free_samples;
  operations.equal = equal_types;
  operations.hash = hash_of_type;
  return operations;
}
const ddsi_sertype_ops kTypeOperations = type_operations();

}  // namespace

ddsi_sertype* make_cdr_type(const std::string& name, std::vector<std::uint8_t> key) {
  auto type = std::make_unique<CdrType>();
  ddsi_sertype_init(type.get(), name.c_str(), &kTypeOperations, &kDataOperations, key.empty());
  type->key = std::move(key);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type.release();
}

ddsi_serdata* make_cdr_data(const ddsi_sertype* type, Bytes bytes) {
  return finished(new CdrData(type, SDK_DATA, std::move(bytes)));
}

std::span<const std::uint8_t> bytes_of(const ddsi_serdata* data) {
  return {own(data).bytes.data(), own(data).length};
}

}  // namespace cairn::ros
