// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Included once for each instruction set, by row_kernels.cpp, so without a guard.
namespace cairn::kernels::CAIRN_KERNEL_TARGET {
namespace {

/// The right pixels that left ones are matched with, `none` where there is none.
inline void find_partners(const std::int16_t* best, int width, int none,
                          std::int32_t* CAIRN_RESTRICT partners) {
  const auto count = static_cast<std::uint32_t>(width);
  for (int x = 0; x < width; ++x) {
    const int partner = x - best[x];
    const bool inside = static_cast<std::uint32_t>(partner) < count;
    partners[x] = (inside & (best[x] != kNoMatch)) ? partner : none;
  }
}

/// `difference(x)`: between a left pixel's disparity and what it comes back to.
template <class Difference>
inline void judge_differences(const std::int16_t* best, int width, int max_diff, Difference difference,
                              Reject* CAIRN_RESTRICT verdict) {
  for (int x = 0; x < width; ++x) {
    const bool comes_back = (std::abs(difference(x)) <= max_diff) | (best[x] == kNoMatch);
    verdict[x] = comes_back ? Reject::none : Reject::left_right;
  }
}

inline constexpr int kVotes =
    256;  // left pixels at a time: what is noted about them stays in the nearest cache

/// What is decided pixel by pixel, because two may claim the same one, is nothing but the least of two
/// numbers; those without a partner claim one beyond the row. So no time depends on what the picture shows.
inline void cast_votes(const std::int32_t* partners, const float* cost, int begin, int count,
                       Claim* CAIRN_RESTRICT least) {
  Claim own[kVotes];
  for (int i = 0; i < count; ++i) own[i] = claim_of(cost[i], begin + i);
#pragma GCC unroll 4
  for (int i = 0; i < count; ++i) {
    const Claim claim = own[i];
    const Claim known = least[partners[i]];
    least[partners[i]] = claim < known ? claim : known;
  }
}

inline void compare_with_votes(const std::int16_t* best, const float* cost, int width, int max_diff,
                               std::int32_t* CAIRN_RESTRICT partners, Claim* CAIRN_RESTRICT claims,
                               Reject* CAIRN_RESTRICT verdict) {
  std::fill_n(claims, width + 1, kNoClaim);
  find_partners(best, width, width, partners);
  for (int x = 0; x < width; x += kVotes)
    cast_votes(partners + x, cost + x, x, std::min(kVotes, width - x), claims);
  for (int x = 0; x < width; x += kVotes) {
    const int count = std::min(kVotes, width - x);
    std::int32_t claimants[kVotes];
    for (int i = 0; i < count; ++i) claimants[i] = claimant(claims[partners[x + i]]);
    // Of pixels that claim the same one, disparities differ as much as places do.
    judge_differences(
        best + x, count, max_diff, [&](int i) { return x + i - claimants[i]; }, verdict + x);
  }
}

inline void compare_with_right(const std::int16_t* best, const std::int16_t* best_right, int width,
                               int max_diff, std::int32_t* CAIRN_RESTRICT partners,
                               std::int32_t* CAIRN_RESTRICT back, Reject* CAIRN_RESTRICT verdict) {
  find_partners(best, width, 0, partners);
  for (int x = 0; x < width; ++x) back[x] = best_right[partners[x]];
  judge_differences(
      best, width, max_diff, [best, back](int x) { return best[x] - back[x]; }, verdict);
}

inline void compare_with_runner_up(const float* cost, const float* runner_up, int width, float share,
                                   Reject* CAIRN_RESTRICT verdict) {
  // kNoCost needs no case of its own: infinity, and NaN for a ratio of 100, are never less than anything.
  for (int x = 0; x < width; ++x)
    verdict[x] = runner_up[x] * share < cost[x] * 100.0F ? Reject::not_unique : Reject::none;
}

inline void compare_with_mean(const float* cost, const float* mean, int width, float threshold,
                              Reject* CAIRN_RESTRICT verdict) {
  for (int x = 0; x < width; ++x) {
    const bool shallow = !(mean[x] > 0) | ((mean[x] - cost[x]) / mean[x] < threshold);
    verdict[x] = (shallow & (cost[x] < kNoCost)) ? Reject::flat : Reject::none;
  }
}

inline void mark_holes(const float* disparity_px, int width, Reject* CAIRN_RESTRICT reject) {
  for (int x = 0; x < width; ++x)
    reject[x] = disparity_px[x] == disparity_px[x] ? Reject::none : Reject::border;  // a hole is NaN
}

inline void add_reasons(const Reject* more, int width, Reject* CAIRN_RESTRICT reject) {
  for (int x = 0; x < width; ++x) reject[x] |= more[x];
}

inline void punch_holes(const Reject* reject, int width, float* CAIRN_RESTRICT disparity_px) {
  constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
  for (int x = 0; x < width; ++x) disparity_px[x] = reject[x] == Reject::none ? disparity_px[x] : kHole;
}

/// Repeats the first and the last sample of a row `radius` times around it.
inline void replicate_ends(std::uint16_t* row, int width, int channels, int radius) {
  const int last = (width - 1) * channels;
  for (int i = 1; i <= radius; ++i) {
    for (int c = 0; c < channels; ++c) {
      row[c - i * channels] = row[c];
      row[last + c + i * channels] = row[last + c];
    }
  }
}

inline void smooth(const std::uint8_t* const* rows, int width, int channels, RowWeights kernel,
                   std::uint16_t* CAIRN_RESTRICT padded, std::uint32_t* CAIRN_RESTRICT sum,
                   std::int16_t* CAIRN_RESTRICT out) {
  const int r = kernel.radius;
  const int length = width * channels;
  std::uint16_t* const column = padded + r * channels;  // 8.8 bits
  const auto centre_weight = static_cast<std::uint16_t>(kernel.weights[0]);
  for (int x = 0; x < length; ++x) column[x] = static_cast<std::uint16_t>(rows[r][x] * centre_weight);
  for (int i = 1; i <= r; ++i) {
    const std::uint8_t* const up = rows[r - i];
    const std::uint8_t* const down = rows[r + i];
    const auto w = static_cast<std::uint16_t>(kernel.weights[i]);
    for (int x = 0; x < length; ++x)
      column[x] = static_cast<std::uint16_t>(column[x] + w * (up[x] + down[x]));
  }
  replicate_ends(column, width, channels, r);

  // 8.16 bits.
  for (int x = 0; x < length; ++x) sum[x] = std::uint32_t{column[x]} * centre_weight + (1U << 11U);
  for (int i = 1; i <= r; ++i) {
    const auto w = static_cast<std::uint32_t>(kernel.weights[i]);
    const std::uint16_t* const left = column - i * channels;
    const std::uint16_t* const right = column + i * channels;
    for (int x = 0; x < length; ++x) sum[x] += w * (std::uint32_t{left[x]} + right[x]);
  }
  for (int x = 0; x < length; ++x) out[x] = static_cast<std::int16_t>(sum[x] >> 12U);
}

inline void edges(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                  int channels, std::uint32_t* CAIRN_RESTRICT squares, std::uint16_t* CAIRN_RESTRICT out) {
  const int end = (width - 1) * channels;
  const auto square = [&](int x, int left, int right) {
    const int gx = here[right] - here[left];
    const int gy = down[x] - up[x];
    return static_cast<std::uint32_t>(gx * gx + gy * gy);
  };
  for (int x = channels; x < end; ++x) squares[x] = square(x, x - channels, x + channels);
  for (int c = 0; c < channels; ++c) {
    squares[c] = square(c, c, c + std::min(channels, end));
    squares[end + c] = square(end + c, c + std::max(end - channels, 0), end + c);
  }
  // The root of the largest square is the largest root, rounded or not.
  if (channels == 3) {
    for (int x = 0; x < width; ++x)
      squares[x] = std::max(std::max(squares[3 * x], squares[3 * x + 1]), squares[3 * x + 2]);
  }
  for (int x = 0; x < width; ++x) {
    const float magnitude = std::sqrt(static_cast<float>(static_cast<int>(squares[x]))) * 0.125F;
    out[x] = static_cast<std::uint16_t>(static_cast<int>(magnitude + 0.5F));  // 1/32 → 1/4 level
  }
}

/// For each pixel magnitude(centre, up, left, right, down); what is outside counts as the pixel itself.
template <class Magnitude>
inline void over_neighbours(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                            int width, std::uint16_t* CAIRN_RESTRICT out, Magnitude magnitude) {
  const int end = width - 1;
  out[0] = magnitude(here[0], up[0], here[0], here[end > 0 ? 1 : 0], down[0]);
  for (int x = 1; x < end; ++x) out[x] = magnitude(here[x], up[x], here[x - 1], here[x + 1], down[x]);
  if (end > 0) out[end] = magnitude(here[end], up[end], here[end - 1], here[end], down[end]);
}

inline void steepness(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down, int width,
                      std::uint16_t* CAIRN_RESTRICT out) {
  over_neighbours(up, here, down, width, out, [](int, int u, int l, int r, int d) {
    constexpr int kCap =
        256 * 16;  // beyond it the root rounds to 255 anyhow, and floats hold the sum exactly
    const int square = std::min((r - l) * (r - l) + (d - u) * (d - u), kCap * kCap);
    const int root = static_cast<int>(std::sqrt(static_cast<float>(square)) * (1.0F / 16) + 0.5F);
    return static_cast<std::uint16_t>(std::min(root, 255));
  });
}

inline void disparity_steepness(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                                int width, std::uint16_t* CAIRN_RESTRICT out) {
  over_neighbours(up, here, down, width, out, [](int centre, int u, int l, int r, int d) {
    const auto known = [centre](int neighbour) { return neighbour == kHole16 ? centre : neighbour; };
    const auto capped = [](int step) { return std::min(std::max(step, -kSteepest16), kSteepest16); };
    const int gx = capped(known(r) - known(l));
    const int gy = capped(known(d) - known(u));
    const int square = std::min(gx * gx + gy * gy, kSteepest16 * kSteepest16);
    const int root = static_cast<int>(std::sqrt(static_cast<float>(square)) + 0.5F);
    return static_cast<std::uint16_t>(centre == kHole16 ? int{kHoleGradient} : root);
  });
}

inline void quantise(const float* disparity_px, int width, std::int16_t* CAIRN_RESTRICT out) {
  for (int x = 0; x < width; ++x) {
    const float d = disparity_px[x];
    // 32767/16 is no limit in practice (kMaxDisparity); the clamp keeps the conversion defined, of NaN, too.
    const float wide = d * 16.0F;
    const float bounded = wide > -32767.0F ? wide : -32767.0F;
    const float sixteenths = bounded < 32767.0F ? bounded : 32767.0F;
    // Truncation and a correction instead of std::floor, which is a call per pixel before SSE4.1.
    const int truncated = static_cast<int>(sixteenths);
    const float rest = sixteenths - static_cast<float>(truncated);
    const int rounded = truncated + (rest >= 0.5F ? 1 : 0) - (rest < -0.5F ? 1 : 0);
    const int hole = d == d ? 0 : -1;  // a hole is NaN
    out[x] = static_cast<std::int16_t>((rounded & ~hole) | (kHole16 & hole));
  }
}

inline void noise(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down, int width,
                  std::uint16_t* CAIRN_RESTRICT out) {
  for (int x = 1; x + 1 < width; ++x) {
    const int corners = up[x - 1] + up[x + 1] + down[x - 1] + down[x + 1];
    const int sides = up[x] + down[x] + here[x - 1] + here[x + 1];
    const auto response = static_cast<std::int16_t>(corners - 2 * sides + 4 * here[x]);
    out[x] = static_cast<std::uint16_t>(response < 0 ? -response : response);
  }
}

inline void smooth_lightly(const std::uint8_t* up, const std::uint8_t* here, const std::uint8_t* down,
                           int width, std::int16_t* CAIRN_RESTRICT column, std::int16_t* CAIRN_RESTRICT out) {
  for (int x = 0; x < width; ++x) column[x + 1] = static_cast<std::int16_t>(up[x] + 6 * here[x] + down[x]);
  column[0] = column[1];
  column[width + 1] = column[width];
  for (int x = 0; x < width; ++x)
    out[x] = static_cast<std::int16_t>(column[x] + 6 * column[x + 1] + column[x + 2]);
}

inline void textured(const std::int16_t* up, const std::int16_t* here, const std::int16_t* down,
                     const Reject* reject, const float* disparity_px, int width, int least,
                     float* CAIRN_RESTRICT out) {
  const auto tested = [&](int x, int left, int right) {
    const int across = std::abs(here[right] - here[left]);
    const int along = std::abs(down[x] - up[x]);
    const bool passes = (reject[x] == Reject::none) & (across > least) & (2 * across > along);
    return passes ? disparity_px[x] : std::numeric_limits<float>::quiet_NaN();
  };
  const int end = width - 1;
  out[0] = tested(0, 0, std::min(1, end));
  for (int x = 1; x < end; ++x) out[x] = tested(x, x - 1, x + 1);
  out[end] = tested(end, std::max(end - 1, 0), end);
}

inline void agreed(const float* const* rows, int width, float agreement, float* CAIRN_RESTRICT out) {
  const float* const r0 = rows[0];
  const float* const r1 = rows[1];
  const float* const r2 = rows[2];
  const float* const r3 = rows[3];
  const float* const r4 = rows[4];
  for (int x = 0; x < width; ++x) {
    const float d = r2[x];
    const auto near = [d, agreement](float other) { return std::abs(other - d) <= agreement ? 1 : 0; };
    const auto near_in = [x, near](const float* row) {
      return near(row[x - 2]) + near(row[x - 1]) + near(row[x]) + near(row[x + 1]) + near(row[x + 2]);
    };
    const int count = near_in(r0) + near_in(r1) + near_in(r2) + near_in(r3) + near_in(r4);
    out[x] = count > 3 ? d : std::numeric_limits<float>::quiet_NaN();  // the pixel itself is met, too
  }
}

/// Of how many points judge(points, i, the plane's disparity there) holds.
template <class Judge>
inline int count_where(const PointArrays& points, const GroundPlane& plane, Judge judge) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  int count = 0;
  for (int i = 0; i < at.count; ++i) count += judge(at, i, p.a * at.x[i] + p.b * at.y[i] + p.c) ? 1 : 0;
  return count;
}

inline int count_on(const PointArrays& points, const GroundPlane& plane, float tolerance) {
  return count_where(points, plane, [tolerance](const PointArrays& at, int i, float d) {
    return std::abs(at.d[i] - d) < tolerance;
  });
}

inline int count_beyond(const PointArrays& points, const GroundPlane& plane, float tolerance) {
  return count_where(points, plane, [tolerance](const PointArrays& at, int i, float d) {
    const float back = at.behind[i] < d ? d : at.behind[i];
    return at.d[i] - back < -tolerance;
  });
}

inline int count_on_before(const PointArrays& points, const GroundPlane& plane, float tolerance) {
  return count_where(points, plane, [tolerance](const PointArrays& at, int i, float d) {
    return (d > at.behind[i]) & (std::abs(at.d[i] - d) < tolerance);
  });
}

inline PlaneSums sum_on(const PointArrays& points, const GroundPlane& plane, float tolerance,
                        float* CAIRN_RESTRICT d_on) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  PlaneSums sums;
  for (int i = 0; i < at.count; ++i) {
    const bool on = std::abs(at.d[i] - (p.a * at.x[i] + p.b * at.y[i] + p.c)) < tolerance;
    const auto x = static_cast<std::uint32_t>(on ? static_cast<std::int32_t>(at.x[i]) : 0);
    const auto y = static_cast<std::uint32_t>(on ? static_cast<std::int32_t>(at.y[i]) : 0);
    d_on[i] = on ? at.d[i] : 0.0F;
    sums.count += on ? 1 : 0;
    sums.x += x;
    sums.y += y;
    sums.xx += std::uint64_t{x} * x;
    sums.xy += std::uint64_t{x} * y;
    sums.yy += std::uint64_t{y} * y;
  }
  return sums;
}

