// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/stereo/confidence.hpp>
#include <cairn/stereo/confidence_kernels.hpp>
#include <cassert>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 48;  // rows; each range first sums a whole window's height
constexpr int kRadius = kConfidenceWindow / 2;
constexpr float kJump = 1.0F;  // px

/// Both counts fit one number, for a whole window.
using Counts = kernels::HolesAndJumps;
static_assert(kConfidenceWindow * kConfidenceWindow < 256);

/// The last row is its own neighbour below: no jump.
Image<Counts> mark(View<const float> disparity_px, const Exec& exec) {
  const kernels::ConfidenceKernels& run = kernels::confidence_kernels(exec);
  const int height = disparity_px.height();
  Image<Counts> marks(disparity_px.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      run.mark_jumps(disparity_px.row(y), disparity_px.row(std::min(y + 1, height - 1)), disparity_px.width(),
                     kJump, marks.row(y));
    }
  });
  return marks;
}

/// How many of p − kRadius … p + kRadius lie inside 0 … length − 1.
int inside(int p, int length) {
  return std::min(p + kRadius, length - 1) - std::max(p - kRadius, 0) + 1;
}

/// Window counts around each pixel, for rows from top to bottom.
class WindowCounts {
 public:
  WindowCounts(View<const Counts> marks, int first_row, const kernels::ConfidenceKernels& run)
      : marks_(marks),
        row_(first_row),
        run_(run),
        columns_(static_cast<std::size_t>(marks.width() + kConfidenceWindow)),
        blocks_(2 * columns_.size()),
        around_(columns_.size()),
        inverse_area_(static_cast<std::size_t>(marks.width())) {
    for (int y = first_row - kRadius; y < first_row + kRadius; ++y) update(y, run_.add_counts);
  }

  void next_row() {
    update(row_ + kRadius, run_.add_counts);
    run_.sum_counts(columns_.data(), marks_.width(), kConfidenceWindow, blocks_.data(), around_.data());
    if (const int rows = inside(row_, marks_.height()); rows != rows_) measure_areas(rows);
    update(row_ - kRadius, run_.remove_counts);
    ++row_;
  }

  [[nodiscard]] const Counts* around() const { return around_.data(); }
  [[nodiscard]] const float* inverse_area() const { return inverse_area_.data(); }

 private:
  void update(int y, decltype(kernels::ConfidenceKernels::add_counts) with) {
    if (y >= 0 && y < marks_.height()) with(marks_.row(y), marks_.width(), columns_.data() + kRadius);
  }

  void measure_areas(int rows) {
    rows_ = rows;
    for (int x = 0; x < marks_.width(); ++x) {
      inverse_area_[static_cast<std::size_t>(x)] =
          1.0F / static_cast<float>(rows * inside(x, marks_.width()));
    }
  }

  View<const Counts> marks_;
  int row_;
  int rows_ = 0;  // of the window, inside the image
  const kernels::ConfidenceKernels& run_;
  std::vector<Counts> columns_;  // sums of the window's rows; kRadius zeros on either side
  std::vector<Counts> blocks_;   // working memory
  std::vector<Counts> around_;
  std::vector<float> inverse_area_;
};

}  // namespace

Image<float> estimate_confidence(const Matches& matches, const DisparityMap& disparity,
                                 const ConfidenceModel& model, const Exec& exec) {
  if (matches.runner_up.empty() || matches.mean_cost.empty()) return {};
  const View<const float> disparity_px = disparity.disparity_px;
  const Size size = disparity_px.size();
  assert(matches.runner_up.size() == size && matches.mean_cost.size() == size);
  const kernels::ConfidenceKernels& run = kernels::confidence_kernels(exec);
  const Image<Counts> marks = mark(disparity_px, exec);
  Image<float> confidence(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    WindowCounts counts(marks, first, run);
    for (int y = first; y < last; ++y) {
      counts.next_row();
      run.judge_confidence({matches.cost.row(y), matches.runner_up.row(y), matches.mean_cost.row(y),
                            disparity_px.row(y), counts.around(), counts.inverse_area()},
                           size.width, model, confidence.row(y));
    }
  });
  return confidence;
}

Image<float> without_holes(Image<float> confidence, View<const Reject> reject) {
  for (int y = 0; y < confidence.height(); ++y) {
    std::transform(reject.row(y), reject.row(y) + reject.width(), confidence.row(y), confidence.row(y),
                   [](Reject r, float c) { return r == Reject::none ? c : 0.0F; });
  }
  return confidence;
}

}  // namespace cairn
