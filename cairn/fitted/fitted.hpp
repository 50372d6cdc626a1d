// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <bit>
#include <cairn/core/error.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>

/// Fitted numbers: the files of this folder, embedded into the library. lab/fitted_files.py writes them; private to the
/// library.
namespace cairn::fitted {

/// The files. Aligned to 16 bytes.
std::span<const std::byte> hints();
std::span<const std::byte> same_thing();
std::span<const std::byte> whole_object();
std::span<const std::byte> disparity_bias();
std::span<const std::byte> right_plane();
std::span<const std::byte> shows_floor();

/// The arrays of a file, one after the other, without copying. A file begins with "cairn 1 " and four letters of its
/// kind; each array is the number of its elements (uint32), the elements, and zeros up to a multiple of 4 bytes.
/// Throws Error for a file of another kind or length.
class Reader {
 public:
  Reader(std::span<const std::byte> file, std::string_view kind) : rest_(file) {
    constexpr std::string_view kVersion = "cairn 1 ";
    const std::span<const std::byte> begin = taken(kVersion.size() + kind.size());
    if (std::memcmp(begin.data(), kVersion.data(), kVersion.size()) != 0 ||
        std::memcmp(begin.data() + kVersion.size(), kind.data(), kind.size()) != 0)
      throw Error("the fitted numbers are of another kind or version");
  }

  /// The next array. T: a number, or a struct of numbers, of at most 4 bytes each.
  template <class T>
  std::span<const T> next() {
    static_assert(std::endian::native == std::endian::little && std::is_trivially_copyable_v<T> &&
                  alignof(T) <= 4);
    std::uint32_t count = 0;
    std::memcpy(&count, taken(sizeof count).data(), sizeof count);
    const std::size_t bytes = std::size_t{count} * sizeof(T);
    const auto* first = reinterpret_cast<const T*>(taken(bytes).data());
    (void)taken((4 - bytes % 4) % 4);
    return {first, count};
  }
  [[nodiscard]] bool is_at_end() const { return rest_.empty(); }

 private:
  std::span<const std::byte> taken(std::size_t bytes) {
    if (rest_.size() < bytes) throw Error("the fitted numbers are cut off");
    const std::span<const std::byte> part = rest_.first(bytes);
    rest_ = rest_.subspan(bytes);
    return part;
  }

  std::span<const std::byte> rest_;
};

}  // namespace cairn::fitted
