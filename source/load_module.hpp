// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

/// Parts of source that are heavy to load lie in modules of their own, which are loaded when they are first
/// wanted. Internal to source.
namespace cairn::io {

/// What there is to say of a module: file names and words for messages.
struct ModuleNames {
  const char* file;     // "cairn-video.so"
  const char* entry;    // the function in it
  const char* what;     // "videos need"
  const char* library;  // "OpenCV's videoio (libopencv-videoio)": what it links
  const char* package;  // "package cairn-video; it is built where libopencv-videoio-dev is"
};

/// Every module has a function of this name that gives its version, so that none of another build is taken.
inline constexpr const char* kModuleVersion = "cairn_module_version";
using ModuleVersion = const char* (*)();

/// The module's entry; the module stays loaded until the end. Throws Error, for which `source` is what the
/// user asked for.
void* module_entry(const ModuleNames& names, const std::string& source);

}  // namespace cairn::io
