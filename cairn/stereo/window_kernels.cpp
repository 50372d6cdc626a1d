// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <array>
#include <cairn/core/target.hpp>
#include <cairn/stereo/window_kernels.hpp>
#include <cstddef>
#include <utility>

namespace cairn::kernels {
namespace {

using OfTarget = const WindowKernels* (*)(Target);

/// In the order of kCosts.
template <std::size_t... kNumbers>
constexpr std::array<OfTarget, sizeof...(kNumbers)> of_costs(std::index_sequence<kNumbers...>) {
  return {window_kernels<kCosts[kNumbers].value>...};
}

}  // namespace

const WindowKernels& window_kernels(Cost cost, const Exec& exec) {
  constexpr std::array kOfCosts = of_costs(std::make_index_sequence<kCosts.size()>());
  std::size_t number = 0;
  while (kCosts[number].value != cost) ++number;
  return *kOfCosts[number](active_target(exec));
}

}  // namespace cairn::kernels
