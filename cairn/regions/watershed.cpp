// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/parallel.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <numeric>
#include <utility>

namespace cairn {
namespace {

using kernels::kWordBits;
using kernels::Word;

constexpr int kGrain = 16;  // rows
constexpr int kBlock = 64;  // rows per block of path following
constexpr Word kLastBit = Word{1} << (kWordBits - 1);

/// The bits of each pixel. The first four are the direction of flow, at most one set, in the order that
/// decides ties.
enum Plane : std::uint8_t {
  kUp,
  kLeft,
  kRight,
  kDown,
  kStill,       // does not flow (yet)
  kReached,     // flows across its plateau to a pixel that flows downhill
  kEqualRight,  // as high as the right neighbour
  kEqualBelow,
  kPlanes
};

/// Bit planes of an image: one step processes 64 pixels, and all planes fit the second-level cache. A row
/// holds the words of all planes, one plane after the other. Each plane is padded by a word of zeros at the
/// end of each row and by rows of zeros above and below, so neighbours need no bounds check.
class Bits {
 public:
  Bits(Size size, const Exec& exec)
      : size_(size),
        words_((size.width + kWordBits - 1) / kWordBits),
        planes_(static_cast<std::size_t>(row_stride() * (size.height + 2)), exec.pool) {
    std::fill_n(at(kUp, -1), row_stride(), Word{0});
    std::fill_n(at(kUp, size.height), row_stride(), Word{0});
  }

  [[nodiscard]] Size size() const { return size_; }
  [[nodiscard]] int words() const { return words_; }
  /// Distance from a word to the same word of the row below.
  [[nodiscard]] std::ptrdiff_t row_stride() const { return std::ptrdiff_t{kPlanes} * (words_ + 1); }
  /// Distance from a word to the same word of another plane.
  [[nodiscard]] std::ptrdiff_t step(Plane from, Plane to) const {
    return (std::ptrdiff_t{to} - from) * (words_ + 1);
  }
  [[nodiscard]] Word* at(Plane plane, int y) { return planes_.data() + offset(plane, y); }
  [[nodiscard]] const Word* at(Plane plane, int y) const { return planes_.begin() + offset(plane, y); }
  /// The bits of word `w` that are inside the image.
  [[nodiscard]] Word inside(int w) const {
    const int rest = size_.width - w * kWordBits;
    return rest >= kWordBits ? ~Word{0} : (Word{1} << rest) - 1;
  }

 private:
  [[nodiscard]] std::ptrdiff_t offset(Plane plane, int y) const {
    return (y + 1) * row_stride() + std::ptrdiff_t{plane} * (words_ + 1);
  }

  Size size_;
  int words_;
  Scratch<Word> planes_;
};

/// The bits of the left neighbours.
Word of_left(const Word* word) {
  return (*word << 1U) | (word[-1] >> (kWordBits - 1));
}
Word of_right(const Word* word) {
  return (*word >> 1U) | (word[1] << (kWordBits - 1));
}

/// Rows of heights with a border higher than any height, so nothing flows out. Keeps three rows.
class FramedRows {
 public:
  FramedRows(View<const std::uint16_t> heights, int words)
      : heights_(heights), length_(slot(words * kWordBits + 2)) {
    for (auto& row : rows_) row.resize(length_, UINT16_MAX);
  }
  /// Row y may be just outside the image. The last three rows remain valid.
  const std::uint16_t* fetch(int y) {
    std::vector<std::uint16_t>& row = rows_.at(slot((y + 3) % 3));
    if (y < 0 || y >= heights_.height()) {
      std::fill(row.begin(), row.end(), UINT16_MAX);
    } else {
      std::copy_n(heights_.row(y), heights_.width(), row.data() + 1);
    }
    return row.data() + 1;
  }

