// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/ids.hpp>
#include <cairn/core/view.hpp>
#include <vector>

namespace cairn {

/// Calls found(x, y, dx, dy) for each pixel of rows first … last − 1 and its right (dx = 1) or lower (dy = 1)
/// neighbour of another region: in raster order, to the right before down.
template <class Found>
void for_each_contact(View<const RegionId> labels, int first, int last, Found found) {
  const int width = labels.width();
  std::vector<int> columns(slot(width));
  for (int y = first; y < last; ++y) {
    const RegionId* const row = labels.row(y);
    const RegionId* const below = y + 1 < labels.height() ? labels.row(y + 1) : row;
    // Without a branch, because the processor cannot predict where a region ends.
    std::size_t count = 0;
    for (int x = 0; x + 1 < width; ++x) {
      columns[count] = x;
      count += ((row[x] != row[x + 1]) | (row[x] != below[x])) ? 1 : 0;
    }
    if (row[width - 1] != below[width - 1]) columns[count++] = width - 1;
    for (std::size_t i = 0; i < count; ++i) {
      const int x = columns[i];
      if (x + 1 < width && row[x] != row[x + 1]) found(x, y, 1, 0);
      if (row[x] != below[x]) found(x, y, 0, 1);
    }
  }
}

}  // namespace cairn
