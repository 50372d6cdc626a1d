// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/target.hpp>
#include <string>
#include <utility>

#if CAIRN_WITH_HWY
#include <cairn/core/highway_targets.hpp>
// After highway_targets.hpp, which selects the targets.
#include <hwy/targets.h>
#endif

namespace cairn {
namespace {

constexpr std::array kNames{std::pair{Target::best, std::string_view("best")},
                            std::pair{Target::scalar, std::string_view("scalar")},
                            std::pair{Target::sse4, std::string_view("sse4")},
                            std::pair{Target::avx2, std::string_view("avx2")},
                            std::pair{Target::avx512, std::string_view("avx512")},
                            std::pair{Target::neon, std::string_view("neon")}};

/// Whether the kernels are compiled for this target: see each_target-inl.hpp.
constexpr bool is_compiled(Target target) {
  if (target == Target::scalar) return true;
#if CAIRN_WITH_HWY
  if (target == Target::sse4) return (HWY_TARGETS & HWY_SSE4) != 0;
  if (target == Target::avx2) return (HWY_TARGETS & HWY_AVX2) != 0;
  if (target == Target::avx512) return (HWY_TARGETS & HWY_AVX3) != 0;
  if (target == Target::neon) return (HWY_TARGETS & HWY_NEON) != 0;
#endif
  return false;
}

bool runs_here(Target target) {
  if (target == Target::scalar) return true;
#if CAIRN_WITH_HWY && HWY_ARCH_ARM_A64
  // Every 64-bit ARM processor has it. Highway asks for AES as well, which is not used here.
  if (target == Target::neon) return true;
#elif CAIRN_WITH_HWY
  // Queried once: in a virtual machine, CPUID takes as long as several rows of an image.
  static const std::int64_t supported = hwy::SupportedTargets();
  const auto has = [](std::int64_t bit) { return (supported & bit) != 0; };
#if HWY_ARCH_X86
  if (target == Target::sse4) return has(HWY_SSE4);
  if (target == Target::avx2) return has(HWY_AVX2);
  if (target == Target::avx512) return has(HWY_AVX3);
#elif HWY_ARCH_ARM
  if (target == Target::neon) return has(HWY_NEON);
#endif
#endif
  return false;
}

}  // namespace

std::vector<Target> compiled_targets() {
  std::vector<Target> targets;
  for (const auto& [target, unused] : kNames) {
    if (is_compiled(target)) targets.push_back(target);
  }
  return targets;
}

std::vector<Target> supported_targets() {
  std::vector<Target> targets = compiled_targets();
  std::erase_if(targets, [](Target target) { return !runs_here(target); });
  return targets;
}

Target active_target(const Exec& exec) {
  const std::vector<Target> targets = supported_targets();
  if (exec.target == Target::best) return targets.back();
  return std::find(targets.begin(), targets.end(), exec.target) != targets.end() ? exec.target
                                                                                 : Target::scalar;
}

std::string_view name(Target target) {
  for (const auto& [known, text] : kNames) {
    if (known == target) return text;
  }
  return "unknown";
}

std::optional<Target> target_named(std::string_view name) {
  for (const auto& [target, text] : kNames) {
    if (text == name) return target;
  }
  return std::nullopt;
}

Target wanted_target(std::string_view wanted, std::string_view source) {
  const std::vector<Target> supported = supported_targets();
  std::string expected = "best";
  for (const Target target : supported) expected += ", " + std::string(name(target));
  const std::optional<Target> target = target_named(wanted);
  if (!target) {
    std::vector<std::string> names{"best"};
    for (const Target known : supported) names.emplace_back(name(known));
    const std::string close = nearest(wanted, names);
    throw Error(std::string(source) + ": unknown instruction set '" + std::string(wanted) +
                "', expected one of " + expected + (close.empty() ? "" : "; did you mean '" + close + "'?"));
  }
  if (*target != Target::best && std::find(supported.begin(), supported.end(), *target) == supported.end()) {
    throw Error(std::string(source) + ": instruction set " + std::string(wanted) +
                " is not available in this build or on this processor, expected one of " + expected);
  }
  return *target;
}

}  // namespace cairn
