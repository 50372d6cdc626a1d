// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/framed_image.hpp>
#include <cairn/regions/hint_kernels.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/percent.hpp>
#include <cairn/regions/surfaces_behind.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace cairn {
namespace {

using namespace kernels;

constexpr int kGrain = 4;       // rows
constexpr int kMinSide = 8;     // cells
constexpr double kPixels = 4;   // of a cell
constexpr int kLongGrain = 24;  // rows: a range of compare_with_surroundings() begins with 2 · kAround others
constexpr double kNone = -std::numeric_limits<double>::infinity();

/// The pixels of each cell along one axis: first … last − 1, those with pixel · cells / pixels = cell; with
/// fewer pixels than cells, the pixel at the cell's place.
struct Runs {
  std::vector<std::int32_t> first, last;
  int longest = 1;
  Runs(int cells, int pixels) : first(slot(cells)), last(slot(cells)) {
    for (int c = 0; c < cells; ++c) {
      const int begin = (c * pixels + cells - 1) / cells;
      const int end = ((c + 1) * pixels + cells - 1) / cells;
      const int at = c * pixels / cells;
      first[slot(c)] = begin < end ? begin : at;
      last[slot(c)] = begin < end ? end : at + 1;
      longest = std::max(longest, end - begin);
    }
  }
  [[nodiscard]] int count(int cell) const { return last[slot(cell)] - first[slot(cell)]; }
};

/// One array per sum.
template <class Sums, class Whole>
class SumArrays {
 public:
  explicit SumArrays(int size) : whole_(slot(size) * kWholeSums), real_(slot(size) * kRealSums) {
    for (std::size_t i = 0; i < kWholeSums; ++i) sums.whole[i] = whole_.data() + i * slot(size);
    for (std::size_t i = 0; i < kRealSums; ++i) sums.real[i] = real_.data() + i * slot(size);
  }
  void clear() {
    std::fill(whole_.begin(), whole_.end(), Whole{});
    std::fill(real_.begin(), real_.end(), 0.0);
  }
  Sums sums;

 private:
  std::vector<Whole> whole_;
  std::vector<double> real_;
};

/// The values of each cell that are normalised by the whole image.
struct Means {
  Image<double> brightness, disparity, ground;  // disparity: kNone without a disparity
  explicit Means(Size cells, const Pool& pool)
      : brightness(cells, pool), disparity(cells, pool), ground(cells, pool) {}
};

/// Sums over all pixels of a row of cells, as exact integers.
struct RowTotal {
  double pixels = 0, brightness = 0, squares = 0;  // whole numbers, exact
};

/// Processes the rows of cells in order.
class CellDescriber {
 public:
  CellDescriber(View<const std::uint16_t> edges, const Cues& cues, const Runs& across, const Exec& exec)
      : edges_(edges),
        cues_(cues),
        across_(across),
        run_(hint_kernels(exec)),
        cells_(static_cast<int>(across.first.size())),
        behind_(cues, edges.width(), exec),
        columns_(edges.width()),
        sums_(cells_),
        areas_(slot(cells_)),
        means_(slot(cells_)) {}

  /// Sums the rows first … last − 1 of the image.
  void sum_up(int first, int last) {
    columns_.clear();
    for (int y = first; y < last; ++y) {
      behind_.note(y);
      const HintPixels row{cues_.left.gray.row(y),
                           cues_.left.rgb.empty() ? nullptr : cues_.left.rgb.row(y),
                           edges_.row(y),
                           cues_.disparity_px.row(y),
                           cues_.textured_px.row(y),
                           behind_.ground.data(),
                           behind_.background.data()};
      run_.add_row(row, edges_.width(), columns_.sums);
    }
    run_.sum_cells(columns_.sums, across_.first.data(), across_.last.data(), across_.longest, cells_,
                   sums_.sums);
    for (int c = 0; c < cells_; ++c) areas_[slot(c)] = (last - first) * across_.count(c);
  }

  [[nodiscard]] RowTotal total() const {
    RowTotal total;
    for (int c = 0; c < cells_; ++c) {
      total.pixels += areas_[slot(c)];
      total.brightness += whole(kBrightness)[c];
      total.squares += whole(kSquares)[c];
    }
    return total;
  }

