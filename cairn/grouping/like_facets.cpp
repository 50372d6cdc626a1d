// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/grouping/like_facets.hpp>
#include <numeric>

namespace cairn {
namespace {

constexpr double kAcross = 0.15;  // deviation, of the width
constexpr double kDown = 0.03;    // of the width: floor and wall change fast along a column

/// The squares of the pixels in deviations, for so many as are within kFarthest.
std::vector<double> squares(double deviation) {
  std::vector<double> result;
  const auto square = [&](std::size_t pixels) {
    const double in_deviations = static_cast<double>(pixels) / deviation;
    return in_deviations * in_deviations;
  };
  while (square(result.size()) <= Likeness::kFarthest) result.push_back(square(result.size()));
  return result;
}

}  // namespace

Likeness::Likeness(int width)
    : squares_across_(squares(kAcross * width)), squares_down_(squares(kDown * width)) {}

double Likeness::logarithm(const Look& here, const Look& there) const {
  const Size between = gap_between(here.box, there.box);
  if (between.height > most_down() || between.width > most_across()) return 1;
  const double dc = difference(here.colour, there.colour) / (kSpread * kSpread);
  if (dc > kFarthest) return 1;
  return -(dc + squares_across_[slot(between.width)] + squares_down_[slot(between.height)]) / 2;
}

LikeFacets::LikeFacets(const std::pmr::vector<Look>& looks, const std::pmr::vector<double>& pixels,
                       const Likeness& likeness, const Exec& exec, std::pmr::memory_resource* memory)
    : run_(kernels::look_kernels(exec)),
      looks_(looks),
      likeness_(likeness),
      tall_(memory),
      entries_(memory),
      sides_{std::pmr::vector<std::int32_t>(memory), std::pmr::vector<std::int32_t>(memory),
             std::pmr::vector<std::int32_t>(memory), std::pmr::vector<std::int32_t>(memory)},
      channels_{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory),
                std::pmr::vector<float>(memory)} {
  int top = 0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (!(pixels[i] > 0)) continue;
    const Rect& box = looks[i].box;
    if (box.height > likeness.most_down()) tall_.push_back({static_cast<std::int32_t>(i), pixels[i]});
    in_order_ = in_order_ && box.y >= top;
    top = box.y;
  }
  sort_by_grey(pixels);
}

int LikeFacets::bin_of(double grey) {
  return std::clamp(static_cast<int>(grey) / kBinWidth, 0, kBins - 1);
}

/// Only facets of like grey can be of like colour: those of a bin stand together, in their order.
void LikeFacets::sort_by_grey(const std::pmr::vector<double>& pixels) {
  std::vector<std::uint8_t> bins(looks_.size());
  for (std::size_t i = 0; i < looks_.size(); ++i) {
    if (!(pixels[i] > 0)) continue;
    bins[i] = static_cast<std::uint8_t>(bin_of(grey_of(looks_[i])));
    ++bin_end_[bins[i] + 1U];
  }
  std::partial_sum(bin_end_.begin(), bin_end_.end(), bin_end_.begin());
  entries_.resize(slot(bin_end_.back()));
  for (auto& side : sides_) side.resize(entries_.size() + kernels::kLookSlack);
  for (auto& channel : channels_) channel.resize(entries_.size() + kernels::kLookSlack);
  std::array<std::int32_t, kBins + 1> next = bin_end_;
  for (std::size_t i = 0; i < looks_.size(); ++i) {
    if (!(pixels[i] > 0)) continue;
    const std::size_t at = slot(next[bins[i]]++);
    const Rect& box = looks_[i].box;
    entries_[at] = {static_cast<std::int32_t>(i), pixels[i]};
    sides_[0][at] = box.x;
    sides_[1][at] = box.x + box.width;
    sides_[2][at] = box.y;
    sides_[3][at] = box.y + box.height;
    for (std::size_t c = 0; c < 3; ++c) channels_[c][at] = static_cast<float>(looks_[i].colour[c]);
  }
}

LikeFacets::Range LikeFacets::bin(int number) const {
  return {bin_end_[slot(number)], bin_end_[slot(number + 1)]};
}

/// The first of the facets of a bin that does not begin above the row.
std::int32_t LikeFacets::first_from(int row, Range among) const {
  const auto top = sides_[2].begin();
  return static_cast<std::int32_t>(std::lower_bound(top + among.first, top + among.last, row) - top);
}

