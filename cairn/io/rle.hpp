// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::io {

/// A mask in COCO's compressed run-length form, as in pycocotools: the lengths of the runs of 0, 1, 0, … in
/// column-major order, beginning with a (possibly empty) run of zeros.
struct Rle {
  Size size;
  std::string counts;
};

/// The mask of one object; `box` contains all of its pixels (pixels outside are not read).
Rle encode_rle(View<const ObjectId> labels, ObjectId id, Rect box);
/// 1 inside, 0 outside. Throws Error if `counts` is malformed or does not fill the size exactly.
Image<std::uint8_t> decode_rle(const Rle& rle);

/// COCO's text form of run lengths. Each number (from the fourth on: its difference to the one two positions
/// before) is split into groups of five bits, the lowest first; a group and a continuation bit make one
/// character from '0' on. Bit 4 of the last group is the sign.
std::string counts_to_text(const std::vector<std::int64_t>& counts);
/// Throws Error on a character outside the alphabet, a text that ends inside a number, or a negative length.
std::vector<std::int64_t> text_to_counts(std::string_view text);

}  // namespace cairn::io
