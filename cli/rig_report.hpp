// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/output/json.hpp>
#include <vector>

#include "common.hpp"

namespace cairn::cli {

/// What `cairn doctor --report` adds to the diagnosis: build, system, calibration, images, options and the times of
/// the first frame. `images`: also the first pair, as PNG in base64.
output::Json rig_report(const io::FrameFiles& first, const InputOptions& input,
                        const ExecOptions& exec_options, bool images);

/// The same JSON without the folders of the input and without absolute paths, in every text: of each file only the
/// base name stays.
output::Json without_folders(output::Json json, const std::vector<io::FrameFiles>& frames,
                             const InputOptions& input);

/// An optional part of the build, and the packages that it needs.
struct BuiltPart {
  const char* what;
  bool is_in;
  const char* packages;
};
std::vector<BuiltPart> built_parts();

}  // namespace cairn::cli
