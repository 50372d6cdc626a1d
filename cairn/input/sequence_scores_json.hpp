// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/input/sequence_scores.hpp>
#include <cairn/output/json.hpp>

/// The scores as JSON values (docs/evaluation.md). Internal: not installed.
namespace cairn::input {

output::Json json_of(const TrajectoryError& error);
/// The `summary` of `cairn evaluate --sequence --json`.
output::Json json_of(const SequenceScores& scores);

}  // namespace cairn::input
