// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/robust_fit.hpp>
#include <cairn/diagnosis/row_alignment.hpp>
#include <cmath>

namespace cairn {
namespace {

constexpr double kAgreeRows = 1.0;
constexpr double kCloseRows = 0.5;
constexpr double kGain = 1.15;  // a distortion must bring this factor more points close than the line does
constexpr double kCertain = 5;  // standard errors of the roll

using LineTerms = std::array<double, 2>;
using FieldTerms = std::array<double, 7>;

/// Normalises positions and disparities to the order of 1.
struct Frame {
  double middle_x = 0;
  double middle_y = 0;
  double middle_disparity = 0;
  double unit = 1;  // px; half the width

  [[nodiscard]] LineTerms line(const Correspondence& c) const {
    return {1, (static_cast<double>(c.x_right) - middle_x) / unit};
  }
  [[nodiscard]] FieldTerms field(const Correspondence& c) const {
    const double u = (static_cast<double>(c.x_right) - middle_x) / unit;
    const double v = (static_cast<double>(c.y_right) - middle_y) / unit;
    const double near = (static_cast<double>(c.disparity()) - middle_disparity) / (0.2 * unit);
    return {1, u, v, u * u, u * v, v * v, near};
  }
};

Frame frame_of(const Correspondences& found) {
  std::vector<double> disparities;
  for (const Correspondence& c : found.list) disparities.push_back(static_cast<double>(c.disparity()));
  return {0.5 * (found.size.width - 1), 0.5 * (found.size.height - 1),
          disparities.empty() ? 0.0 : quantile(disparities, 0.5), 0.5 * found.size.width};
}

/// The expected row difference of each correspondence.
struct Rows {
  std::array<double, 2> line{};
  std::vector<double> expected;
  bool is_field = false;
};

template <std::size_t N, class Terms>
std::vector<Equation<N>> equations_of(const Correspondences& found, Terms terms) {
  std::vector<Equation<N>> equations;
  for (const Correspondence& c : found.list) equations.push_back({terms(c), static_cast<double>(c.rows())});
  return equations;
}

template <std::size_t N>
std::vector<double> values_of(const std::vector<Equation<N>>& equations, const std::array<double, N>& p) {
  std::vector<double> values;
  values.reserve(equations.size());
  for (const Equation<N>& e : equations) values.push_back(predicted(p, e.terms));
  return values;
}

std::ptrdiff_t within(const Correspondences& found, const std::vector<double>& expected, double rows) {
  std::ptrdiff_t count = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    count += std::abs(static_cast<double>(found.list[i].rows()) - expected[i]) <= rows ? 1 : 0;
  return count;
}

/// The line nearest to the fitted distortion, over the points consistent with it.
std::array<double, 2> line_through(const Correspondences& found, std::vector<Equation<2>> equations,
                                   const std::vector<double>& expected) {
  std::vector<Equation<2>> kept;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (std::abs(static_cast<double>(found.list[i].rows()) - expected[i]) > kAgreeRows) continue;
    kept.push_back(equations[i]);
    kept.back().value = expected[i];
  }
  constexpr double kAlmostSquares = 1e3;
  return fit_robustly<2>(kept, kAlmostSquares);
}

/// Whether the roll is significant: a few points in a small part of the image can suggest one by chance.
bool is_certain(const std::vector<Equation<2>>& equations, const std::array<double, 2>& line) {
  double count = 0;
  double sum = 0;
  double squares = 0;
  double residuals = 0;
  for (const Equation<2>& e : equations) {
    const double residual = e.value - predicted(line, e.terms);
    if (std::abs(residual) > kAgreeRows) continue;
    count += 1;
    sum += e.terms[1];
    squares += e.terms[1] * e.terms[1];
    residuals += residual * residual;
  }
  if (count < RowAlignment::kMinForRoll) return false;
  const double spread = squares - sum * sum / count;
  return std::abs(line[1]) * std::sqrt(spread * count) > kCertain * std::sqrt(residuals);
}

Rows rows_of(const Correspondences& found) {
  const Frame frame = frame_of(found);
  Rows rows;
  const auto lines = equations_of<2>(found, [&](const Correspondence& c) { return frame.line(c); });
  rows.line = fit_robustly<2>(lines, kCloseRows);
  if (!is_certain(lines, rows.line)) {
    const auto shifts =
        equations_of<1>(found, [](const Correspondence&) { return std::array<double, 1>{1}; });
    rows.line = {fit_robustly<1>(shifts, kCloseRows)[0], 0};
  }
  rows.expected = values_of<2>(lines, rows.line);
  if (found.list.size() < RowAlignment::kMinForField) return rows;
  const auto fields = equations_of<7>(found, [&](const Correspondence& c) { return frame.field(c); });
  std::vector<double> expected = values_of<7>(fields, fit_robustly<7>(fields, kCloseRows));
  const auto by_line = static_cast<double>(within(found, rows.expected, kCloseRows));
  const auto by_field = static_cast<double>(within(found, expected, kCloseRows));
  if (by_field < std::max(static_cast<double>(RowAlignment::kMinForField), kGain * by_line)) return rows;
  rows.expected = std::move(expected);
  rows.line = line_through(found, lines, rows.expected);
  rows.is_field = true;
  return rows;
}

}  // namespace

RowAlignment measure_row_alignment(const Correspondences& found) {
  RowAlignment result;
  result.points = static_cast<int>(found.list.size());
  if (found.list.empty()) return result;
  for (const Correspondence& c : found.list) {
    const long bin = std::clamp(std::lround(c.rows()), -static_cast<long>(RowAlignment::kMaxBins),
                                static_cast<long>(RowAlignment::kMaxBins));
    ++result.histogram[static_cast<std::size_t>(bin + RowAlignment::kMaxBins)];
  }
  const Rows rows = rows_of(found);
  const Frame frame = frame_of(found);
  result.offset_rows = static_cast<float>(rows.line[0]);
  result.rows_per_px = static_cast<float>(rows.line[1] / frame.unit);
  result.agreeing = static_cast<int>(within(found, rows.expected, kAgreeRows));
  if (!rows.is_field) return result;
  std::vector<double> left_over;
  for (std::size_t i = 0; i < rows.expected.size(); ++i) {
    const Correspondence& c = found.list[i];
    if (std::abs(static_cast<double>(c.rows()) - rows.expected[i]) > kAgreeRows) continue;
    left_over.push_back(std::abs(rows.expected[i] - predicted(rows.line, frame.line(c))));
  }
  if (!left_over.empty()) result.left_over_rows = static_cast<float>(quantile(left_over, 0.9));
  return result;
}

Correspondences agreeing_ones(const Correspondences& found) {
  const Rows rows = rows_of(found);
  Correspondences kept{{}, found.points, found.size};
  for (std::size_t i = 0; i < found.list.size(); ++i) {
    if (std::abs(static_cast<double>(found.list[i].rows()) - rows.expected[i]) <= kAgreeRows)
      kept.list.push_back(found.list[i]);
  }
  return kept;
}

}  // namespace cairn
