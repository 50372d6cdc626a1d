// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/objects/ranks.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

constexpr std::size_t kMaxBuckets = 1024;
constexpr std::size_t kInBucket = 4;  // values on average, at least: few buckets are faster to search
constexpr std::size_t kFew = 256;     // up to this many values, nth_element is faster than counting

std::ptrdiff_t offset(std::size_t i) {
  return static_cast<std::ptrdiff_t>(i);
}

std::pair<float, float> by_parting(std::span<float> values, std::size_t low, std::size_t high) {
  std::nth_element(values.begin(), values.begin() + offset(low), values.end());
  const float lower = values[low];
  // Values after it keep their ranks.
  std::nth_element(values.begin() + offset(low), values.begin() + offset(high), values.end());
  return {lower, values[high]};
}

/// Values counted in buckets, so that a rank is searched for in one bucket only.
class BucketCounts {
 public:
  BucketCounts(std::span<const float> values, const kernels::Buckets& buckets,
               const kernels::LabelKernels& run)
      : values_(values), buckets_(buckets), run_(run) {
    for (auto& counts : counts_) std::fill_n(counts.begin(), buckets.last + 1, 0U);
    std::array<std::int32_t, 256> numbers;
    for (std::size_t i = 0; i < values.size(); i += numbers.size()) {
      const std::size_t count = std::min(numbers.size(), values.size() - i);
      run.number_buckets(values.data() + i, count, buckets, numbers.data());
      // Two counters in turn: similar neighbours would wait for each other's increment.
      for (std::size_t k = 0; k < count; ++k) ++counts_[k % 2][slot(numbers[k])];
    }
  }

  float value_at(std::size_t rank) {
    std::size_t b = 0;
    if (2 * rank < values_.size()) {
      for (; rank >= count(b); ++b) rank -= count(b);
    } else {  // from the top
      b = slot(buckets_.last);
      std::size_t above = values_.size() - 1 - rank;
      for (; above >= count(b); --b) above -= count(b);
      rank = count(b) - 1 - above;
    }
    if (b != gathered_) gather(b);
    const auto at = members_.begin() + offset(rank);
    std::nth_element(members_.begin(), at, members_.end());
    return *at;
  }

 private:
  [[nodiscard]] std::size_t count(std::size_t b) const { return counts_[0][b] + counts_[1][b]; }
  void gather(std::size_t b) {
    gathered_ = b;
    members_.resize(count(b) + kernels::kListSlack);
    members_.resize(run_.keep_bucket(values_.data(), values_.size(), buckets_, static_cast<std::int32_t>(b),
                                     members_.data()));
  }

  std::span<const float> values_;
  kernels::Buckets buckets_;
  const kernels::LabelKernels& run_;
  std::array<std::array<std::uint32_t, kMaxBuckets>, 2> counts_;  // up to buckets_.last
  std::size_t gathered_ = kMaxBuckets;
  std::vector<float> members_;
};

}  // namespace

std::pair<float, float> values_at_ranks(std::span<float> values, std::size_t low, std::size_t high,
                                        const Exec& exec) {
  if (values.size() <= kFew) return by_parting(values, low, high);
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  const auto [least, most] = run.find_range(values.data(), values.size());
  const std::size_t count = std::min(values.size() / kInBucket, kMaxBuckets);
  const float scale = static_cast<float>(count) / (most - least);
  if (!std::isfinite(scale) || !(scale > 0)) return by_parting(values, low, high);
  BucketCounts counted(values, {least, scale, static_cast<std::int32_t>(count) - 1}, run);
  const float lower = counted.value_at(low);
  return {lower, counted.value_at(high)};
}

}  // namespace cairn
