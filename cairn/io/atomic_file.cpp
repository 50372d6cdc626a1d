// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cerrno>
#include <string>
#include <system_error>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, int reason) {
  throw Error(path.string() + ": cannot be written: " + std::generic_category().message(reason));
}

/// An open file that closes itself; closed() returns whether all data reached the system.
class OutputFile {
 public:
  OutputFile(const fs::path& path, int flags)
      : descriptor_(::open(path.c_str(), flags | O_WRONLY | O_CLOEXEC, 0666)) {}
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  [[nodiscard]] bool is_open() const { return descriptor_ >= 0; }

  [[nodiscard]] bool write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
  }
  [[nodiscard]] bool closed() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return ::close(descriptor) == 0;
  }

 private:
  int descriptor_;
};

/// Hidden, so that a listing does not show it as a result; unique for each writer.
fs::path temporary_next_to(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  const std::string mark = std::to_string(::getpid()) + "-" + std::to_string(count++);
  return path.parent_path() / ("." + path.filename().string().substr(0, 200) + "." + mark + ".tmp");
}

/// Whether it is a device or a pipe, which has no content to replace.
bool takes_bytes_directly(const fs::path& path) {
  std::error_code unknown;
  const fs::file_status status = fs::status(path, unknown);
  return fs::exists(status) && !fs::is_regular_file(status);
}

/// The final location of `path`, following symbolic links. Rejects paths that cannot be files.
fs::path target_of(const fs::path& path) {
  if (path.filename().empty()) refuse(path, path.empty() ? ENOENT : EISDIR);
  std::error_code unknown;
  if (fs::is_directory(fs::status(path, unknown))) refuse(path, EISDIR);
  if (takes_bytes_directly(path) || !fs::is_symlink(fs::symlink_status(path, unknown))) return path;
  fs::path target = fs::weakly_canonical(path, unknown);
  if (unknown) refuse(path, unknown.value());
  return target;
}

}  // namespace

struct GrowingFile::State {
  explicit State(const fs::path& final_path)
      : path(target_of(final_path)),
        temporary(takes_bytes_directly(path) ? fs::path() : temporary_next_to(path)),
        file(temporary.empty() ? path : temporary, temporary.empty() ? 0 : O_CREAT | O_EXCL) {
    if (!file.is_open()) refuse(path, errno);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (!temporary.empty() && !is_finished) ::unlink(temporary.c_str());
  }

  fs::path path;
  fs::path temporary;  // empty if `path` is written directly
  OutputFile file;
  bool is_finished = false;
};

GrowingFile::GrowingFile(const fs::path& path) : state_(std::make_unique<State>(path)) {}
GrowingFile::GrowingFile(GrowingFile&&) noexcept = default;
GrowingFile& GrowingFile::operator=(GrowingFile&&) noexcept = default;
GrowingFile::~GrowingFile() = default;

void GrowingFile::append(std::string_view bytes) {
  if (!state_->file.write(bytes)) refuse(state_->path, errno);
}

void GrowingFile::finish() {
  State& state = *state_;
  if (!state.file.closed() ||
      (!state.temporary.empty() && ::rename(state.temporary.c_str(), state.path.c_str()) != 0)) {
    refuse(state.path, errno);
  }
  state.is_finished = true;
}

void write_file(const fs::path& path, std::string_view bytes) {
  GrowingFile file(path);
  file.append(bytes);
  file.finish();
}

void make_folder(const fs::path& path) {
  std::error_code reason;
  fs::create_directories(path, reason);
  if (!reason && !fs::is_directory(path, reason) && !reason)
    reason = std::make_error_code(std::errc::not_a_directory);
  if (reason) throw Error(path.string() + ": cannot be created as a folder: " + reason.message());
}

}  // namespace cairn::io
