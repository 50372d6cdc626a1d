// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace cairn {

/// The instruction sets that this build has kernels for, slowest first; Target::scalar is always among them.
std::vector<Target> compiled_targets();
/// Those of them that this processor can run, slowest first.
std::vector<Target> supported_targets();
/// What the kernels run on: the last of supported_targets() for Target::best. A target that is not supported
/// falls back to Target::scalar; whoever lets a user choose refuses it beforehand.
Target active_target(const Exec& exec);

/// "scalar", "sse4" …, as users write it.
std::string_view name(Target target);
/// The target of this name ("best" among them); nullopt where there is none.
std::optional<Target> target_named(std::string_view name);
/// The target that a user asked for by name. Throws Error, which begins with `source` ("--target"), where
/// there is none of this name, or where this build or this processor lacks it.
Target wanted_target(std::string_view wanted, std::string_view source);

}  // namespace cairn
