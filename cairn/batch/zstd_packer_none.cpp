// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/batch/zstd_packer.hpp>
#include <cairn/core/error.hpp>

namespace cairn::batch {

struct ZstdPacker::State {};

ZstdPacker::ZstdPacker() {
  throw Error(
      "-o: compression is not built in, it needs zstd (libzstd-dev); a name without .zst needs "
      "no compression");
}
ZstdPacker::~ZstdPacker() = default;
std::string ZstdPacker::pack(std::string_view /*bytes*/) {
  return {};
}
std::string ZstdPacker::end() {
  return {};
}

}  // namespace cairn::batch
