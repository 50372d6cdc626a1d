// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

/// Vectors of one lane in plain C++, with the subset of Highway's operations used by the kernels, under
/// Highway's names and semantics. The kernels compiled with these are Target::scalar.
namespace cairn::kernels::plain {

template <class T>
struct Tag {
  using Lane = T;
};
template <class T, std::size_t kMax>
using CappedTag = Tag<T>;
template <class T, class Other>
using Rebind = Tag<T>;
template <class D>
using Vec = typename D::Lane;

template <class T>
constexpr int Lanes(Tag<T>) {
  return 1;
}
template <class T>
constexpr int MaxLanes(Tag<T>) {
  return 1;
}
template <class T>
T Set(Tag<T>, T value) {
  return value;
}
template <class T>
T Zero(Tag<T>) {
  return 0;
}
inline std::int16_t Add(std::int16_t a, std::int16_t b) {
  return static_cast<std::int16_t>(a + b);
}
inline std::int16_t Sub(std::int16_t a, std::int16_t b) {
  return static_cast<std::int16_t>(a - b);
}
template <class T>
T CountFrom(Tag<T>, T first) {
  return first;
}
template <class T>
T Load(Tag<T>, const T* from) {
  return *from;
}
template <class T>
T LoadU(Tag<T>, const T* from) {
  return *from;
}
template <class T>
void Store(T value, Tag<T>, T* to) {
  *to = value;
}
template <class T>
void StoreU(T value, Tag<T>, T* to) {
  *to = value;
}

inline float Add(float a, float b) {
  return a + b;
}
inline float Sub(float a, float b) {
  return a - b;
}
inline float Mul(float a, float b) {
  return a * b;
}
inline float Div(float a, float b) {
  return a / b;
}
inline float Sqrt(float a) {
  return std::sqrt(a);
}
// Overflow wraps around, as on every processor.
constexpr std::uint32_t bits(std::int32_t a) {
  return static_cast<std::uint32_t>(a);
}
inline std::int32_t Add(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(bits(a) + bits(b));
}
inline std::int32_t Sub(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(bits(a) - bits(b));
}
inline std::int32_t Mul(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(bits(a) * bits(b));
}

template <int kBits>
std::int16_t ShiftLeft(std::int16_t a) {
  return static_cast<std::int16_t>(bits(a) << kBits);
}
template <class T>
T Min(T a, T b) {
  return std::min(a, b);
}
template <class T>
T Max(T a, T b) {
  return std::max(a, b);
}
template <class T>
bool Lt(T a, T b) {
  return a < b;
}
template <class T>
bool Gt(T a, T b) {
  return a > b;
}
template <class T>
bool Eq(T a, T b) {
  return a == b;
}
template <class T>
T And(T a, T b) {
  return static_cast<T>(a & b);
}
template <class T>
T Or(T a, T b) {
  return static_cast<T>(a | b);
}
template <int kBits>
std::int32_t ShiftRight(std::int32_t a) {
  return a >> kBits;
}
template <int kBits>
std::int32_t ShiftLeft(std::int32_t a) {
  return static_cast<std::int32_t>(bits(a) << kBits);
}
template <class T>
bool RebindMask(Tag<T>, bool mask) {
  return mask;
}
template <class T>
T IfThenElse(bool mask, T yes, T no) {
  return mask ? yes : no;
}
template <class T>
T IfThenElseZero(bool mask, T yes) {
  return mask ? yes : T{0};
}
template <class T>
T IfThenZeroElse(bool mask, T no) {
  return mask ? T{0} : no;
}
inline float GetLane(float v) {
  return v;
}
inline std::int32_t BitCast(Tag<std::int32_t>, float value) {
  return std::bit_cast<std::int32_t>(value);
}
inline float BitCast(Tag<float>, std::int32_t value) {
  return std::bit_cast<float>(value);
}
inline float ConvertTo(Tag<float>, std::int32_t value) {
  return static_cast<float>(value);
}
inline std::int32_t ConvertTo(Tag<std::int32_t>, float value) {
  return static_cast<std::int32_t>(value);
}

// Beyond Highway.

constexpr std::int32_t low(std::int32_t pair) {
  return static_cast<std::int16_t>(pair & 0xFFFF);
}
constexpr std::int32_t high(std::int32_t pair) {
  return pair >> 16;
}

/// Each lane holds two 16-bit numbers: low(a)·low(b) + high(a)·high(b).
inline std::int32_t DotPairs(Tag<std::int32_t>, std::int32_t a, std::int32_t b) {
  return low(a) * low(b) + high(a) * high(b);
}
/// Each lane holds two 16-bit numbers: |low(a) − low(b)| − |high(a) − high(b)|.
template <int kShift>
std::int32_t AbsChange(Tag<std::int32_t>, std::int32_t a, std::int32_t b) {
  return std::abs(low(a) - low(b)) - std::abs(high(a) - high(b));
}
/// Each lane holds two bytes: (|low(a) − low(b)| − |high(a) − high(b)|)·2^kShift.
template <int kShift>
std::int16_t AbsChange(Tag<std::int16_t>, std::int16_t a, std::int16_t b) {
  const auto low_byte = [](std::int16_t pair) { return pair & 0xFF; };
  const auto high_byte = [](std::int16_t pair) { return pair >> 8 & 0xFF; };
  const int change = std::abs(low_byte(a) - low_byte(b)) - std::abs(high_byte(a) - high_byte(b));
  return static_cast<std::int16_t>(change * (1 << kShift));
}
template <class T>
T LeastLane(Tag<T>, T v) {
  return v;
}
/// The first lane with a value of at most `most`, counted over all vectors. One exists.
template <class T, int kCount>
int FirstUpTo(Tag<T>, const T (&v)[kCount], T most) {
  return static_cast<int>(std::find_if(v, v + kCount, [=](T lane) { return lane <= most; }) - v);
}
/// The lane-wise minimum of all vectors.
template <class T, int kCount>
T LeastOf(const T (&v)[kCount]) {
  return *std::min_element(v, v + kCount);
}
/// The lanes as rows of eight: the minimum (minus 32768), and above its 16 bits the first column with it.
template <int kCount>
std::int32_t LeastOfEights(Tag<std::int16_t>, const std::int16_t (&v)[kCount]) {
  std::uint32_t first = ~0U;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    first = std::min(first, static_cast<std::uint32_t>(v[i] + 32768) << 3 | i % 8);
  }
  return static_cast<std::int32_t>(first >> 3 | (first & 7) << 16);
}
inline std::int32_t Reverse(Tag<std::int32_t>, std::int32_t v) {
  return v;
}
/// Prefix sums of the lanes of v, plus the last lane of `before`.
inline std::int32_t RunningSum(Tag<std::int32_t>, std::int32_t before, std::int32_t v) {
  return Add(before, v);
}
inline std::int32_t ZeroSum(Tag<std::int16_t>) {
  return 0;
}
inline std::int32_t AddPairs(Tag<std::int16_t>, std::int32_t sum, std::int16_t v) {
  return sum + v;
}
template <class D>
using SumTag = Tag<std::int32_t>;
constexpr bool kManyCosts = false;
template <class D>
constexpr int kFolded = 1;
template <class D>
using Folded = D;
struct Lesser {};
struct Sum {};
/// Lane k: the reduction of v[k].
template <class Op, class T>
T FoldEach(Tag<T>, const T (&v)[1]) {
  return v[0];
}
inline float SumByHalves(Tag<float>, float value) {
  return value;
}
template <class T>
std::int32_t LoadWidened(Tag<std::int32_t>, const T* from) {
  return *from;
}
template <class T>
struct FirstAndThird {
  T first;
  T third;
};
template <class T, class Kept>
FirstAndThird<T> LoadFirstAndThird(Tag<T>, const Kept* fours) {
  return {fours[0], fours[2]};
}
template <class T>
void StoreNarrowed(Tag<std::int32_t>, std::int32_t value, T* to) {
  *to = static_cast<T>(value);
}
/// n·a − b·c, exact, then rounded once.
inline float ExactDifference(Tag<float>, std::int32_t n, std::int32_t a, std::int32_t b, std::int32_t c) {
  return static_cast<float>(std::int64_t{n} * a - std::int64_t{b} * c);
}
}  // namespace cairn::kernels::plain
