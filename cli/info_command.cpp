// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/target.hpp>
#include <iostream>
#include <timing/opencv_matchers.hpp>

#include "commands.hpp"
#include "common.hpp"

namespace cairn::cli {
namespace {

std::string names(const std::vector<Target>& targets) {
  std::string all;
  for (const Target target : targets) all += (all.empty() ? "" : " ") + std::string(name(target));
  return all;
}

const char* yes_or_no(bool built_in) {
  return built_in ? "yes" : "no";
}

int show(const ExecOptions& options) {
  const Exec exec = make_exec(options);
  std::cout << "cairn " << CAIRN_VERSION << "\n"
            << "instruction sets\n"
            << "  compiled   " << names(compiled_targets()) << "\n"
            << "  supported  " << names(supported_targets()) << "\n"
            << "  active     " << name(active_target(exec)) << "\n"
            << "threads      " << exec.threads() << "\n"
            << "built in\n"
            << "  SIMD (Highway)                          " << yes_or_no(CAIRN_WITH_HWY != 0) << "\n"
            << "  threads (oneTBB)                        " << yes_or_no(CAIRN_WITH_TBB != 0) << "\n"
            << "  calibrate, rectify (OpenCV's calib3d)   " << yes_or_no(CAIRN_WITH_CALIBRATION != 0) << "\n"
            << "  peers in bench (OpenCV's calib3d)       " << yes_or_no(!report::opencv_version().empty())
            << "\n";
  return 0;
}

}  // namespace

Work declare_info(CLI::App& app) {
  auto options = std::make_shared<ExecOptions>();
  add_exec_options(app, *options);
  return [options] { return show(*options); };
}

}  // namespace cairn::cli
