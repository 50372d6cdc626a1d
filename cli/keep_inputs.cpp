// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "keep_inputs.hpp"

#include <unistd.h>

#include <cairn/core/error.hpp>
#include <system_error>

namespace cairn::cli {

namespace fs = std::filesystem;

void keep_inputs(const std::vector<fs::path>& outputs, const io::FrameFiles& files,
                 const InputOptions& options) {
  for (const fs::path& output : outputs) {
    for (const fs::path& input :
         {files.left, files.right.value_or(fs::path()), files.calib.value_or(fs::path()),
          files.given ? files.given->path : fs::path(), fs::path(options.calib),
          fs::path(options.maps.disparity), fs::path(options.maps.depth), fs::path(options.config.file)}) {
      std::error_code missing;
      if (fs::equivalent(output, input, missing))
        throw Error(output.string() + ": is read by this run, expected another file to write");
    }
  }
}

void require_writable(const std::string& file) {
  const fs::path folder = fs::path(file).has_parent_path() ? fs::path(file).parent_path() : fs::path(".");
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw Error(file + ": is a folder, expected a file name");
  if (!fs::is_directory(folder, ignored))
    throw Error(file + ": cannot be written, no such folder: " + folder.string());
  if (access(folder.c_str(), W_OK) != 0)
    throw Error(file + ": cannot be written, the folder " + folder.string() + " is write-protected");
}

}  // namespace cairn::cli
