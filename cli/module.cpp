// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>

#include "app.hpp"

extern "C" __attribute__((visibility("default"))) int cairn_run_command(int argc, const char* const* argv) {
  return cairn::cli::run(argc, argv, cairn::cli::declare_any);
}
