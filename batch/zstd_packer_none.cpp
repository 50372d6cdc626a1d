// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <batch/zstd_packer.hpp>
#include <cairn/core/error.hpp>

namespace cairn::batch {

struct ZstdPacker::State {};

ZstdPacker::ZstdPacker() {
  throw Error(
      "-o: packing is not built in, it needs zstd (libzstd-dev); without .zst at its end the file is not "
      "packed");
}
ZstdPacker::~ZstdPacker() = default;
std::string ZstdPacker::pack(std::string_view /*bytes*/) {
  return {};
}
std::string ZstdPacker::end() {
  return {};
}

}  // namespace cairn::batch
