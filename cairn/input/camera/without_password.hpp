// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

namespace cairn::input {

/// Hides name and password in messages and files: "rtsp://***@host/".
std::string without_password(std::string text);

}  // namespace cairn::input