inline void put_behind(const PointArrays& points, const GroundPlane& plane, float* CAIRN_RESTRICT behind) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  for (int i = 0; i < at.count; ++i) {
    const float d = p.a * at.x[i] + p.b * at.y[i] + p.c;
    behind[i] = behind[i] < d ? d : behind[i];
  }
}

inline void mark_between(const PointArrays& points, const GroundPlane& plane, float least, float most,
                         std::uint8_t* CAIRN_RESTRICT marks) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  for (int i = 0; i < at.count; ++i) {
    const float above = at.d[i] - (p.a * at.x[i] + p.b * at.y[i] + p.c);
    marks[i] = static_cast<std::uint8_t>((above >= least) & (above <= most));
  }
}

inline PlaneCounts count_about(const PointArrays& points, const GroundPlane& plane, float infinity,
                               float tolerance) {
  const GroundPlane p = plane;
  const PointArrays at = points;
  PlaneCounts counts;
  for (int i = 0; i < at.count; ++i) {
    const float floor = p.a * at.x[i] + p.b * at.y[i] + p.c;
    const float above = at.d[i] - floor;
    const float distance = std::abs(above);
    const int visible = floor + infinity > 0 ? 1 : 0;
    counts.all += visible;
    counts.on += distance <= tolerance ? visible : 0;
    counts.near += distance <= 2 * tolerance ? visible : 0;
    counts.below += above < -2 * tolerance ? visible : 0;
  }
  return counts;
}

