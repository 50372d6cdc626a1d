// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

/// The page of `cairn live --view`: a client of the server that it comes from. (docs/live_view.md)
namespace cairn::io {

/// The page's HTML. `nonce`: new for each answer, as in its policy; letters, digits, +, / and =.
std::string live_page(const std::string& nonce);

/// The Content-Security-Policy to send with it: the page's own script and style, images that it makes itself,
/// and connections to the host and port that it came from.
std::string live_page_policy(const std::string& nonce);

}  // namespace cairn::io
