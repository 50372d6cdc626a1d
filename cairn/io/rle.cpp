// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/io/rle.hpp>
#include <cstddef>

namespace cairn::io {
namespace {

constexpr char kFirstCharacter = '0';
constexpr std::int64_t kGroupMask = 0x1f;
constexpr std::int64_t kSignBit = 0x10;
constexpr std::int64_t kMoreBit = 0x20;
constexpr int kGroupBits = 5;
constexpr std::size_t kDifferencesFrom = 3;

void append_number(std::int64_t value, std::string& text) {
  bool more = true;
  while (more) {
    std::int64_t group = value & kGroupMask;
    value >>= kGroupBits;  // arithmetic shift: a negative number ends in −1
    more = (group & kSignBit) != 0 ? value != -1 : value != 0;
    if (more) group |= kMoreBit;
    text.push_back(static_cast<char>(kFirstCharacter + group));
  }
}

std::int64_t read_number(std::string_view text, std::size_t& at) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += kGroupBits) {
    if (at == text.size()) throw Error("run-length mask: the text ends inside a number");
    const int group = text[at] - kFirstCharacter;
    if (group < 0 || group >= 64 || shift > 60) {
      throw Error("run-length mask: no number at character " + std::to_string(at));
    }
    ++at;
    value |= static_cast<std::uint64_t>(group & kGroupMask) << shift;
    if ((group & kMoreBit) != 0) continue;
    const int bits = shift + kGroupBits;
    if ((group & kSignBit) != 0 && bits < 64) value |= ~std::uint64_t{0} << bits;
    return static_cast<std::int64_t>(value);
  }
}

}  // namespace

std::string counts_to_text(const std::vector<std::int64_t>& counts) {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    append_number(i >= kDifferencesFrom ? counts[i] - counts[i - 2] : counts[i], text);
  }
  return text;
}

std::vector<std::int64_t> text_to_counts(std::string_view text) {
  constexpr std::int64_t kMax = std::int64_t{1} << 40;  // far above any image; prevents overflow of the sums
  std::vector<std::int64_t> counts;
  for (std::size_t at = 0; at < text.size();) {
    std::int64_t count = read_number(text, at);
    if (count < -kMax || count > kMax) throw Error("run-length mask: a run of impossible length");
    if (counts.size() >= kDifferencesFrom) count += counts[counts.size() - 2];
    if (count < 0 || count > kMax) throw Error("run-length mask: a run of impossible length");
    counts.push_back(count);
  }
  return counts;
}

Rle encode_rle(View<const ObjectId> labels, ObjectId id, Rect box) {
  std::vector<std::int64_t> counts;
  bool inside = false;
  std::int64_t run_start = 0;
  const auto turn_at = [&](std::int64_t pixel) {
    counts.push_back(pixel - run_start);
    run_start = pixel;
    inside = !inside;
  };
  for (int x = box.x; x < box.x + box.width; ++x) {
    const std::int64_t column = std::int64_t{x} * labels.height();
    for (int y = box.y; y < box.y + box.height; ++y) {
      if ((labels(x, y) == id) != inside) turn_at(column + y);
    }
    // Below the box there are no object pixels; a run continues only if box and image end together.
    if (inside && box.y + box.height < labels.height()) turn_at(column + box.y + box.height);
    // The same above the box in the next column.
    if (inside && box.y > 0) turn_at(column + labels.height());
  }
  const std::int64_t end = labels.size().area();
  if (inside && box.x + box.width < labels.width())
    turn_at(std::int64_t{box.x + box.width} * labels.height());
  if (end > run_start || counts.empty()) turn_at(end);
  return {labels.size(), counts_to_text(counts)};
}

Image<std::uint8_t> decode_rle(const Rle& rle) {
  const std::vector<std::int64_t> counts = text_to_counts(rle.counts);
  const std::int64_t area = rle.size.area();
  std::int64_t sum = 0;
  for (const std::int64_t count : counts) {
    sum += count;
    if (sum > area) break;
  }
  if (sum != area) {
    throw Error("run-length mask: runs cover " + std::to_string(sum) + " pixels or more, the size " +
                text(rle.size) + " has " + std::to_string(area));
  }
  Image<std::uint8_t> mask(rle.size);
  std::int64_t pixel = 0;
  std::uint8_t value = 0;
  for (const std::int64_t count : counts) {
    for (const std::int64_t end = pixel + count; pixel < end; ++pixel) {
      mask(static_cast<int>(pixel / rle.size.height), static_cast<int>(pixel % rle.size.height)) = value;
    }
    value ^= 1;
  }
  return mask;
}

}  // namespace cairn::io