inline void reject_below(const FloorRow& given, int y, int width, float* CAIRN_RESTRICT disparity_px,
                         Reject* CAIRN_RESTRICT reject) {
  const FloorRow row = given;
  const GroundPlane p = row.plane;
  for (int x = 0; x < width; ++x) {
    const float floor = p.a * static_cast<float>(x) + p.b * static_cast<float>(y) + p.c;
    const float d = disparity_px[x];
    const bool below = (floor + row.infinity > 0) & (d < floor - row.margin);
    disparity_px[x] = below ? std::numeric_limits<float>::quiet_NaN() : d;
    reject[x] |= below ? Reject::below_ground : Reject::none;
  }
}

inline void label_floor(const FloorRow& given, int y, int width, const float* disparity_px,
                        std::uint8_t* CAIRN_RESTRICT label) {
  const FloorRow row = given;
  const GroundPlane p = row.plane;
  for (int x = 0; x < width; ++x) {
    const float floor = p.a * static_cast<float>(x) + p.b * static_cast<float>(y) + p.c;
    const bool on = (floor + row.infinity > 0) & (std::abs(disparity_px[x] - floor) <= row.margin);
    label[x] = on ? std::uint8_t{255} : std::uint8_t{0};
  }
}

inline PlaneCounts count_support(const float* disparity_px, int y, int width, const GroundPlane& plane,
                                 float infinity, float tolerance) {
  const GroundPlane p = plane;
  PlaneCounts counts;
  for (int x = 0; x < width; ++x) {
    const float floor = p.a * static_cast<float>(x) + p.b * static_cast<float>(y) + p.c;
    const float distance =
        std::abs(disparity_px[x] - floor);  // NaN for a hole, which no comparison holds for
    const int visible = floor + infinity > 0 ? 1 : 0;
    counts.all += distance >= 0 ? visible : 0;
    counts.on += distance <= tolerance ? visible : 0;
  }
  return counts;
}

