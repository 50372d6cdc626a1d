// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

/// Parts with heavy dependencies are modules, loaded on first use.
namespace cairn::io {

/// A module: file names and words for messages.
struct ModuleNames {
  const char* file;     // "cairn-video.so"
  const char* entry;    // the function in it
  const char* what;     // "videos need"
  const char* library;  // "OpenCV's videoio (libopencv-videoio)": its dependency
  const char* package;  // "package cairn-video; it is built where libopencv-videoio-dev is"
};

/// Every module has a function of this name that returns its version, so that modules of other builds are
/// refused.
inline constexpr const char* kModuleVersion = "cairn_module_version";
using ModuleVersion = const char* (*)();

/// The entry of the module, which stays loaded until exit. Throws Error naming `source`, the user's input.
void* module_entry(const ModuleNames& names, const std::string& source);

}  // namespace cairn::io
