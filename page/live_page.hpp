// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

/// The page of `cairn live --view`: a client of the server that it comes from. (docs/live_view.md)
namespace cairn::io {

/// The page's HTML. Its script and style have `nonce`, which the Content-Security-Policy that it is sent with
/// names, new for each answer. It needs img-src data:, and connect-src of the host that it came from.
std::string live_page(const std::string& nonce);

}  // namespace cairn::io
