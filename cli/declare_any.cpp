// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <array>
#include <utility>

#include "commands.hpp"

namespace cairn::cli {

Work declare_any(std::string_view command, CLI::App& app) {
  using Declaration = std::pair<std::string_view, Work (*)(CLI::App&)>;
  constexpr std::array kDeclarations{Declaration{"segment", declare_segment},
                                     Declaration{"follow", declare_follow},
                                     Declaration{"live", declare_live},
                                     Declaration{"batch", declare_batch},
                                     Declaration{"disparity", declare_disparity},
                                     Declaration{"evaluate", declare_evaluate},
                                     Declaration{"bench", declare_bench},
                                     Declaration{"tune", declare_tune},
                                     Declaration{"calibrate", declare_calibrate},
                                     Declaration{"rectify", declare_rectify},
                                     Declaration{"record", declare_record},
                                     Declaration{"doctor", declare_doctor},
                                     Declaration{"map", declare_map},
                                     Declaration{"agent", declare_agent},
                                     Declaration{"odometry", declare_odometry},
                                     Declaration{"config", declare_config},
                                     Declaration{"info", declare_info},
                                     Declaration{"help", declare_help}};
  for (const auto& [name, declare] : kDeclarations) {
    if (name == command) return declare(app);
  }
  return nullptr;
}

}  // namespace cairn::cli