  /// Writes row y of `means`, and to `out` the channels that do not depend on the whole image.
  void describe(int y, int rows, Means& means, std::int16_t* out) {
    const double* const areas = areas_.data();
    const double* const matched = whole(kMatched);
    run_.mean(whole(kBrightness), areas, cells_, 0, means.brightness.row(y));
    run_.mean(real(kDisparity), matched, cells_, kNone, means.disparity.row(y));
    run_.mean(real(kGround), areas, cells_, 0, means.ground.row(y));
    const auto put = [&](HintChannel channel, double unit, double least, double most) {
      run_.put(means_.data(), cells_, {0, unit, least, most}, kHintChannels, out + channel);
    };
    const auto put_mean = [&](const double* sums, const double* counts, HintChannel channel, double unit,
                              double least, double most) {
      run_.mean(sums, counts, cells_, 0, means_.data());
      put(channel, unit, least, most);
    };
    put_mean(whole(kBlue), areas, kMeanBlue, 32, -4, 4);
    put_mean(whole(kRed), areas, kMeanRed, 32, -4, 4);
    put_mean(matched, areas, kShareMatched, 1, 0, 1);
    put_mean(real(kHeight), whole(kAbove), kAboveGround, 4, -1, 3);
    put_mean(whole(kEdges), areas, kMeanEdge, 8 * (double{cues_.left.noise_sigma} + 2), 0, 4);
    put_mean(whole(kTextured), areas, kShareTextured, 1, 0, 1);
    if (cues_.background.planes.empty()) {
      std::fill(means_.begin(), means_.end(), 0.0);
      put(kBeforeBackground, 1, 0, 0);
    } else {
      put_mean(real(kBefore), matched, kBeforeBackground, 4, -1, 3);
    }
    std::fill(means_.begin(), means_.end(), 2 * (static_cast<double>(y) / rows) - 1);
    put(kHeightInImage, 1, -1, 1);
    std::fill(means_.begin(), means_.end(), cues_.left.rgb.empty() ? 0.0 : 1.0);
    put(kHasColour, 1, 0, 1);
  }

 private:
  [[nodiscard]] const double* whole(WholeSum sum) const { return sums_.sums.whole[sum]; }
  [[nodiscard]] const double* real(RealSum sum) const { return sums_.sums.real[sum]; }

