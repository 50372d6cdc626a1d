// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <cairn/core/error.hpp>
#include <cairn/core/target.hpp>
#include <cairn/device/device.hpp>
#include <cairn/timing/opencv_matchers.hpp>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"
#include "rig_report.hpp"

namespace cairn::cli {
namespace {

std::string names(const std::vector<Target>& targets) {
  std::string all;
  for (const Target target : targets) all += (all.empty() ? "" : " ") + std::string(name(target));
  return all;
}

std::string device_line(const device::Listed& one) {
  std::string line = one.name + " (" + one.kind + ", " + one.driver + "; buffers up to " +
                     std::to_string(one.largest_buffer_bytes / 1'000'000) + " MB, groups of " +
                     std::to_string(one.group) + ", subgroups of " + std::to_string(one.subgroup) + ")";
  if (!one.unusable.empty()) return line + "; cannot be used: " + one.unusable;
  if (!one.not_by_itself.empty()) return line + "; not taken by auto: " + one.not_by_itself;
  return line;
}

std::string device_list() {
  std::string lines = "devices\n";
  try {
    const std::vector<device::Listed> all = device::devices();
    for (std::size_t i = 0; i < all.size(); ++i)
      lines += "  " + std::to_string(i) + "  " + device_line(all[i]) + "\n";
    if (all.empty()) lines += "  none\n";
  } catch (const Error& none) {
    lines += std::string("  none: ") + none.what() + "\n";
  }
  return lines;
}

int show(const ExecOptions& options) {
  const Exec exec = make_exec(options);
  std::cout << "cairn " << CAIRN_VERSION << "\n"
            << "instruction sets\n"
            << "  compiled   " << names(compiled_targets()) << "\n"
            << "  supported  " << names(supported_targets()) << "\n"
            << "  active     " << name(active_target(exec)) << "\n"
            << "threads      " << exec.threads() << "\n"
            << "built in\n";
  for (const BuiltPart& part : built_parts()) {
    constexpr std::size_t kColumn = 42;
    std::string what = part.what;
    what.resize(kColumn, ' ');
    std::cout << "  " << what << (part.is_in ? "yes" : std::string("no; needs ") + part.packages) << "\n";
  }
  std::cout << device_list();
  return 0;
}

}  // namespace

std::vector<BuiltPart> built_parts() {
  return {
      {"SIMD (Highway)", CAIRN_WITH_HWY != 0, "libhwy-dev, CAIRN_SIMD=ON"},
      {"threads (oneTBB)", CAIRN_WITH_TBB != 0, "libtbb-dev, CAIRN_TBB=ON"},
      {"calibrate, rectify", CAIRN_WITH_CALIBRATION != 0, "libopencv-calib3d-dev"},
      {"OpenCV's matchers in bench", !timing::opencv_version().empty(), "libopencv-calib3d-dev"},
      {"sequences: follow, odometry, map, record", CAIRN_WITH_SEQUENCES != 0,
       "libopencv-video-dev libopencv-calib3d-dev libeigen3-dev libdlib-dev "
       "libsqlitecpp-dev"},
      {"videos as sequences", CAIRN_WITH_VIDEO != 0, "libopencv-videoio-dev"},
      {"cameras by GStreamer: gst:, rtsp://", CAIRN_WITH_GSTREAMER != 0,
       "libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev"},
      {"recordings (MCAP), packed batch results", CAIRN_WITH_ZSTD != 0, "libzstd-dev"},
      {"live views: live --view", CAIRN_WITH_VIEW != 0, "libboost-dev libssl-dev"},
      {"topics of ROS 2 (Cyclone DDS)", CAIRN_WITH_DDS != 0, "cyclonedds-dev"},
      {"graphics processors (Vulkan)", CAIRN_WITH_VULKAN != 0, "libvulkan-dev glslc"},
      {"manual pages", CAIRN_WITH_MANUAL != 0, "help2man"},
      {"Python module", CAIRN_WITH_PYTHON != 0, "python3-dev pybind11-dev, CAIRN_PYTHON=ON"},
  };
}

Work declare_info(CLI::App& app) {
  auto options = std::make_shared<ExecOptions>();
  add_exec_options(app, *options);
  return [options] { return show(*options); };
}

}  // namespace cairn::cli
