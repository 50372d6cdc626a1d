// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>

#include "sequence.hpp"

/// Recordings (MCAP) as sequences; internal to source.
namespace cairn::io {

/// The stereo pair of a recording: images of two topics, raw or compressed, paired by the stamps of their
/// headers. Its calibration: options.calib, else what cairn recorded beside the images, else camera_info.
std::unique_ptr<Sequence> open_mcap(const std::filesystem::path& file, const SourceOptions& options,
                                    const Pool& pool);

}  // namespace cairn::io
