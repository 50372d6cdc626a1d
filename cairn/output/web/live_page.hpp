// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

/// The page of `cairn live --view`: a client of the server that it comes from. (docs/live_view.md)
namespace cairn::output {

/// The HTML of the page. Its script and style have `nonce`, named in the Content-Security-Policy header and
/// new for each answer. It needs img-src data:, and connect-src to its own host.
std::string live_page(const std::string& nonce);

}  // namespace cairn::output