 private:
  View<const std::uint16_t> heights_;
  std::size_t length_;
  std::array<std::vector<std::uint16_t>, 3> rows_;
};

/// Clears the bits outside the image and marks the pixels that do not flow.
void finish_row(Bits& bits, int y) {
  const int last = bits.words() - 1;
  for (const Plane plane : {kUp, kLeft, kRight, kDown, kEqualRight, kEqualBelow}) {
    Word* const row = bits.at(plane, y);
    row[last] &= bits.inside(last);
    row[last + 1] = 0;
  }
  bits.at(kEqualRight, y)[last] &= bits.inside(last) >> 1U;
  if (y + 1 == bits.size().height) std::fill_n(bits.at(kEqualBelow, y), bits.words(), Word{0});
  for (int w = 0; w <= last; ++w) {
    const Word flows =
        bits.at(kUp, y)[w] | bits.at(kLeft, y)[w] | bits.at(kRight, y)[w] | bits.at(kDown, y)[w];
    bits.at(kStill, y)[w] = ~flows & bits.inside(w);
  }
  bits.at(kStill, y)[last + 1] = 0;
  bits.at(kReached, y)[last + 1] = 0;
}

/// Every pixel flows to its lowest neighbour if that is lower.
Bits flow_downhill(View<const std::uint16_t> heights, const Exec& exec) {
  const kernels::LabelKernels& run = kernels::label_kernels(exec);
  Bits bits(heights.size(), exec);
  parallel_for(exec, heights.height(), kGrain, [&](int first, int last) {
    FramedRows rows(heights, bits.words());
    const std::uint16_t* above = rows.fetch(first - 1);
    const std::uint16_t* here = rows.fetch(first);
    for (int y = first; y < last; ++y) {
      const std::uint16_t* const below = rows.fetch(y + 1);
      run.compare(above, here, below, bits.words(),
                  {bits.at(kUp, y), bits.at(kLeft, y), bits.at(kRight, y), bits.at(kDown, y),
                   bits.at(kEqualRight, y), bits.at(kEqualBelow, y)});
      finish_row(bits, y);
      above = here;
      here = below;
    }
  });
  return bits;
}

/// Finds the plateau pixels at distance 1: next to a pixel of the same height that flows downhill.
void flow_next_to_slopes(Bits& bits, const Exec& exec) {
  const std::ptrdiff_t stride = bits.row_stride();
  parallel_for(exec, bits.size().height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (int w = 0; w < bits.words(); ++w) {
        const Word* const still = bits.at(kStill, y) + w;
        const Word* const equal_right = bits.at(kEqualRight, y) + w;
        const Word* const equal_below = bits.at(kEqualBelow, y) + w;
        // Outside the image nothing is still, but nothing is equal either.
        const Word up = *still & equal_below[-stride] & ~still[-stride];
        const Word left = *still & ~up & of_left(equal_right) & ~of_left(still);
        const Word right = *still & ~(up | left) & *equal_right & ~of_right(still);
        const Word down = *still & ~(up | left | right) & *equal_below & ~still[stride];
        bits.at(kUp, y)[w] |= up;
        bits.at(kLeft, y)[w] |= left;
        bits.at(kRight, y)[w] |= right;
        bits.at(kDown, y)[w] |= down;
        bits.at(kReached, y)[w] = up | left | right | down;
      }
    }
  });
}

/// Lets the plateau pixels at distance 2 and more flow, in breadth-first order. Plateaus without a lower
/// border stay still. Heights need not be compared again: adjacent pixels that do not flow have the same
/// height, as the higher one would flow, and the same holds for a still pixel next to one at distance 1.
class Flood {
 public:
  Flood(Bits& bits, const Exec& exec)
      : bits_(bits),
        still_(bits.at(kStill, 0)),
        now_(slot(bits.words() * bits.size().height) + 1, exec.pool),
        next_(now_.size(), exec.pool) {
    Word* const reached = bits.at(kReached, 0);
    for (int y = 0; y < bits.size().height; ++y) {
      std::fill_n(bits.at(kEqualRight, y), bits.words(), Word{0});  // reused for the next level
      for (std::ptrdiff_t i = y * bits.row_stride(); i < y * bits.row_stride() + bits.words(); ++i) {
        still_[i] &= ~reached[i];
        now_[now_count_] = i;
        now_count_ += reached[i] != 0 ? 1 : 0;
      }
    }
  }

  void run() {
    const std::ptrdiff_t stride = bits_.row_stride();
    for (; now_count_ > 0; advance()) {
      const Word* const pixels = bits_.at(level_, 0);
      const auto for_each_word = [&](auto found) {
        for (const std::ptrdiff_t* word = now_.begin(); word != now_.begin() + now_count_; ++word)
          found(*word);
      };
      // Ties: a pixel may be reached from several sides, and "up" must win. So the whole level first claims
      // the pixels below (for them it is "up"), then those to the right, to the left, and above. Within a
      // word, right and left can alternate once the claims from the word to the left are known.
      for_each_word([&](std::ptrdiff_t w) { claim(w + stride, pixels[w], kUp); });
      for_each_word([&](std::ptrdiff_t w) {
        if ((pixels[w] & kLastBit) != 0) claim(w + 1, 1, kLeft);
      });
      for_each_word([&](std::ptrdiff_t w) {
        claim(w, pixels[w] << 1U, kLeft);
        claim(w, pixels[w] >> 1U, kRight);
      });
      for_each_word([&](std::ptrdiff_t w) {
        if ((pixels[w] & 1U) != 0) claim(w - 1, kLastBit, kRight);
      });
      for_each_word([&](std::ptrdiff_t w) { claim(w - stride, pixels[w], kDown); });
    }
  }

