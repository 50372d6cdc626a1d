// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <functional>

namespace cairn::cli {

/// What a command does once its options are read; returns the exit code. Throws cairn::Error for bad input.
using Work = std::function<int()>;

/// Each declares its options on `app` and returns the work that uses them.
Work declare_segment(CLI::App& app);
Work declare_disparity(CLI::App& app);
Work declare_evaluate(CLI::App& app);
Work declare_bench(CLI::App& app);
Work declare_tune(CLI::App& app);
Work declare_calibrate(CLI::App& app);
Work declare_rectify(CLI::App& app);
Work declare_doctor(CLI::App& app);
Work declare_config(CLI::App& app);
Work declare_info(CLI::App& app);

struct Command {
  const char* name;
  const char* help;
  Work (*declare)(CLI::App&);
};

inline constexpr std::array kCommands{
    Command{"segment", "find the objects of a stereo pair, or of a folder of pairs", declare_segment},
    Command{"disparity", "match a stereo pair and check every match", declare_disparity},
    Command{"evaluate", "compare results with the truth", declare_evaluate},
    Command{"bench", "time each stage on a stereo pair, with OpenCV's matchers beside it", declare_bench},
    Command{"tune", "search the options that do best on your own frames", declare_tune},
    Command{"doctor", "tell what is wrong with a rig: order, rows, synchrony, range, exposure, focus",
            declare_doctor},
    Command{"calibrate", "find both raw cameras from pictures of a checkerboard", declare_calibrate},
    Command{"rectify", "turn raw pictures into those of a rectified pair", declare_rectify},
    Command{"config", "show every option with its value, unit, range and meaning", declare_config},
    Command{"info", "show version, instruction sets and threads", declare_info},
};

}  // namespace cairn::cli
