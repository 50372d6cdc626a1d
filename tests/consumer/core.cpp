// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/cairn.hpp>
#include <cstdio>

/// Segments a pair of grey noise, so that every stage is linked and run; and catches the library's exception,
/// which requires the same type on both sides of a shared library.
int main() {
  cairn::Image<cairn::Gray> left({64, 48});
  cairn::Image<cairn::Gray> right({64, 48});
  unsigned state = 1;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      state = state * 1664525U + 1013904223U;
      left(x, y) = static_cast<cairn::Gray>(state >> 24U);
      right(x, y) = left(x, y);
    }
  }
  cairn::Config config;
  config.match.num_disparities = 16;
  const cairn::Frame frame =
      cairn::segment(cairn::StereoPair::from(left, right), {}, config, cairn::Exec::with_threads(2));
  if (frame.disparity.disparity_px.size() != left.size()) return 1;
  try {
    cairn::set(config, "match.num_disparities", "many");
  } catch (const cairn::Error& error) {
    std::printf("core: %s\n", error.what());
    return 0;
  }
  return 1;
}
