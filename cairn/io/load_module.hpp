// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

/// Parts with heavy dependencies. Each is a module, which is loaded on first use; linked directly under the
/// sanitizers, which do not follow dlopen(); or not built (cairn/CMakeLists.txt).
#define CAIRN_EXPORT __attribute__((visibility("default")))
/// The address of a part's function. `how`: none, module, direct. `source`: the user's input, for messages.
#define CAIRN_ENTRY(how, function, part, source) CAIRN_ENTRY_OF(how, function, part, source)
#define CAIRN_ENTRY_OF(how, function, part, source) CAIRN_ENTRY_##how(function, part, source)
#define CAIRN_ENTRY_none(function, part, source) \
  reinterpret_cast<decltype(&function)>(::cairn::io::no_entry(part, source))
#define CAIRN_ENTRY_module(function, part, source) \
  reinterpret_cast<decltype(&function)>(::cairn::io::module_entry(part, #function, source))
#define CAIRN_ENTRY_direct(function, part, source) (static_cast<void>(part), &function)

namespace cairn::io {

/// A part: its module's file, and words for messages.
struct Part {
  const char* file;          // "cairn-video.so"
  const char* what;          // "videos need"
  const char* library;       // "OpenCV's videoio (libopencv-videoio)": its dependency
  const char* package;       // "package cairn-video; it is built where libopencv-videoio-dev is"
  const char* missing = "";  // "videos are not built in: they need …"
};

/// The function in the module, which stays loaded until exit. Throws Error, also for a module of another build.
void* module_entry(const Part& part, const char* function, const std::string& source);
/// Throws Error: the part is not built in.
void* no_entry(const Part& part, const std::string& source);

}  // namespace cairn::io