 private:
  /// Without a branch: most claims find nothing, unpredictably.
  void claim(std::ptrdiff_t word, Word pixels, Plane direction) {
    const Word found = pixels & still_[word];
    Word& claimed = still_[word + bits_.step(kStill, next_level_)];
    next_[next_count_] = word;
    next_count_ += static_cast<int>(claimed == 0) & static_cast<int>(found != 0);
    claimed |= found;
    still_[word] ^= found;
    still_[word + bits_.step(kStill, direction)] |= found;
  }
  void advance() {
    Word* const done = bits_.at(level_, 0);
    for (std::ptrdiff_t i = 0; i < now_count_; ++i) done[now_[i]] = 0;
    std::swap(level_, next_level_);
    std::swap(now_, next_);
    now_count_ = std::exchange(next_count_, 0);
  }

  Bits& bits_;
  Word* still_;
  // A level is a bit plane, plus a list of its non-zero words, as indices from the start of the plane.
  Plane level_ = kReached;
  Plane next_level_ = kEqualRight;
  Scratch<std::ptrdiff_t> now_;
  Scratch<std::ptrdiff_t> next_;
  std::ptrdiff_t now_count_ = 0;
  std::ptrdiff_t next_count_ = 0;
};

/// Drainage paths, in stretches. The pixels of a row that drain to the same pixel of that row, where the path
/// leaves the row or ends, are contiguous: a stretch. Stretches of row y are numbered from y · width.
class DrainagePaths {
 public:
  DrainagePaths(const Bits& bits, Image<RegionId>& labels, const Exec& exec)
      : bits_(bits),
        labels_(labels),
        exec_(exec),
        to_(static_cast<std::size_t>(labels.size().area()), exec.pool) {
    number_stretches();
    join_floors();
    go_up();
    go_on();
  }

  /// Numbers the basins in the order of their first stretches and writes the labels; returns the number of
  /// basins.
  int label() {
    Scratch<RegionId> label_of(to_.size(), exec_.pool);
    RegionId* const label = label_of.data();
    const std::int32_t* const to = to_.begin();
    const int width = labels_.width();
    std::int32_t count = 0;
    for (int y = 0; y < labels_.height(); ++y) {
      const std::int32_t first = y * width;
      const std::int32_t last = number(labels_(width - 1, y));
      std::fill(label + first, label + last + 1, RegionId{-1});
    }
    std::vector<std::int32_t> ends(slot(width));
    for (int y = 0; y < labels_.height(); ++y) {
      const std::int32_t first = y * width;
      const std::int32_t last = number(labels_(width - 1, y));
      // All ends of a row first: the loop below then does not wait for loads.
      for (std::int32_t i = first; i <= last; ++i) ends[slot(i - first)] = to[to[i]];
      for (std::int32_t i = first; i <= last; ++i) {
        const std::int32_t end = ends[slot(i - first)];
        // Without a branch: −1 if the basin has no number yet, else 0.
        const std::int32_t is_new = number(label[end]) >> 31;
        const RegionId known{(number(label[end]) & ~is_new) | (count & is_new)};
        count -= is_new;
        label[end] = known;
        label[i] = known;
      }
    }
    parallel_for(exec_, labels_.height(), kGrain, [&](int first, int last) {
      for (int y = first; y < last; ++y) {
        RegionId* const row = labels_.row(y);
        for (int x = 0; x < width; ++x) row[x] = label[number(row[x])];
      }
    });
    return count;
  }

 private:
  [[nodiscard]] std::int32_t stretch(int x, int y) const { return number(labels_(x, y)); }
  template <class Found>
  void for_each_pixel(Plane plane, int y, Found found) const {
    const Word* const row = bits_.at(plane, y);
    for (int w = 0; w < bits_.words(); ++w) for_each_bit(row[w], w, found);
  }
  template <class Found>
  static void for_each_bit(Word word, int w, Found found) {
    for (; word != 0; word &= word - 1) found(w * kWordBits + std::countr_zero(word));
  }

