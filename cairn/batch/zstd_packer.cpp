// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <zstd.h>

#include <cairn/batch/zstd_packer.hpp>
#include <new>

namespace cairn::batch {

struct ZstdPacker::State {
  ZSTD_CStream* stream = ZSTD_createCStream();
  std::string room = std::string(ZSTD_CStreamOutSize(), '\0');

  std::string take(std::string_view bytes, ZSTD_EndDirective until) {
    std::string packed;
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    for (bool is_done = false; !is_done;) {
      ZSTD_outBuffer out{room.data(), room.size(), 0};
      const std::size_t left = ZSTD_compressStream2(stream, &out, &in, until);
      if (ZSTD_isError(left) != 0) throw std::bad_alloc();  // the only error when compressing to memory
      packed.append(room, 0, out.pos);
      is_done = until == ZSTD_e_end ? left == 0 : in.pos == in.size;
    }
    return packed;
  }
};

ZstdPacker::ZstdPacker() : state_(std::make_unique<State>()) {
  if (state_->stream == nullptr) throw std::bad_alloc();
  ZSTD_CCtx_setParameter(state_->stream, ZSTD_c_checksumFlag, 1);
}
ZstdPacker::~ZstdPacker() {
  ZSTD_freeCStream(state_->stream);
}

std::string ZstdPacker::pack(std::string_view bytes) {
  return state_->take(bytes, ZSTD_e_continue);
}

std::string ZstdPacker::end() {
  return state_->take({}, ZSTD_e_end);
}

}  // namespace cairn::batch