  View<const std::uint16_t> edges_;
  const Cues& cues_;
  const Runs& across_;
  const HintKernels& run_;
  int cells_;
  SurfacesBehind behind_;
  SumArrays<ColumnSums, std::int32_t> columns_;
  SumArrays<CellSums, double> sums_;
  std::vector<double> areas_;  // pixels per cell
  std::vector<double> means_;
};

struct Brightness {
  double mean = 0;
  double spread = 0;
};

Brightness brightness_of(const std::vector<RowTotal>& rows) {
  RowTotal all;
  for (const RowTotal& row : rows) {
    all.pixels += row.pixels;
    all.brightness += row.brightness;
    all.squares += row.squares;
  }
  const double mean = all.brightness / all.pixels;
  return {mean, std::sqrt(std::max(0.0, all.squares / all.pixels - mean * mean)) + 8};
}

/// The disparity that 2 % of the cells exceed, at least 1 px.
double nearest_px(View<const double> disparities) {
  std::vector<double> known;
  known.reserve(slot(disparities.width() * disparities.height()));
  for (int y = 0; y < disparities.height(); ++y) {
    for (int x = 0; x < disparities.width(); ++x) {
      if (disparities(x, y) != kNone) known.push_back(disparities(x, y));
    }
  }
  if (known.empty()) return 1;
  const auto at = known.begin() + static_cast<std::ptrdiff_t>(known.size() * 98 / 100);
  std::nth_element(known.begin(), at, known.end());
  return std::max(1.0, *at);
}

/// The channels of the cells of row y.
std::int16_t* cells_of(Image<std::int16_t>& input, int y) {
  return input.row(y + 1) + kHintChannels;
}

/// Writes the channels that compare a cell with those around it, in rows first … last − 1.
void compare_with_surroundings(Image<std::int16_t>& input, Size cells, int first, int last,
                               const HintKernels& run) {
  const std::size_t padded = slot(cells.width + 2 * kAround);
  std::vector<std::int32_t> memory(kChannelSums * (padded + slot(cells.width)));
  std::vector<std::int32_t> blocks(2 * slot(cells.width + kWindow));
  std::vector<double> counts(slot(cells.width));
  ChannelSums columns{};
  ChannelSums sums{};
  for (std::size_t i = 0; i < kChannelSums; ++i) {
    columns.at(i) = memory.data() + i * padded + kAround;
    sums.at(i) = memory.data() + kChannelSums * padded + i * slot(cells.width);
  }
  const auto add = [&](int y, int sign) {
    if (y >= 0 && y < cells.height) run.add_cells(cells_of(input, y), cells.width, sign, columns);
  };
  const auto cut = [](int at, int count) {  // cells of the window around `at` that are among `count`
    return std::min(at + kAround, count - 1) - std::max(at - kAround, 0) + 1;
  };
  for (int y = first - kAround; y < first + kAround; ++y) add(y, 1);
  for (int y = first; y < last; ++y) {
    add(y + kAround, 1);
    for (std::size_t i = 0; i < kChannelSums; ++i)
      run.sum_around(columns.at(i), cells.width, blocks.data(), sums.at(i));
    const int rows = cut(y, cells.height);
    for (int x = 0; x < cells.width; ++x) counts[slot(x)] = rows * cut(x, cells.width);
    run.compare(sums, counts.data(), cells.width, cells_of(input, y));
    add(y - kAround, -1);
  }
}

}  // namespace

Size hint_cells(Size image) {
  const double ratio = static_cast<double>(image.width) / image.height;
  const double width = std::sqrt(static_cast<double>(pixels_of_detail(image)) / kPixels * ratio);
  const auto rounded = [](double side) {
    constexpr double kMax = 1024;        // cells of a very long image
    constexpr double kTie = 0.5 + 1e-6;  // whatever the last bit of the square root is
    return std::max(1, static_cast<int>(std::min(side, kMax) / kMinSide + kTie)) * kMinSide;
  };
  return {rounded(width), rounded(width / ratio)};
}

Image<std::int16_t> hint_input(View<const std::uint16_t> edges, const Cues& cues, const Exec& exec) {
  const Size cells = hint_cells(cues.left.gray.size());
  const Runs across(cells.width, edges.width());
  const Runs down(cells.height, edges.height());
  Image<std::int16_t> input = framed_image(cells, kHintChannels, exec.pool);
  Means means(cells, exec.pool);
  std::vector<RowTotal> totals(slot(cells.height));
  parallel_for(exec, cells.height, kGrain, [&](int first, int last) {
    CellDescriber describing(edges, cues, across, exec);
    for (int y = first; y < last; ++y) {
      describing.sum_up(down.first[slot(y)], down.last[slot(y)]);
      totals[slot(y)] = describing.total();
      describing.describe(y, cells.height, means, cells_of(input, y));
    }
  });
  const Brightness brightness = brightness_of(totals);
  const double nearest = nearest_px(means.disparity);
  const HintKernels& run = hint_kernels(exec);
  for (int y = 0; y < cells.height; ++y) {
    const auto put = [&](const double* values, HintChannel channel, double zero, double unit, double least,
                         double most) {
      run.put(values, cells.width, {zero, unit, least, most}, kHintChannels, cells_of(input, y) + channel);
    };
    put(means.brightness.row(y), kMeanBrightness, brightness.mean, brightness.spread, -4, 4);
    put(means.disparity.row(y), kMeanDisparity, 0, nearest, 0, 2);
    put(means.ground.row(y), kGroundThere, 0, nearest, 0, 2);
  }
  parallel_for(exec, cells.height, kLongGrain,
               [&](int first, int last) { compare_with_surroundings(input, cells, first, last, run); });
  return input;
}

}  // namespace cairn
