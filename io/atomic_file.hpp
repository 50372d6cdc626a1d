// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace cairn::io {

/// Writes a whole file or nothing: the bytes go to a temporary name in the same folder, which then takes the
/// final name. Whoever reads `path` meanwhile sees the old file or the new one, never a part; after a failure
/// no trace is left. A symbolic link is followed; a device (/dev/null, /dev/stdout) is written directly.
/// Throws Error (names `path` and the system's reason).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The same of a file that is written bit by bit: it has its final name when finish() has returned. One that
/// is not finished leaves no trace.
class GrowingFile {
 public:
  /// Throws Error as write_file() does.
  explicit GrowingFile(const std::filesystem::path& path);
  GrowingFile(GrowingFile&&) noexcept;
  GrowingFile& operator=(GrowingFile&&) noexcept;
  ~GrowingFile();

  void append(std::string_view bytes);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Makes a folder with all its parents; fine where it is there already. Throws Error.
void make_folder(const std::filesystem::path& path);

}  // namespace cairn::io
