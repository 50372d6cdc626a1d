// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace cairn::io {

/// Writes a file atomically: the bytes go to a temporary file in the same folder, which is then renamed.
/// Concurrent readers of `path` see the old file or the new one; a failure leaves no trace. Symbolic links
/// are followed; devices (/dev/null, /dev/stdout) are written directly. Throws Error (names `path` and the
/// system's reason).
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// The same for a file written in pieces: it gets its final name in finish(). An unfinished file leaves no
/// trace.
class GrowingFile {
 public:
  /// Throws Error like write_file().
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

/// Creates a folder with all its parents, unless it exists. Throws Error.
void make_folder(const std::filesystem::path& path);

}  // namespace cairn::io
