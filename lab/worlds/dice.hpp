// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <numbers>

namespace cairn::worlds {

/// Random numbers that are the same on every machine: SplitMix64 (Steele et al. 2014). What is drawn in one fork does
/// not change what another fork draws, so a family that draws one number more does not change the room around it.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}

  /// Another sequence, which depends on this one's seed and `tag` only.
  [[nodiscard]] Dice fork(std::uint64_t tag) const {
    Dice made(state_ ^ (tag + 1) * 0xD1342543DE82EF95ULL);
    made.bits();
    return made;
  }
  std::uint64_t bits() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31U);
  }
  /// 0 … < 1
  double unit() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double uniform(double least, double most) { return least + (most - least) * unit(); }
  /// Equally likely in each octave; both > 0.
  double log_uniform(double least, double most) { return least * std::pow(most / least, unit()); }
  /// 0 … n − 1, n > 0
  int below(int n) { return static_cast<int>(unit() * n); }
  /// least … most, both included
  int between(int least, int most) { return least + below(most - least + 1); }
  bool chance(double probability) { return unit() < probability; }
  double normal() {  // Box and Muller
    const double radius = std::sqrt(-2 * std::log(1 - unit()));
    return radius * std::cos(2 * std::numbers::pi * unit());
  }
  template <class List>
  const auto& pick(const List& list) {
    return *(std::begin(list) + below(static_cast<int>(std::size(list))));
  }
  template <class T>
  T pick(std::initializer_list<T> list) {
    return *(list.begin() + below(static_cast<int>(list.size())));
  }

 private:
  std::uint64_t state_;
};

}  // namespace cairn::worlds
