// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <cairn/io/rle.hpp>
#include <random>

namespace cairn::io {
namespace {

using Counts = std::vector<std::int64_t>;

/// COCO's text form worked out by hand: groups of five bits from the lowest, +32 where more follow, all from
/// '0' (48) on.
TEST(RunLengthText, EqualsCocosForNumbersWorkedOutByHand) {
  EXPECT_EQ(counts_to_text({0}), "0");
  EXPECT_EQ(counts_to_text({15}), "?");          // 15 + 48
  EXPECT_EQ(counts_to_text({16}), "`0");         // 16 has the sign bit set: one more group of 0
  EXPECT_EQ(counts_to_text({100}), "T3");        // 4 + 32, 3
  EXPECT_EQ(counts_to_text({0, 100}), "0T3");    // the full 10x10 mask
  EXPECT_EQ(counts_to_text({307200}), "PP\\9");  // the empty 640x480 mask: groups 0, 0, 12, 9
}

TEST(RunLengthText, WritesDifferencesToTheNumberTwoBeforeFromTheFourthOn) {
  // 10, 3, 7 as they are; then 3 − 3 = 0, 7 − 7 = 0, 1 − 3 = −2.
  EXPECT_EQ(counts_to_text({10, 3, 7, 3, 7, 1}), ":3700N");
}

TEST(RunLengthText, RoundTrips) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    Counts counts;
    const int length = static_cast<int>(random() % 30) + 1;
    for (int i = 0; i < length; ++i)
      counts.push_back(static_cast<std::int64_t>(random() % (1U << (random() % 27))));
    EXPECT_EQ(text_to_counts(counts_to_text(counts)), counts);
  }
}

TEST(RunLengthText, RefusesInvalidInput) {
  EXPECT_THROW(text_to_counts("T"), Error);                // ends inside a number
  EXPECT_THROW(text_to_counts("!"), Error);                // below the alphabet
  EXPECT_THROW(text_to_counts("p"), Error);                // above it
  EXPECT_THROW(text_to_counts("N"), Error);                // −2 pixels
  EXPECT_THROW(text_to_counts("PPPPPPPPPPPPPP4"), Error);  // more than 64 bits
  EXPECT_TRUE(text_to_counts("").empty());
}

Image<ObjectId> empty(Size size) {
  return {size, ObjectId::none, {}};
}

TEST(RunLengthMask, CountsDownTheColumnsBeginningWithZeros) {
  Image<ObjectId> labels = empty({5, 6});
  for (int y = 1; y < 4; ++y) {
    for (int x = 2; x < 4; ++x) labels(x, y) = ObjectId{3};
  }
  // Two columns of 6 and one pixel before; 3 inside; 2 + 1 between; 3 inside; 2 and a column after.
  EXPECT_EQ(text_to_counts(encode_rle(labels, ObjectId{3}, {2, 1, 2, 3}).counts), (Counts{13, 3, 3, 3, 8}));
}

TEST(RunLengthMask, OfAWholeImageStartsWithNoZeros) {
  const Image<ObjectId> labels({10, 10}, ObjectId{1}, {});
  EXPECT_EQ(encode_rle(labels, ObjectId{1}, {0, 0, 10, 10}).counts, "0T3");
}

TEST(RunLengthMask, OfAnEmptyMaskIsOneRunOfZeros) {
  const Image<ObjectId> labels = empty({10, 10});
  EXPECT_EQ(encode_rle(labels, ObjectId{1}, {}).counts, "T3");
}

TEST(RunLengthMask, RefusesRunsThatDoNotFillTheSize) {
  EXPECT_NO_THROW((void)decode_rle({{10, 10}, "0T3"}));
  EXPECT_THROW((void)decode_rle({{10, 10}, "0S3"}), Error);  // 99
  EXPECT_THROW((void)decode_rle({{10, 10}, "0U3"}), Error);  // 101
  EXPECT_THROW((void)decode_rle({{10, 10}, ""}), Error);
}

/// By definition: runs over all pixels, column by column.
Counts counts_of_all_pixels(View<const ObjectId> labels, ObjectId id) {
  Counts counts{0};
  bool inside = false;
  for (int x = 0; x < labels.width(); ++x) {
    for (int y = 0; y < labels.height(); ++y) {
      if ((labels(x, y) == id) != inside) {
        counts.push_back(0);
        inside = !inside;
      }
      ++counts.back();
    }
  }
  return counts;
}

Rect box_of(View<const ObjectId> labels, ObjectId id) {
  Rect box;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      if (labels(x, y) == id) box = united(box, {x, y, 1, 1});
    }
  }
  return box;
}

TEST(RunLengthMask, EqualsItsDefinitionAndRoundTrips) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 400; ++trial) {
    const Size size{static_cast<int>(random() % 12) + 1, static_cast<int>(random() % 12) + 1};
    Image<ObjectId> labels = empty(size);
    const auto density = random() % 10 + 1;
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) labels(x, y) = ObjectId{random() % 10 < density ? 1 : 2};
    }
    for (const ObjectId id : {ObjectId{1}, ObjectId{2}, ObjectId{3}}) {
      const Rle rle = encode_rle(labels, id, box_of(labels, id));
      ASSERT_EQ(text_to_counts(rle.counts), counts_of_all_pixels(labels, id)) << text(size);
      const Image<std::uint8_t> mask = decode_rle(rle);
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) ASSERT_EQ(mask(x, y) != 0, labels(x, y) == id);
      }
    }
  }
}

}  // namespace
}  // namespace cairn::io
