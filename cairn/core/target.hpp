// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <optional>
#include <string_view>
#include <vector>

namespace cairn {

/// The instruction sets with kernels in this build, slowest first; always includes Target::scalar.
std::vector<Target> compiled_targets();
/// Those of compiled_targets() that this processor supports, slowest first.
std::vector<Target> supported_targets();
/// The target of the kernels: the last of supported_targets() for Target::best. An unsupported target falls
/// back to Target::scalar; a caller that takes the choice from a user refuses it beforehand.
Target active_target(const Exec& exec);

/// "scalar", "sse4" …, as on the command line.
std::string_view name(Target target);
/// The target of this name, "best" included; nullopt if there is none.
std::optional<Target> target_named(std::string_view name);
/// The target chosen by a user. Throws Error beginning with `source` ("--target") if the name is unknown, or
/// if this build or this processor lacks the target.
Target wanted_target(std::string_view wanted, std::string_view source);

}  // namespace cairn
