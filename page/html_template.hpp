// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string_view>

/// page.html, page.css and page.js, built into the program; internal to the page.
namespace cairn::io {

extern const std::string_view kPageLayout;  // page.html, with {{title}}, {{style}}, {{data}} and {{script}}
extern const std::string_view kPageStyle;   // page.css
extern const std::string_view kPageScript;  // page.js

}  // namespace cairn::io
