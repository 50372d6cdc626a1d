// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace cairn::batch {

/// Compresses bytes as one zstd frame, with a checksum. Throws Error if zstd is not built in.
class ZstdPacker {
 public:
  ZstdPacker();
  ZstdPacker(const ZstdPacker&) = delete;
  ZstdPacker& operator=(const ZstdPacker&) = delete;
  ~ZstdPacker();

  /// Output available so far; may be empty.
  std::string pack(std::string_view bytes);
  /// The remaining output.
  std::string end();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cairn::batch
