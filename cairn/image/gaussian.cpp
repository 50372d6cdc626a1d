// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/image/gaussian.hpp>
#include <cmath>
#include <cstddef>

namespace cairn {

Kernel gaussian(float sigma) {
  Kernel kernel;
  if (!(sigma > 0)) return kernel;
  const double s = sigma;
  const int reach = static_cast<int>(std::min(std::ceil(3 * s), static_cast<double>(kMaxRadius)));
  const auto bell = [s](int i) { return std::exp(-0.5 * i * i / (s * s)); };
  double total = 1;
  for (int i = 1; i <= reach; ++i) total += 2 * bell(i);
  for (int i = 1; i <= reach; ++i) {
    const auto at = static_cast<std::size_t>(i);
    kernel.weights[at] = static_cast<int>(std::lround(kWeightSum * bell(i) / total));
    kernel.weights[0] -= 2 * kernel.weights[at];
    if (kernel.weights[at] > 0) kernel.radius = i;  // skips taps rounded to 0
  }
  return kernel;
}

}  // namespace cairn
