// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <functional>
#include <string_view>

namespace CLI {
class App;
}

namespace cairn::cli {

/// The action of a command after its options are parsed; returns the exit code. Throws cairn::Error for bad
/// input.
using Work = std::function<int()>;

/// Each declares its options on `app` and returns its action.
Work declare_segment(CLI::App& app);
Work declare_follow(CLI::App& app);
Work declare_live(CLI::App& app);
Work declare_batch(CLI::App& app);
Work declare_disparity(CLI::App& app);
Work declare_evaluate(CLI::App& app);
Work declare_bench(CLI::App& app);
Work declare_tune(CLI::App& app);
Work declare_calibrate(CLI::App& app);
Work declare_rectify(CLI::App& app);
Work declare_record(CLI::App& app);
Work declare_doctor(CLI::App& app);
Work declare_map(CLI::App& app);
Work declare_agent(CLI::App& app);
Work declare_odometry(CLI::App& app);
Work declare_config(CLI::App& app);
Work declare_info(CLI::App& app);
Work declare_help(CLI::App& app);

/// Declares the command of this name; nullptr if it is not among those of the caller.
using Declare = Work (*)(std::string_view command, CLI::App& app);
/// All of them.
Work declare_any(std::string_view command, CLI::App& app);

struct Command {
  const char* name;
  const char* help;
  const char* examples;  // shell lines, run by a test
};

inline constexpr std::array kCommands{
    Command{"segment", "find the objects of a stereo pair, or of a folder of pairs",
            "cairn segment left.png right.png --calib calib.txt -o result\n"
            "cairn segment frames/ --html -o results\n"
            "cairn segment frames/ --ply --ply-objects -o results\n"
            "cairn segment left.png right.png --preset paper --set match.window_size=11\n"},
    Command{"follow", "follow the camera and the objects through a sequence",
            "cairn follow sequence/ --html -o result\n"
            "cairn follow sequence/ --map room.db --set tracking.min_hits=2\n"},
    Command{"live", "find and follow objects in live camera images, or in a recording at its own pace",
            "cairn live sequence/ --every-frame --json-lines\n"
            "cairn live sequence/ --every-frame --no-tracks --set objects.min_confidence=0.6\n"},
    Command{"batch", "process an archive in shards, on one machine or on many",
            "cairn batch plan frames/ -o run\n"
            "cairn batch work run --shard 1/2\n"
            "cairn batch work run --shard 2/2\n"
            "cairn batch status run\n"
            "cairn batch merge run -o result.jsonl\n"},
    Command{"disparity", "match a stereo pair and check every match",
            "cairn disparity left.png right.png -o disparity.pfm --view disparity.png\n"
            "cairn disparity left.png right.png --calib calib.txt --ply cloud.ply\n"},
    Command{"evaluate", "compare results with the ground truth",
            "cairn evaluate results truth\n"
            "cairn evaluate results truth --html scores --json scores.json\n"},
    Command{"bench", "time each stage on a stereo pair, next to OpenCV's matchers",
            "cairn bench left.png right.png --frames 5\n"
            "cairn bench --size 320x240 --frames 5 --preset paper\n"},
    Command{"tune", "search for the options that do best on your own frames",
            "cairn tune frames/ --truth --budget 5s -o tuned.yaml\n"},
    Command{"doctor", "find the faults of a rig: order, rows, synchrony, range, exposure, focus",
            "cairn doctor left.png right.png --calib calib.txt\n"
            "cairn doctor frames/ --strict --json doctor.json\n"},
    Command{"calibrate", "calibrate both raw cameras from images of a checkerboard",
            "cairn calibrate boards/ --board 9x6 --square 0.025 -o calib.yaml\n"},
    Command{"rectify", "rectify raw image pairs",
            "cairn rectify left.png right.png --calib calib.yaml --nearest 0.5 -o pair\n"},
    Command{"odometry", "estimate the camera's motion through a sequence, without objects",
            "cairn odometry sequence/ -o poses.tum\n"
            "cairn odometry sequence/ --set odometry.max_features=500 --form kitti\n"},
    Command{"record", "write any sequence as a folder of frames, rectified and with stamps",
            "cairn record sequence/ --frames 1:4 -o recorded\n"},
    Command{"map", "show, compare, merge and export maps of landmarks",
            "cairn map show room.db\n"
            "cairn map check room.db\n"
            "cairn map export room.db --form geojson -o room.geojson\n"
            "cairn map merge room.db corridor.db -o both.db\n"
            "cairn map merge room.db corridor.db -o both.db --at corridor=4.2,-1,90\n"},
    Command{"agent", "share one map among robots, and watch them",
            "cairn agent map fleet.db --duration 1\n"
            "cairn agent watch --once --wait 0.5\n"},
    Command{"config", "show the options in force, with value, unit, range and meaning",
            "cairn config --preset paper\n"
            "cairn config --changed --set objects.min_confidence=0.5 > mine.yaml\n"},
    Command{"info", "show version, instruction sets and threads", "cairn info\n"},
    Command{"help", "show the help of a command", "cairn help segment\n"},
};

}  // namespace cairn::cli
