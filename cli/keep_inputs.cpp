// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "keep_inputs.hpp"

#include <cairn/core/error.hpp>
#include <system_error>

namespace cairn::cli {

namespace fs = std::filesystem;

void keep_inputs(const std::vector<fs::path>& outputs, const io::FrameFiles& files,
                 const InputOptions& options) {
  for (const fs::path& output : outputs) {
    for (const fs::path& input :
         {files.left, files.right.value_or(fs::path()), files.calib.value_or(fs::path()),
          fs::path(options.calib), fs::path(options.disparity), fs::path(options.config.file)}) {
      std::error_code missing;
      if (fs::equivalent(output, input, missing))
        throw Error(output.string() + ": is read by this run, expected another file to write");
    }
  }
}

}  // namespace cairn::cli
