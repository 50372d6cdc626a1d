// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/objects/ranks.hpp>
#include <cmath>
#include <cstdint>

namespace cairn {
namespace {

constexpr std::size_t kBuckets = 1024;
constexpr std::size_t kFew = 256;  // values that are parted faster than counted

std::ptrdiff_t offset(std::size_t i) {
  return static_cast<std::ptrdiff_t>(i);
}

std::pair<float, float> by_parting(std::vector<float>& values, std::size_t low, std::size_t high) {
  std::nth_element(values.begin(), values.begin() + offset(low), values.end());
  const float lower = values[low];
  // What is not below it keeps its ranks.
  std::nth_element(values.begin() + offset(low), values.begin() + offset(high), values.end());
  return {lower, values[high]};
}

std::pair<float, float> bounds(const std::vector<float>& values) {
  // Four chains: one would wait for its own comparison.
  std::array<float, 4> least{};
  std::array<float, 4> most{};
  least.fill(values.front());
  most.fill(values.front());
  std::size_t i = 0;
  for (; i + 4 <= values.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) {
      least[k] = values[i + k] < least[k] ? values[i + k] : least[k];
      most[k] = values[i + k] > most[k] ? values[i + k] : most[k];
    }
  }
  for (; i < values.size(); ++i) {
    least[0] = std::min(least[0], values[i]);
    most[0] = std::max(most[0], values[i]);
  }
  return {*std::min_element(least.begin(), least.end()), *std::max_element(most.begin(), most.end())};
}

/// Values counted in buckets of equal width. A larger value is never in a lower bucket, however it rounds, so
/// a rank is looked for in one bucket only.
class Buckets {
 public:
  Buckets(const std::vector<float>& values, float least, float scale)
      : values_(values), least_(least), scale_(scale) {
    // Two counters for each bucket: neighbours are often alike, and one would wait for the other.
    std::size_t i = 0;
    for (; i + 2 <= values.size(); i += 2) {
      ++counts_[0][bucket(values[i])];
      ++counts_[1][bucket(values[i + 1])];
    }
    if (i < values.size()) ++counts_[0][bucket(values[i])];
  }

  float value_at(std::size_t rank) {
    std::size_t b = 0;
    for (; rank >= count(b); ++b) rank -= count(b);
    if (b != gathered_) gather(b);
    const auto at = members_.begin() + offset(rank);
    std::nth_element(members_.begin(), at, members_.end());
    return *at;
  }

 private:
  [[nodiscard]] std::size_t bucket(float value) const {
    return std::min(static_cast<std::size_t>(static_cast<std::int32_t>((value - least_) * scale_)),
                    kBuckets - 1);
  }
  [[nodiscard]] std::size_t count(std::size_t b) const { return counts_[0][b] + counts_[1][b]; }
  void gather(std::size_t b) {
    gathered_ = b;
    members_.resize(count(b) + 1);  // every value is written, and most are overwritten
    std::size_t found = 0;
    for (const float value : values_) {
      members_[found] = value;
      found += bucket(value) == b ? 1 : 0;
    }
    members_.pop_back();
  }

  const std::vector<float>& values_;
  float least_;
  float scale_;
  std::array<std::array<std::uint32_t, kBuckets>, 2> counts_{};
  std::size_t gathered_ = kBuckets;
  std::vector<float> members_;
};

}  // namespace

std::pair<float, float> values_at_ranks(std::vector<float>& values, std::size_t low, std::size_t high) {
  if (values.size() <= kFew) return by_parting(values, low, high);
  const auto [least, most] = bounds(values);
  const float scale = static_cast<float>(kBuckets) / (most - least);
  if (!std::isfinite(scale) || !(scale > 0)) return by_parting(values, low, high);
  Buckets buckets(values, least, scale);
  const float lower = buckets.value_at(low);
  return {lower, buckets.value_at(high)};
}

}  // namespace cairn
