// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cairn/core/error.hpp>
#include <cerrno>
#include <io/atomic_file.hpp>
#include <string>
#include <system_error>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, int reason) {
  throw Error(path.string() + ": cannot be written: " + std::generic_category().message(reason));
}

/// An open file that closes itself; closed() tells whether everything has reached the system.
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

/// Hidden, so that nobody who lists the folder takes it for a result; unlike any other writer's.
fs::path temporary_beside(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  const std::string mark = std::to_string(::getpid()) + "-" + std::to_string(count++);
  return path.parent_path() / ("." + path.filename().string().substr(0, 200) + "." + mark + ".tmp");
}

void write_directly(const fs::path& path, std::string_view bytes) {
  OutputFile file(path, 0);
  if (!file.is_open() || !file.write(bytes) || !file.closed()) refuse(path, errno);
}

void write_and_rename(const fs::path& path, std::string_view bytes) {
  const fs::path temporary = temporary_beside(path);
  OutputFile file(temporary, O_CREAT | O_EXCL);
  if (!file.is_open()) refuse(path, errno);
  if (!file.write(bytes) || !file.closed() || ::rename(temporary.c_str(), path.c_str()) != 0) {
    const int reason = errno;
    ::unlink(temporary.c_str());
    refuse(path, reason);
  }
}

}  // namespace

void write_file(const fs::path& path, std::string_view bytes) {
  if (path.filename().empty()) refuse(path, path.empty() ? ENOENT : EISDIR);
  std::error_code unknown;
  const fs::file_status status = fs::status(path, unknown);
  if (fs::is_directory(status)) refuse(path, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) return write_directly(path, bytes);
  if (fs::is_symlink(fs::symlink_status(path, unknown))) {
    const fs::path target = fs::weakly_canonical(path, unknown);
    if (unknown) refuse(path, unknown.value());
    return write_and_rename(target, bytes);
  }
  write_and_rename(path, bytes);
}

void make_folder(const fs::path& path) {
  std::error_code reason;
  fs::create_directories(path, reason);
  if (!reason && !fs::is_directory(path, reason) && !reason)
    reason = std::make_error_code(std::errc::not_a_directory);
  if (reason) throw Error(path.string() + ": cannot be made a folder: " + reason.message());
}

}  // namespace cairn::io