kernels::LookArrays LikeFacets::arrays() const {
  return {sides_[0].data(),    sides_[1].data(),    sides_[2].data(),   sides_[3].data(),
          channels_[0].data(), channels_[1].data(), channels_[2].data()};
}

/// Where those that a facet may resemble are sure to be.
kernels::LookWindow LikeFacets::window_about(const Look& look) const {
  constexpr auto kMostSquares =
      static_cast<float>(1.001 * 3 * Likeness::kSpread * Likeness::kSpread * Likeness::kFarthest);
  const auto channel = [&](std::size_t c) { return static_cast<float>(look.colour[c]); };
  const Rect& box = look.box;
  return {box.x - likeness_.most_across(),
          box.x + box.width + likeness_.most_across(),
          box.y - likeness_.most_down(),
          box.y + box.height + likeness_.most_down(),
          channel(0),
          channel(1),
          channel(2),
          kMostSquares};
}

void LikeFacets::take(std::size_t i, const Entry& entry, Work& work) const {
  const double logarithm = likeness_.logarithm(looks_[i], look_of(entry));
  if (logarithm > 0 || slot(entry.facet) == i) return;
  work.pixels.push_back(entry.pixels);
  work.likeness.push_back(logarithm);
}

double LikeFacets::add_up(double sum, Work& work) const {
  run_.exponentials(work.likeness.data(), static_cast<int>(work.likeness.size()));
  for (std::size_t k = 0; k < work.likeness.size(); ++k) sum += work.likeness[k] * work.pixels[k];
  work.pixels.clear();
  work.likeness.clear();
  return sum;
}

double LikeFacets::add_found(std::size_t i, Range among, double sum, Work& work) const {
  const int found =
      run_.within(arrays(), window_about(looks_[i]), among.first, among.last, work.found.data());
  for (int k = 0; k < found; ++k) take(i, entries_[slot(work.found[slot(k)])], work);
  return add_up(sum, work);
}

/// Those that begin far above and reach down.
double LikeFacets::add_tall(std::size_t i, double sum, Work& work) const {
  if (!in_order_) return sum;  // then they are found like all others
  const int above = looks_[i].box.y - 2 * likeness_.most_down();
  for (const Entry& entry : tall_) {
    if (look_of(entry).box.y < above) take(i, entry, work);
  }
  return add_up(sum, work);
}

/// Whether the facets of the same grey that begin at about the same height are enough alone. They are summed
/// in another order than all are, so more than enough is asked for than rounding could ever make.
bool LikeFacets::are_surely(double enough, std::size_t i, Work& work) const {
  constexpr std::int32_t kFew = 64;
  constexpr int kAtOnce = 8;
  constexpr double kMoreThanRounding = 1 + 1e-9;
  if (!in_order_) return false;
  const Range of_grey = bin(bin_of(grey_of(looks_[i])));
  const std::int32_t middle = first_from(looks_[i].box.y, of_grey);
  const Range few{std::max(middle - kFew / 2, of_grey.first), std::min(middle + kFew / 2, of_grey.last)};
  const int found = run_.within(arrays(), window_about(looks_[i]), few.first, few.last, work.found.data());
  double sum = 0;
  for (int k = 0; k < found && sum < kMoreThanRounding * enough; k += kAtOnce) {
    for (int next = k; next < std::min(k + kAtOnce, found); ++next) {
      take(i, entries_[slot(work.found[slot(next)])], work);
    }
    sum = add_up(sum, work);
  }
  return sum >= kMoreThanRounding * enough;
}

double LikeFacets::pixels_like(std::size_t i, double enough, Work& work) const {
  if (are_surely(enough, i, work)) return enough;
  // Facets come in the order of their first row. Those that end far above are passed over, and among those
  // that begin far above only tall ones reach down.
  const Look& look = looks_[i];
  const int above = look.box.y - 2 * likeness_.most_down();
  const int below = look.box.y + look.box.height + likeness_.most_down() + 1;
  constexpr double kMostGrey = 1.001 * Likeness::kSpread * 3;  // √kFarthest deviations
  const double grey = grey_of(look);
  double sum = add_tall(i, 0, work);
  for (int b = bin_of(grey - kMostGrey); b <= bin_of(grey + kMostGrey) && sum < enough; ++b) {
    const Range all = bin(b);
    sum = add_found(i, in_order_ ? Range{first_from(above, all), first_from(below, all)} : all, sum, work);
  }
  return sum;
}

}  // namespace cairn
