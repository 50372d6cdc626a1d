// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <cairn/input/sequence.hpp>

/// Recordings (MCAP) as sequences; internal to source.
namespace cairn::input {

/// The stereo pair of a recording: images of two topics, raw or compressed, paired by their header stamps.
/// Calibration: options.calib, else the one recorded by cairn, else camera_info.
std::unique_ptr<Sequence> open_mcap(const std::filesystem::path& file, const SourceOptions& options,
                                    const Pool& pool);

/// The recording in a folder of `ros2 bag`, which has a metadata.yaml; nullopt for other folders. Throws
/// Error for several parts, or none in MCAP.
std::optional<std::filesystem::path> recording_in(const std::filesystem::path& folder);

/// The recording that a source is, or that its folder contains; nullopt for other sources. Throws Error like
/// recording_in().
std::optional<std::filesystem::path> recording_of(const std::string& source);

}  // namespace cairn::input
