// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string_view>

/// The layouts, styles and scripts of the pages, built into the program; internal to the pages. A layout has
/// the places {{title}}, {{style}}, {{data}} and {{script}}, and live.html {{nonce}}.
namespace cairn::output {

extern const std::string_view kSharedStyle;   // shared.css, before each page's own
extern const std::string_view kSharedScript;  // shared.js, before each page's own
extern const std::string_view kPageLayout;    // page.html
extern const std::string_view kPageStyle;     // page.css
extern const std::string_view kPageScript;    // page.js
extern const std::string_view kFollowLayout;  // follow.html
extern const std::string_view kFollowStyle;   // follow.css
extern const std::string_view kFollowScript;  // follow.js
extern const std::string_view kLiveLayout;    // live.html
extern const std::string_view kLiveStyle;     // live.css
extern const std::string_view kLiveScene;     // live_scene.js, before live.js
extern const std::string_view kLiveScript;    // live.js

}  // namespace cairn::output