/// 16 bits hold the square of a difference of bytes, and multiply twice as many at once.
inline std::uint16_t square(std::uint8_t p, std::uint8_t q, std::uint16_t most) {
  const auto difference = static_cast<std::int16_t>(p - q);
  return std::min(static_cast<std::uint16_t>(difference * difference), most);
}

template <class Sum>
inline void add_squares(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                        Sum* CAIRN_RESTRICT sums) {
  for (int x = 0; x < count; ++x) sums[x] = static_cast<Sum>(sums[x] + square(here[x], there[x], most));
}

template <class Sum>
inline void remove_squares(const std::uint8_t* here, const std::uint8_t* there, int count, std::uint16_t most,
                           Sum* CAIRN_RESTRICT sums) {
  for (int x = 0; x < count; ++x) sums[x] = static_cast<Sum>(sums[x] - square(here[x], there[x], most));
}

/// to[x] = from[x] + more[x]
template <class T>
inline void add_rows(const T* from, const T* more, int count, T* CAIRN_RESTRICT to) {
  for (int x = 0; x < count; ++x) to[x] = static_cast<T>(from[x] + more[x]);
}

/// Sums of `window` numbers from each on, put together from blocks of 1, 2, 4, … numbers. The window is odd.
template <class T>
inline void sum_along(const T* columns, int width, int window, T* blocks, T* sums) {
  T* const halves[] = {blocks, blocks + width + window};  // what is read and what is written must not overlap
  const T* block = columns;
  const T* sum = columns;
  int summed = 1;
  int length = width + window - 1;
  int half = 0;
  for (int size = 2; size <= window; size *= 2, half = 1 - half) {
    length -= size / 2;  // of blocks that are whole
    add_rows(block, block + size / 2, length, halves[half]);
    block = halves[half];
    if ((window & size) == 0) continue;
    for (int x = 0; x < width; ++x) sums[x] = static_cast<T>(sum[x] + block[x + summed]);
    sum = sums;
    summed += size;
  }
}

