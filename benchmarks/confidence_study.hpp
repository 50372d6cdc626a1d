// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <filesystem>

/// Fits the ConfidenceModel of both presets to the rendered development frames, and compares what the library
/// states with the share of disparities that are within 1 px of the truth, there and on pairs that it was not
/// fitted to.
void confidence_study(const std::filesystem::path& data, const cairn::Exec& exec);
