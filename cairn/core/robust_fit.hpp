// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

/// Statistics that tolerate many false values. Private to the library.
namespace cairn {

/// The quantile at `share`, 0 … 1; NaN without values.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  const auto last = static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::lround(share * last));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Σ parameters · terms = value
template <std::size_t N>
struct Equation {
  std::array<double, N> terms{};
  double value = 0;
};

template <std::size_t N>
double predicted(const std::array<double, N>& parameters, const std::array<double, N>& terms) {
  double sum = 0;
  for (std::size_t i = 0; i < N; ++i) sum += parameters[i] * terms[i];
  return sum;
}

/// Solves the symmetric, positive definite system m · x = b by Cholesky decomposition.
template <std::size_t N>
std::array<double, N> solve_symmetric(std::array<std::array<double, N>, N> m, std::array<double, N> b) {
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = m[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= m[i][k] * m[j][k];
      m[i][j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / m[j][j];
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= m[i][k] * b[k];
    b[i] /= m[i][i];
  }
  for (std::size_t i = N; i-- > 0;) {
    for (std::size_t k = i + 1; k < N; ++k) b[i] -= m[k][i] * b[k];
    b[i] /= m[i][i];
  }
  return b;
}

/// Fits the parameters to most of the equations by iteratively reweighted least squares with Cauchy weights.
/// The scale shrinks from round to round down to `scale`, the residual that halves the weight of an equation.
/// Terms should be of the order of 1; a small Tikhonov ridge keeps undetermined parameters near 0. The first
/// term is the constant.
template <std::size_t N>
std::array<double, N> fit_robustly(std::span<const Equation<N>> equations, double scale) {
  std::array<double, N> parameters{};
  std::vector<double> values;
  for (const Equation<N>& e : equations) values.push_back(e.value);
  if (values.empty()) return parameters;
  parameters[0] = quantile(values, 0.5);
  for (double& value : values) value = std::abs(value - parameters[0]);
  constexpr int kRounds = 24;
  constexpr double kRidge = 2e-3;
  double width = std::max(scale, 2 * quantile(values, 0.5));
  for (int round = 0; round < kRounds; ++round) {
    std::array<std::array<double, N>, N> normal{};
    std::array<double, N> right{};
    double total = 0;
    for (const Equation<N>& e : equations) {
      const double ratio = (e.value - predicted(parameters, e.terms)) / width;
      const double weight = 1 / (1 + ratio * ratio);
      total += weight;
      for (std::size_t i = 0; i < N; ++i) {
        right[i] += weight * e.terms[i] * e.value;
        for (std::size_t j = 0; j <= i; ++j) normal[i][j] += weight * e.terms[i] * e.terms[j];
      }
    }
    for (std::size_t i = 1; i < N; ++i) normal[i][i] += kRidge * total;
    parameters = solve_symmetric(normal, right);
    width = std::max(scale, 0.8 * width);
  }
  return parameters;
}

}  // namespace cairn