template <class Sum>
inline void flag_low_sums(const Sum* columns, int width, int window, const Sum* limits, Reject why,
                          Sum* blocks, Sum* sums, Reject* CAIRN_RESTRICT verdict) {
  sum_along(columns, width, window, blocks, sums);
  for (int x = 0; x < width; ++x) verdict[x] |= sums[x] < limits[x] ? why : Reject::none;
}

template <class Sum>
inline constexpr SquareKernels<Sum> kSquareKernels{add_squares<Sum>, remove_squares<Sum>, flag_low_sums<Sum>};

inline constexpr HolesAndJumps kHole = 1;
inline constexpr HolesAndJumps kIsJump = 256;

inline void mark_jumps(const float* here, const float* below, int width, float jump,
                       HolesAndJumps* CAIRN_RESTRICT marks) {
  const auto mark = [&](int x, int right) {
    const float d = here[x];
    // NaN differs from nothing by more than anything. Both are compared always: a branch would keep the loop
    // from becoming vector code.
    const int along = std::abs(d - here[right]) > jump ? kIsJump : 0;
    const int down = std::abs(d - below[x]) > jump ? kIsJump : 0;
    return static_cast<HolesAndJumps>((d == d ? 0 : kHole) | along | down);
  };
  for (int x = 0; x + 1 < width; ++x) marks[x] = mark(x, x + 1);
  marks[width - 1] = mark(width - 1, width - 1);
}

