// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/error.hpp>
#include <string>

namespace cairn {
namespace {

TEST(Error, IsOneLineWhateverItQuotes) {
  EXPECT_STREQ(Error("left.png: is not there").what(), "left.png: is not there");
  EXPECT_STREQ(Error("a\nb.png: is not there").what(), "a\\nb.png: is not there");
  EXPECT_STREQ(Error("\x1b[31mred\x7f\t\r").what(), "\\x1b[31mred\\x7f\\x09\\x0d");
  EXPECT_STREQ(Error("straße 深度 · 3 … 31").what(), "straße 深度 · 3 … 31");
  EXPECT_STREQ(Error(std::string("\0", 1)).what(), "\\x00");
}

}  // namespace
}  // namespace cairn
