// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <dlfcn.h>

#include <cairn/core/error.hpp>
#include <string_view>
#include <system_error>
#include <vector>

#include "open_video.hpp"
#include "video/module.hpp"

/// FFmpeg and what OpenCV brings with it are 200 libraries, which take a quarter of a second to load. So they
/// are loaded with the first video, and no other command pays for them.
namespace cairn::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModule = "cairn-video.so";

/// Where this code lies: a program, or a library that somebody else has loaded.
std::vector<fs::path> own_folders() {
  std::vector<fs::path> folders;
  std::error_code unknown;
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&own_folders), &info) != 0 && info.dli_fname != nullptr) {
    const fs::path library = fs::canonical(info.dli_fname, unknown);
    if (!unknown) folders.push_back(library.parent_path());
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", unknown);
  if (!unknown) folders.push_back(program.parent_path());
  return folders;
}

/// Beside it, above it (a build's tests), and where it is installed.
std::optional<fs::path> module_file() {
  for (const fs::path& folder : own_folders()) {
    for (const fs::path& candidate : {folder / kModule, folder / ".." / kModule, folder / "cairn" / kModule,
                                      folder / ".." / CAIRN_INSTALL_LIBDIR / "cairn" / kModule}) {
      std::error_code unknown;
      if (fs::is_regular_file(candidate, unknown)) return candidate;
    }
  }
  return std::nullopt;
}

VideoEntry video_entry(const fs::path& video) {
  const std::optional<fs::path> file = module_file();
  if (!file) {
    throw Error(video.string() + ": videos need " + kModule +
                ", which is not installed beside cairn (package cairn-video; it is built where "
                "libopencv-videoio-dev is)");
  }
  void* module = ::dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL);  // stays until the end
  if (module == nullptr) {
    const char* reason = ::dlerror();
    throw Error(video.string() + ": videos need OpenCV's videoio (libopencv-videoio): " +
                (reason != nullptr ? reason : file->string()));
  }
  const auto version = reinterpret_cast<VideoVersion>(::dlsym(module, kVideoVersion));
  const auto entry = reinterpret_cast<VideoEntry>(::dlsym(module, kVideoEntry));
  if (version == nullptr || entry == nullptr || std::string_view(version()) != CAIRN_VERSION)
    throw Error(file->string() + ": is of another version of cairn, expected " CAIRN_VERSION);
  return entry;
}

}  // namespace

std::unique_ptr<Sequence> open_video(const fs::path& file, const SourceOptions& options, const Pool& pool) {
  return std::unique_ptr<Sequence>(video_entry(file)({file, {}, options, pool}));
}

std::unique_ptr<Sequence> open_videos(const fs::path& left, const fs::path& right,
                                      const SourceOptions& options, const Pool& pool) {
  return std::unique_ptr<Sequence>(video_entry(left)({left, right, options, pool}));
}

}  // namespace cairn::io