  void number_stretches() {
    const kernels::LabelKernels& run = kernels::label_kernels(exec_);
    const int width = labels_.width();
    parallel_for(exec_, labels_.height(), kGrain, [&](int first, int last) {
      std::vector<Word> starts(slot(bits_.words()));
      for (int y = first; y < last; ++y) {
        const Word* const left = bits_.at(kLeft, y);
        const Word* const right = bits_.at(kRight, y);
        const Word* const still = bits_.at(kStill, y);
        for (int w = 0; w < bits_.words(); ++w) {
          starts[slot(w)] =
              ~(left[w] | of_left(right + w) | (still[w] & of_left(still + w))) & bits_.inside(w);
        }
        run.count_up(starts.data(), width, y * width, labels_.row(y));
        std::iota(to_.begin() + y * width, to_.begin() + stretch(width - 1, y) + 1, y * width);
      }
    });
  }

  /// Joins basin floors that span several rows: all their stretches lead to the first one.
  void join_floors() {
    const auto end_of = [&](std::int32_t i) {
      while (to_[i] != i) {
        to_[i] = to_[to_[i]];
        i = to_[i];
      }
      return i;
    };
    std::vector<std::int32_t> joined;
    for (int y = 1; y < labels_.height(); ++y) {
      const Word* const above = bits_.at(kStill, y - 1);
      const Word* const here = bits_.at(kStill, y);
      for (int w = 0; w < bits_.words(); ++w) {
        const Word both = above[w] & here[w];
        // One pixel is enough for two stretches that touch along several.
        for_each_bit(both & ~(both << 1U), w, [&](int x) {
          const std::int32_t p = end_of(stretch(x, y - 1));
          const std::int32_t q = end_of(stretch(x, y));
          if (p == q) return;
          to_[std::max(p, q)] = std::min(p, q);
          joined.push_back(std::max(p, q));
        });
      }
    }
    for (const std::int32_t i : joined) to_[i] = end_of(i);
  }

  /// Follows the paths upward within a block of rows. A stretch then leads to a floor, or to the first
  /// stretch that does not lead up in this block, which still leads to itself.
  void go_up() {
    const int blocks = (labels_.height() + kBlock - 1) / kBlock;
    parallel_for(exec_, blocks, 1, [&](int first, int last) {
      for (int y = first * kBlock + 1; y < std::min(last * kBlock, labels_.height()); ++y) {
        if (y % kBlock == 0) continue;
        for_each_pixel(kUp, y, [&](int x) { to_[stretch(x, y)] = to_[stretch(x, y - 1)]; });
      }
    });
  }

  /// Follows the other paths to their ends. From the bottom up, so most of the paths met are complete.
  void go_on() {
    ScratchList<std::int32_t> rest(static_cast<std::size_t>(labels_.size().area() / 16), exec_.pool);
    for (int y = kBlock; y < labels_.height(); y += kBlock) {
      for_each_pixel(kUp, y, [&](int x) {
        to_[stretch(x, y)] = to_[stretch(x, y - 1)];
        rest.push_back(stretch(x, y));
      });
    }
    for (int y = labels_.height() - 2; y >= 0; --y) {
      const std::int32_t decided = (y + 1) * labels_.width();
      std::int32_t* const room = rest.room_for(slot(labels_.width()));
      std::size_t found = 0;
      for_each_pixel(kDown, y, [&](int x) {
        const std::int32_t i = stretch(x, y);
        const std::int32_t end = to_[to_[stretch(x, y + 1)]];
        to_[i] = end;
        // Rows below are complete, so their ends are known; the rest is repeated.
        room[found] = i;
        found += static_cast<std::size_t>((end < decided) | (to_[end] != end));
      });
      rest.grown(found);
    }
    for (std::size_t count = rest.size(); count > 0;) {
      std::size_t kept = 0;
      for (std::size_t k = 0; k < count; ++k) {
        const std::int32_t i = rest.begin()[k];
        const std::int32_t end = to_[to_[i]];
        to_[i] = end;
        rest.begin()[kept] = i;
        kept += to_[end] != end ? 1 : 0;
      }
      count = kept;
    }
  }

  const Bits& bits_;
  Image<RegionId>& labels_;
  const Exec& exec_;
  Scratch<std::int32_t> to_;  // the next stretch along the path; itself at the end
};

}  // namespace

Basins watershed(View<const std::uint16_t> gradient, const Exec& exec) {
  Bits bits = flow_downhill(gradient, exec);
  flow_next_to_slopes(bits, exec);
  Flood(bits, exec).run();
  Basins basins{Image<RegionId>(gradient.size(), exec.pool), 0};
  basins.count = DrainagePaths(bits, basins.labels, exec).label();
  return basins;
}

}  // namespace cairn