inline void add_counts(const HolesAndJumps* more, int width, HolesAndJumps* CAIRN_RESTRICT counts) {
  for (int x = 0; x < width; ++x) counts[x] = static_cast<HolesAndJumps>(counts[x] + more[x]);
}

inline void remove_counts(const HolesAndJumps* less, int width, HolesAndJumps* CAIRN_RESTRICT counts) {
  for (int x = 0; x < width; ++x) counts[x] = static_cast<HolesAndJumps>(counts[x] - less[x]);
}

inline void sum_counts(const HolesAndJumps* columns, int width, int window, HolesAndJumps* blocks,
                       HolesAndJumps* sums) {
  sum_along(columns, width, window, blocks, sums);
}

/// 2^t for |t| ≤ kGreatestExponent, to 2·10⁻⁷ of it; in arithmetic that is the same everywhere, as no
/// library's is.
inline float power_of_two(float t) {
  constexpr int kOffset = 64;
  const int whole = static_cast<int>(t + kOffset) - kOffset;
  const float f = t - static_cast<float>(whole);
  const float fraction =
      1.0F + f * (0.6931514F + f * (0.2401641F + f * (0.0558005F + f * (0.00901663F + f * 0.00186721F))));
  return std::bit_cast<float>((whole + 127) << 23) * fraction;
}

