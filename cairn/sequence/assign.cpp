// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/assign.hpp>

#include <dlib/matrix.h>
#include <dlib/optimization/max_cost_assignment.h>

#include <algorithm>
#include <cairn/core/disjoint_sets.hpp>
#include <limits>

namespace cairn {
namespace {

/// A square table: rows and columns that may be matched, plus a column for each row and a row for each column
/// that leave it unmatched.
class Square {
 public:
  Square(const CostTable& table, const std::vector<int>& rows, const std::vector<int>& columns)
      : rows_(rows.size()), side_(rows.size() + columns.size()), costs_(side_ * side_, 0) {
    // Above the cost of any assignment without a forbidden pair.
    constexpr std::int64_t kNever = std::int64_t{1} << 48U;
    const std::int64_t half = table.alone / 2;
    for (std::size_t i = 0; i < side_; ++i) {
      for (std::size_t j = 0; j < side_; ++j) {
        std::int64_t& cost = costs_[i * side_ + j];
        if (i < rows_ && j < columns.size()) {
          const std::int64_t given =
              table.costs[static_cast<std::size_t>(rows[i]) * static_cast<std::size_t>(table.columns) +
                          static_cast<std::size_t>(columns[j])];
          cost = given == CostTable::kForbidden ? kNever : given;
        } else if (i < rows_) {
          cost = j - columns.size() == i ? half : kNever;
        } else if (j < columns.size()) {
          cost = i - rows_ == j ? half : kNever;
        }
      }
    }
  }

  [[nodiscard]] std::size_t side() const { return side_; }

  /// The column of each row in the optimal assignment that is first in lexicographic order.
  [[nodiscard]] std::vector<std::size_t> best() const {
    std::vector<std::size_t> column_of = any_best();
    std::vector<std::size_t> row_of(side_);
    for (std::size_t i = 0; i < side_; ++i) row_of[column_of[i]] = i;
    const std::vector<bool> is_tight = tight(column_of);
    std::vector<bool> is_settled(side_, false);  // columns
    for (std::size_t i = 0; i < rows_; ++i) {
      for (std::size_t j = 0; j < column_of[i]; ++j) {
        if (!is_tight[i * side_ + j] || is_settled[j]) continue;
        // Row i takes column j if the row that has it finds another one, and so on, ending at the column of
        // row i.
        std::vector<bool> is_tried = is_settled;
        is_tried[j] = true;
        const std::size_t left = column_of[i];
        if (!reroute(row_of[j], left, is_tight, is_tried, column_of, row_of)) continue;
        column_of[i] = j;
        row_of[j] = i;
        break;
      }
      is_settled[column_of[i]] = true;
    }
    return column_of;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> any_best() const {
    const auto side = static_cast<long>(side_);
    dlib::matrix<std::int64_t> gain(side, side);
    for (long i = 0; i < side; ++i) {
      for (long j = 0; j < side; ++j)
        gain(i, j) = -costs_[static_cast<std::size_t>(i) * side_ + static_cast<std::size_t>(j)];
    }
    const std::vector<long> found = dlib::max_cost_assignment(gain);
    return {found.begin(), found.end()};
  }

  /// The pairs that occur in optimal assignments: those with zero slack under the dual potentials of one.
  [[nodiscard]] std::vector<bool> tight(const std::vector<std::size_t>& column_of) const {
    std::vector<std::int64_t> of_column(side_, 0);
    std::vector<std::int64_t> of_row(side_, 0);
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < side_; ++i) {
        of_row[i] = costs_[i * side_ + column_of[i]] - of_column[column_of[i]];
        for (std::size_t j = 0; j < side_; ++j) {
          const std::int64_t bound = costs_[i * side_ + j] - of_row[i];
          if (bound >= of_column[j]) continue;
          of_column[j] = bound;
          changed = true;
        }
      }
    }
    std::vector<bool> is_tight(side_ * side_);
    for (std::size_t i = 0; i < side_; ++i) {
      for (std::size_t j = 0; j < side_; ++j)
        is_tight[i * side_ + j] = costs_[i * side_ + j] == of_row[i] + of_column[j];
    }
    return is_tight;
  }

  bool reroute(std::size_t row, std::size_t wanted, const std::vector<bool>& is_tight,
               std::vector<bool>& is_tried, std::vector<std::size_t>& column_of,
               std::vector<std::size_t>& row_of) const {
    for (std::size_t j = 0; j < side_; ++j) {
      if (is_tried[j] || !is_tight[row * side_ + j]) continue;
      is_tried[j] = true;
      if (j != wanted && !reroute(row_of[j], wanted, is_tight, is_tried, column_of, row_of)) continue;
      column_of[row] = j;
      row_of[j] = row;
      return true;
    }
    return false;
  }

  std::size_t rows_;
  std::size_t side_;
  std::vector<std::int64_t> costs_;
};

}  // namespace

std::vector<int> assign(const CostTable& table) {
  std::vector<int> column_of(static_cast<std::size_t>(table.rows), -1);
  // Connected components are assigned separately, as the time is cubic in the size.
  DisjointSets sets(static_cast<std::size_t>(table.rows) + static_cast<std::size_t>(table.columns));
  const auto cost = [&](int i, int j) {
    return table.costs[static_cast<std::size_t>(i) * static_cast<std::size_t>(table.columns) +
                       static_cast<std::size_t>(j)];
  };
  for (int i = 0; i < table.rows; ++i) {
    for (int j = 0; j < table.columns; ++j) {
      if (cost(i, j) != CostTable::kForbidden) sets.unite(i, table.rows + j);
    }
  }
  for (int first = 0; first < table.rows; ++first) {
    if (!sets.is_root(first)) continue;
    std::vector<int> rows;
    std::vector<int> columns;
    for (int i = first; i < table.rows; ++i) {
      if (sets.root(i) == first) rows.push_back(i);
    }
    for (int j = 0; j < table.columns; ++j) {
      if (sets.root(table.rows + j) == first) columns.push_back(j);
    }
    if (columns.empty()) continue;
    const std::vector<std::size_t> found = Square(table, rows, columns).best();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (found[i] < columns.size()) column_of[static_cast<std::size_t>(rows[i])] = columns[found[i]];
    }
  }
  return column_of;
}

}  // namespace cairn
