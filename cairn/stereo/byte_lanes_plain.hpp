// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

/// Vectors of one lane in plain C++, with the subset of Highway's operations used by semi-global matching,
/// under Highway's names and semantics; and those of byte_lanes_highway-inl.hpp.
namespace cairn::kernels::plain_bytes {

template <class T>
struct Tag {
  using Lane = T;
};
template <class T, std::size_t kMax>
using CappedTag = Tag<T>;
template <class D>
using Vec = typename D::Lane;

template <class T>
constexpr int Lanes(Tag<T>) {
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
template <class T>
T GetLane(T value) {
  return value;
}

template <class T>
T Add(T a, T b) {
  return static_cast<T>(a + b);
}
template <class T>
T Sub(T a, T b) {
  return static_cast<T>(a - b);
}
inline std::uint8_t SaturatedAdd(std::uint8_t a, std::uint8_t b) {
  return static_cast<std::uint8_t>(std::min(255, a + b));
}
template <int kBits>
std::uint8_t ShiftRight(std::uint8_t a) {
  return static_cast<std::uint8_t>(a >> kBits);
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
bool Eq(T a, T b) {
  return a == b;
}
template <class T>
T Or(T a, T b) {
  return static_cast<T>(a | b);
}
template <class T>
T And(T a, T b) {
  return static_cast<T>(a & b);
}
template <class T>
T AndNot(T not_a, T b) {
  return static_cast<T>(~not_a & b);
}
template <class T>
T IfThenZeroElse(bool mask, T no) {
  return mask ? T{0} : no;
}

// Beyond Highway.

template <class T>
T SlideUp(Tag<T>, T before, T) {
  return before;
}
template <class T>
T SlideDown(Tag<T>, T, T next) {
  return next;
}
template <class T>
T MinOfAll(Tag<T>, T v) {
  return v;
}
inline std::uint8_t CountDifferentBits(Tag<std::uint8_t>, const std::uint8_t (&a)[3],
                                       const std::uint8_t (&b)[3]) {
  int count = 0;
  for (int i = 0; i < 3; ++i) count += std::popcount(static_cast<std::uint8_t>(a[i] ^ b[i]));
  return static_cast<std::uint8_t>(count);
}
inline void StoreSum(Tag<std::uint8_t>, std::uint8_t a, std::uint8_t b, std::uint8_t c, std::int16_t* to) {
  *to = static_cast<std::int16_t>(a + b + c);
}

}  // namespace cairn::kernels::plain_bytes
