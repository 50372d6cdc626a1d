// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/grouping/colour_model.hpp>
#include <cmath>

namespace cairn {
namespace {

constexpr double kSpread = 12;       // grey levels
constexpr double kUnknown = 0.0003;  // colours that nothing has are nobody's
constexpr double kMost = 3;

constexpr int kCells = 16;                    // along a channel
constexpr double kCellSize = 256.0 / kCells;  // grey levels

struct Cell {
  Colour mean{};
  std::array<double, 2> pixels{};  // of ground, of figure
};

std::size_t cell_of(const Colour& colour) {
  std::size_t cell = 0;
  for (const double channel : colour) cell = kCells * cell + static_cast<std::size_t>(channel / kCellSize);
  return cell;
}

}  // namespace

ColourModel::ColourModel(const std::pmr::vector<Look>& looks, const std::vector<std::int32_t>& figure,
                         const std::pmr::vector<double>& counted, const Exec& exec,
                         std::pmr::memory_resource* memory)
    : run_(kernels::look_kernels(exec)) {
  std::pmr::vector<Cell> cells(std::size_t{kCells} * kCells * kCells, memory);
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (!(counted[i] > 0)) continue;
    Cell& cell = cells[cell_of(looks[i].colour)];
    const double before = cell.pixels[0] + cell.pixels[1];
    for (std::size_t c = 0; c < 3; ++c) {
      cell.mean[c] += (looks[i].colour[c] - cell.mean[c]) * counted[i] / (before + counted[i]);
    }
    const std::size_t side = figure[i] != 0 ? 1 : 0;
    cell.pixels.at(side) += counted[i];
    total_.at(side) += counted[i];
  }
  for (const Cell& cell : cells) {
    if (!(cell.pixels[0] + cell.pixels[1] > 0)) continue;
    for (std::size_t c = 0; c < 3; ++c) mean_[c].push_back(cell.mean[c]);
    for (std::size_t side = 0; side < 2; ++side) pixels_.at(side).push_back(cell.pixels.at(side));
    ++count_;
  }
  for (auto& channel : mean_) channel.resize(count_ + kernels::kCellSlack);
  for (auto& side : pixels_) side.resize(count_ + kernels::kCellSlack);
}

kernels::ColourCells ColourModel::cells() const {
  return {mean_[0].data(),   mean_[1].data(),   mean_[2].data(),
          pixels_[0].data(), pixels_[1].data(), static_cast<int>(count_)};
}

double ColourModel::logarithm(const kernels::NearPixels& near) const {
  const auto share = [](double pixels, double total) { return pixels / std::max(total, 1.0) + kUnknown; };
  return std::log(share(near.ground, total_[0]) / share(near.figure, total_[1]));
}

double ColourModel::ground_over_figure(const Colour& colour, std::vector<double>& work) const {
  work.resize(count_);
  return std::clamp(logarithm(run_.pixels_like(cells(), colour.data(), 2 * kSpread * kSpread, work.data())),
                    -kMost, kMost);
}

ColourModel::Bounds ColourModel::rough_ground_over_figure(const Colour& colour) const {
  // A quotient of two numbers is as far off as both together; the third is for all that rounds besides.
  constexpr double kOff = 3 * kernels::kRoughness;
  const double about = logarithm(run_.pixels_roughly_like(cells(), colour.data(), 2 * kSpread * kSpread));
  return {std::clamp(about - kOff, -kMost, kMost), std::clamp(about + kOff, -kMost, kMost)};
}

}  // namespace cairn
