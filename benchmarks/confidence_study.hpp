// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <filesystem>

/// Fits the ConfidenceModel of both presets to the rendered development frames. Compares the stated
/// confidence with the share of disparities within 1 px of the truth, on these frames and on pairs not used
/// for fitting.
void confidence_study(const std::filesystem::path& data, const cairn::Exec& exec);