inline constexpr float kLeastMean = 1e-6F;  // keeps costs that are all 0 from dividing by it
inline constexpr float kGreatestExponent = 30.0F;

inline float logistic(float log_odds) {
  constexpr float kLog2OfE = 1.44269504F;
  // In this order of arguments NaN, which pixels without a match have, is held at the bound, too.
  const float exponent = std::max(-kGreatestExponent, std::min(kGreatestExponent, -kLog2OfE * log_odds));
  return 1.0F / (1.0F + power_of_two(exponent));
}

inline void judge_confidence(const ConfidenceRow& given, int width, const ConfidenceModel& fitted,
                             float* CAIRN_RESTRICT out) {
  const ConfidenceRow row = given;
  const ConfidenceModel model = fitted;
  for (int x = 0; x < width; ++x) {
    const float inverse_mean = 1.0F / std::max(row.mean_cost[x], kLeastMean);
    const float margin = std::min((row.runner_up[x] - row.cost[x]) * inverse_mean, 1.0F);
    const float cost = std::min(row.cost[x] * inverse_mean, 1.0F);
    const int counts = row.around[x];
    const float jumps = std::sqrt(static_cast<float>(counts >> 8) * row.inverse_area[x]);
    const float holes = std::sqrt(static_cast<float>(counts & 255) * row.inverse_area[x]);
    const float log_odds =
        model.bias + model.margin * margin + model.cost * cost + model.jumps * jumps + model.holes * holes;
    const float confidence = logistic(log_odds);
    const float d = row.disparity_px[x];
    out[x] = d == d ? confidence : 0.0F;  // a hole is NaN
  }
}

inline void points_in_camera(const StereoRig& given, int y, int first, int last, const float* disparity_px,
                             float* CAIRN_RESTRICT x_m, float* CAIRN_RESTRICT y_m,
                             float* CAIRN_RESTRICT z_m) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr float kFarthest = std::numeric_limits<float>::max();
  const StereoRig rig = given;
  const float row = static_cast<float>(y) - rig.cy_px;
  for (int x = first; x < last; ++x) {
    const float before_infinity = disparity_px[x] + rig.doffs_px;
    const float z = rig.focal_px * rig.baseline_m / before_infinity;
    const bool seen = (before_infinity > 0) & (z <= kFarthest);
    x_m[x] = seen ? (static_cast<float>(x) - rig.cx_px) * z / rig.focal_px : kNone;
    y_m[x] = seen ? row * z / rig.focal_px : kNone;
    z_m[x] = seen ? z : kNone;
  }
}

inline constexpr RowKernels kRowKernels{compare_with_votes,
                                        compare_with_right,
                                        compare_with_runner_up,
                                        compare_with_mean,
                                        mark_holes,
                                        add_reasons,
                                        punch_holes,
                                        smooth,
                                        edges,
                                        steepness,
                                        disparity_steepness,
                                        quantise,
                                        noise,
                                        smooth_lightly,
                                        textured,
                                        agreed,
                                        count_on,
                                        count_beyond,
                                        count_on_before,
                                        sum_on,
                                        put_behind,
                                        mark_between,
                                        count_about,
                                        count_support,
                                        reject_below,
                                        label_floor,
                                        kSquareKernels<std::uint16_t>,
                                        kSquareKernels<std::uint32_t>,
                                        mark_jumps,
                                        add_counts,
                                        remove_counts,
                                        sum_counts,
                                        judge_confidence,
                                        points_in_camera};

}  // namespace
}  // namespace cairn::kernels::CAIRN_KERNEL_TARGET
