// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/io/load_module.hpp>

#include <dlfcn.h>

#include <cairn/core/error.hpp>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

/// The folder of this code: of the program, or of a library.
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

/// Searched next to that code, above it (tests of a build), and where modules are installed.
std::optional<fs::path> module_file(const char* module) {
  for (const fs::path& folder : own_folders()) {
    for (const fs::path& candidate : {folder / module, folder / ".." / module, folder / "cairn" / module,
                                      folder / ".." / CAIRN_INSTALL_LIBDIR / "cairn" / module}) {
      std::error_code unknown;
      if (fs::is_regular_file(candidate, unknown)) return candidate;
    }
  }
  return std::nullopt;
}

}  // namespace

void* module_entry(const Part& part, const char* function, const std::string& source) {
  const std::optional<fs::path> file = module_file(part.file);
  if (!file) {
    throw Error(source + ": " + part.what + " " + part.file + ", which is not installed next to cairn (" +
                part.package + ")");
  }
  void* module = ::dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    const char* reason = ::dlerror();
    throw Error(source + ": " + part.what + " " + part.library + ": " +
                (reason != nullptr ? reason : file->string()));
  }
  const auto version = reinterpret_cast<const char* (*)()>(::dlsym(module, "cairn_module_version"));
  void* entry = ::dlsym(module, function);
  if (version == nullptr || entry == nullptr || std::string_view(version()) != CAIRN_VERSION)
    throw Error(file->string() + ": is of another version of cairn, expected " CAIRN_VERSION);
  return entry;
}

void* no_entry(const Part& part, const std::string& source) {
  throw Error(source + ": " + part.missing);
}

}  // namespace cairn::io
