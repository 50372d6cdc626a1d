// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/read_file.hpp>
#include <cerrno>
#include <system_error>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

struct InputFile {
  explicit InputFile(const fs::path& path) : descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile() {
    if (descriptor >= 0) ::close(descriptor);
  }
  int descriptor;
};

[[noreturn]] void refuse(const fs::path& path, int reason) {
  throw Error(path.string() + ": cannot be read: " + std::generic_category().message(reason));
}

}  // namespace

std::string read_file(const fs::path& path, std::size_t most_bytes) {
  const InputFile file(path);
  if (file.descriptor < 0) refuse(path, errno);
  struct stat status = {};
  if (::fstat(file.descriptor, &status) != 0) refuse(path, errno);
  if (S_ISDIR(status.st_mode)) throw Error(path.string() + ": is a folder, expected a file");

  // The length only sizes the first allocation, as pipes have none; the loop reads to the end.
  const auto length = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
  std::string bytes(std::min(length, most_bytes) + 1, '\0');
  std::size_t filled = 0;
  for (;;) {
    if (filled > most_bytes) {
      throw Error(path.string() + ": has more than " + std::to_string(most_bytes) + " bytes, expected fewer");
    }
    if (filled == bytes.size()) bytes.resize(2 * bytes.size() + 4096);
    const ssize_t count = ::read(file.descriptor, bytes.data() + filled, bytes.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuse(path, errno);
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  bytes.resize(filled);
  return bytes;
}

}  // namespace cairn::io
