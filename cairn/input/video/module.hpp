// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <optional>

#include <cairn/input/sequence.hpp>

/// The interface between the library and its video module. Both belong to one build.
namespace cairn::input {

struct VideoRequest {
  std::filesystem::path left;
  std::optional<std::filesystem::path> right;
  SourceOptions options;
  Pool pool;
};
inline constexpr const char* kVideoEntry = "cairn_open_video";
/// The function of that name: the caller owns the result. Throws Error.
using VideoEntry = Sequence* (*)(const VideoRequest&);

}  // namespace cairn::input
