// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target, inside HWY_BEFORE_NAMESPACE.
namespace cairn::kernels::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_AVX2
/// For each mask of eight lanes: the set ones, then the others, four bits each.
constexpr std::array<std::uint32_t, 256> kSetLanesFirst = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t mask = 0; mask < table.size(); ++mask) {
    std::uint32_t shift = 0;
    for (const std::uint32_t wanted : {1U, 0U}) {
      for (std::uint32_t lane = 0; lane < 8; ++lane) {
        if ((mask >> lane & 1U) != wanted) continue;
        table[mask] |= lane << shift;
        shift += 4;
      }
    }
  }
  return table;
}();

/// hn::Compress(), whose table is a local constant in Highway 1.0: GCC copies all of it to the stack for each vector.
template <class V, class M>
HWY_INLINE V compress(V v, M mask) {
  static_assert(sizeof(hn::TFromV<V>) == 4);
  const hn::DFromV<V> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  std::uint8_t bits[8];  // what StoreMaskBits() may write
  hn::StoreMaskBits(d, mask, bits);
  const auto shifts = hn::ShiftLeft<2>(hn::Iota(du, 0));
  const auto lanes = hn::And(hn::Shr(hn::Set(du, kSetLanesFirst[bits[0]]), shifts), hn::Set(du, 7));
  return hn::TableLookupLanes(v, hn::IndicesFromVec(d, lanes));
}
#else
template <class V, class M>
HWY_INLINE V compress(V v, M mask) {
  return hn::Compress(v, mask);
}
#endif

using Heights = hn::ScalableTag<std::uint16_t>;
using Labels = hn::ScalableTag<std::int32_t>;

/// Writes the bits of a mask at the position of pixel x.
template <class D, class M>
HWY_INLINE void put_bits(D d, M mask, Word* words, int x) {
  static_assert(hn::MaxLanes(D()) % 8 == 0);
  hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(words) + x / 8);
}

void compare(const std::uint16_t* HWY_RESTRICT above, const std::uint16_t* HWY_RESTRICT here,
             const std::uint16_t* HWY_RESTRICT below, int words, const Slopes& slopes) {
  const Heights d;
  const Slopes to = slopes;
  const auto step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < words * kWordBits; x += step) {
    const auto centre = hn::LoadU(d, here + x);
    const auto up = hn::LoadU(d, above + x);
    const auto left = hn::LoadU(d, here + x - 1);
    const auto right = hn::LoadU(d, here + x + 1);
    const auto down = hn::LoadU(d, below + x);
    const auto lowest = hn::Min(hn::Min(up, left), hn::Min(right, down));
    const auto stays = hn::Eq(hn::Min(lowest, centre), centre);
    const auto not_up = hn::Or(stays, hn::Ne(up, lowest));
    const auto not_left = hn::Ne(left, lowest);
    const auto not_right = hn::Ne(right, lowest);
    const auto past_left = hn::And(not_up, not_left);
    put_bits(d, hn::Not(not_up), to.up, x);
    put_bits(d, hn::AndNot(stays, hn::AndNot(not_left, not_up)), to.left, x);
    put_bits(d, hn::AndNot(stays, hn::AndNot(not_right, past_left)), to.right, x);
    put_bits(d, hn::AndNot(stays, hn::And(past_left, not_right)), to.down, x);
    put_bits(d, hn::Eq(centre, right), to.equal_right, x);
    put_bits(d, hn::Eq(centre, down), to.equal_below, x);
  }
}

void count_up(const Word* HWY_RESTRICT bits, int width, std::int32_t first, RegionId* HWY_RESTRICT out) {
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  auto* const to = reinterpret_cast<std::int32_t*>(out);
  std::int32_t before = first - 1;
  for (int x = 0; x < width; x += 8) {
    const std::uint8_t* const counts =
        plain_labels::kBitCounts[(bits[x / kWordBits] >> (x % kWordBits)) & 0xFFU].data();
    const auto base = hn::Set(d, before);
    for (std::size_t i = 0; i < 8; i += hn::Lanes(d)) {
      hn::StoreU(hn::Add(base, hn::PromoteTo(d, hn::LoadU(d8, counts + i))), d, to + x + i);
    }
    before += counts[7];
  }
}

int find_runs(const RegionId* label, const RegionId* other, int width, std::int32_t* HWY_RESTRICT ends) {
  const Labels d;
  const auto step = static_cast<int>(hn::Lanes(d));
  const auto* const p = reinterpret_cast<const std::int32_t*>(label);
  const auto* const q = reinterpret_cast<const std::int32_t*>(other);
  const auto steps = hn::Set(d, step);
  auto next = hn::Iota(d, 1);
  int runs = 0;
  int x = 0;
  for (; x + step < width; x += step) {
    const auto changes = hn::Or(hn::Ne(hn::LoadU(d, p + x), hn::LoadU(d, p + x + 1)),
                                hn::Ne(hn::LoadU(d, q + x), hn::LoadU(d, q + x + 1)));
    hn::StoreU(compress(next, changes), d, ends + runs);
    runs += static_cast<int>(hn::CountTrue(d, changes));
    next = hn::Add(next, steps);
  }
  return plain_labels::find_runs_from(x, runs, label, other, width, ends);
}

/// Appends the pairs of `found`; returns the new number of pairs.
template <class D, class M>
HWY_INLINE int put_pairs(D d, hn::Vec<D> p, hn::Vec<D> q, M found, LabelPairs pairs, int count) {
  hn::StoreU(compress(hn::Min(p, q), found), d, pairs.a + count);
  hn::StoreU(compress(hn::Max(p, q), found), d, pairs.b + count);
  return count + static_cast<int>(hn::CountTrue(d, found));
}

int differing(const RegionId* row, const RegionId* other, int width, std::int32_t* HWY_RESTRICT pixels,
              LabelPairs pairs) {
  const Labels d;
  const auto step = static_cast<int>(hn::Lanes(d));
  const auto* const p = reinterpret_cast<const std::int32_t*>(row);
  const auto* const q = reinterpret_cast<const std::int32_t*>(other);
  const auto steps = hn::Set(d, step);
  auto here = hn::Iota(d, 0);
  int count = 0;
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto label = hn::LoadU(d, p + x);
    const auto beside = hn::LoadU(d, q + x);
    const auto differ = hn::Ne(label, beside);
    hn::StoreU(compress(here, differ), d, pixels + count);
    count = put_pairs(d, label, beside, differ, pairs, count);
    here = hn::Add(here, steps);
  }
  return plain_labels::differing_from(x, count, row, other, width, pixels, pairs);
}

int past_crest(const ThreeRows<RegionId>& labels, const ThreeRows<std::uint16_t>& edges, int width,
               std::int32_t* HWY_RESTRICT pixels) {
  const Labels d;
  const hn::Rebind<std::uint16_t, Labels> d16;
  const auto step = static_cast<int>(hn::Lanes(d));
  const auto steps = hn::Set(d, step);
  auto here = hn::Iota(d, 1);
  int count = plain_labels::past_crest_from(0, 1, 0, labels, edges, width, pixels);
  int x = 1;
  for (; x + step < width; x += step) {
    const auto label_at = [&](const RegionId* row, int at) {
      return hn::LoadU(d, reinterpret_cast<const std::int32_t*>(row) + at);
    };
    const auto edge_at = [&](const std::uint16_t* row, int at) {
      return hn::PromoteTo(d, hn::LoadU(d16, row + at));
    };
    const auto label = label_at(labels.here, x);
    const auto edge = edge_at(edges.here, x);
    const auto is_past = [&](auto first_label, auto second_label, auto first_edge, auto second_edge) {
      const auto first_is_same = hn::Eq(first_label, label);
      const auto behind = hn::IfThenElse(first_is_same, first_edge, second_edge);
      const auto ahead = hn::IfThenElse(first_is_same, second_edge, first_edge);
      return hn::And(hn::Xor(first_is_same, hn::Eq(second_label, label)),
                     hn::Gt(behind, hn::Max(edge, ahead)));
    };
    const auto vertically = is_past(label_at(labels.above, x), label_at(labels.below, x),
                                    edge_at(edges.above, x), edge_at(edges.below, x));
    const auto across = is_past(label_at(labels.here, x - 1), label_at(labels.here, x + 1),
                                edge_at(edges.here, x - 1), edge_at(edges.here, x + 1));
    const auto found = hn::Or(vertically, across);
    hn::StoreU(compress(here, found), d, pixels + count);
    count += static_cast<int>(hn::CountTrue(d, found));
    here = hn::Add(here, steps);
  }
  return plain_labels::past_crest_from(x, width, count, labels, edges, width, pixels);
}

int touches_right(const RegionId* HWY_RESTRICT above, const RegionId* HWY_RESTRICT row, int width,
                  LabelPairs pairs) {
  const Labels d;
  const auto step = static_cast<int>(hn::Lanes(d));
  const auto* const higher = reinterpret_cast<const std::int32_t*>(above);
  const auto* const here = reinterpret_cast<const std::int32_t*>(row);
  int x = std::min(2, width);
  int count = plain_labels::touches_right_in(1, x, 0, above, row, width, pairs);
  for (; x + step < width; x += step) {
    const auto p = hn::LoadU(d, here + x - 1);
    const auto q = hn::LoadU(d, here + x);
    const auto before = hn::LoadU(d, higher + x - 1);
    const auto at = hn::LoadU(d, higher + x);
    const auto straight = hn::And(hn::Eq(before, p), hn::Eq(at, q));
    const auto from_left = hn::And(hn::Eq(hn::LoadU(d, higher + x - 2), p), hn::Eq(before, q));
    const auto from_right = hn::And(hn::Eq(at, p), hn::Eq(hn::LoadU(d, higher + x + 1), q));
    const auto known = hn::Or(straight, hn::Or(from_left, from_right));
    count = put_pairs(d, p, q, hn::AndNot(known, hn::Ne(p, q)), pairs, count);
  }
  return plain_labels::touches_right_in(x, width, count, above, row, width, pairs);
}

int touches_below(const RegionId* HWY_RESTRICT above, const RegionId* HWY_RESTRICT row, int width,
                  LabelPairs pairs) {
  const Labels d;
  const auto step = static_cast<int>(hn::Lanes(d));
  const auto* const higher = reinterpret_cast<const std::int32_t*>(above);
  const auto* const here = reinterpret_cast<const std::int32_t*>(row);
  int x = std::min(1, width);
  int count = plain_labels::touches_below_in(0, x, 0, above, row, width, pairs);
  for (; x + step < width; x += step) {
    const auto p = hn::LoadU(d, higher + x);
    const auto q = hn::LoadU(d, here + x);
    const auto p_left = hn::LoadU(d, higher + x - 1);
    const auto q_left = hn::LoadU(d, here + x - 1);
    const auto same = hn::And(hn::Eq(p_left, p), hn::Eq(q_left, q));
    const auto left = hn::Or(hn::Eq(p_left, q), hn::Eq(q_left, p));
    const auto right = hn::Or(hn::Eq(hn::LoadU(d, higher + x + 1), q), hn::Eq(hn::LoadU(d, here + x + 1), p));
    const auto known = hn::Or(same, hn::Or(left, right));
    count = put_pairs(d, p, q, hn::AndNot(known, hn::Ne(p, q)), pairs, count);
  }
  return plain_labels::touches_below_in(x, width, count, above, row, width, pairs);
}

using Sums = hn::ScalableTag<std::int64_t>;
using SumsVec = hn::Vec<Sums>;

/// Moves the lanes `step` up and fills with zeros.
HWY_INLINE SumsVec slid_up(Sums d, SumsVec v, std::size_t step) {
  HWY_ALIGN std::int64_t from[hn::MaxLanes(Sums())];
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) from[i] = static_cast<std::int64_t>(i < step ? i : i - step);
  return hn::IfThenZeroElse(hn::FirstN(d, step), hn::TableLookupLanes(v, hn::SetTableIndices(d, from)));
}

/// The prefix sums of the lanes, plus `before`.
HWY_INLINE SumsVec running_sums(Sums d, SumsVec v, SumsVec before) {
  for (std::size_t step = 1; step < hn::Lanes(d); step *= 2) v = hn::Add(v, slid_up(d, v, step));
  return hn::Add(v, before);
}

HWY_INLINE SumsVec last_lane(Sums d, SumsVec v) {
  HWY_ALIGN std::int64_t from[hn::MaxLanes(Sums())];
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) from[i] = static_cast<std::int64_t>(hn::Lanes(d)) - 1;
  return hn::TableLookupLanes(v, hn::SetTableIndices(d, from));
}

void sum_grey(const Gray* HWY_RESTRICT values, int width, std::uint64_t* HWY_RESTRICT up_to) {
  const Sums d;
  const hn::Rebind<std::int32_t, Sums> d32;
  const hn::Rebind<std::uint8_t, Sums> d8;
  auto* const to = reinterpret_cast<std::int64_t*>(up_to);
  const auto step = static_cast<int>(hn::Lanes(d));
  to[0] = 0;
  auto before = hn::Zero(d);
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto v = hn::PromoteTo(d32, hn::LoadU(d8, values + x));
    const auto sum = hn::ShiftLeft<40>(hn::PromoteTo(d, v));
    const auto sums = running_sums(d, hn::Add(sum, hn::PromoteTo(d, hn::Mul(v, v))), before);
    hn::StoreU(sums, d, to + x + 1);
    before = last_lane(d, sums);
  }
  plain_labels::sum_grey_from(x, values, width, up_to);
}

void sum_disparities(const std::int16_t* HWY_RESTRICT values, const std::uint8_t* HWY_RESTRICT floor,
                     int width, std::uint64_t* HWY_RESTRICT up_to,
                     std::uint64_t* HWY_RESTRICT squares_up_to) {
  const Sums d;
  const hn::Rebind<std::int32_t, Sums> d32;
  const hn::Rebind<std::int16_t, Sums> d16;
  const hn::Rebind<std::uint8_t, Sums> d8;
  auto* const to = reinterpret_cast<std::int64_t*>(up_to);
  auto* const squares_to = reinterpret_cast<std::int64_t*>(squares_up_to);
  const auto step = static_cast<int>(hn::Lanes(d));
  to[0] = 0;
  squares_to[0] = 0;
  auto before = hn::Zero(d);
  auto squares_before = hn::Zero(d);
  int x = 0;
  for (; x + step <= width; x += step) {
    const auto given = hn::PromoteTo(d32, hn::LoadU(d16, values + x));
    const auto valid = hn::Ne(given, hn::Set(d32, kHole16));
    const auto v = hn::IfThenElseZero(valid, given);
    auto counts = hn::IfThenElseZero(valid, hn::Set(d32, 1 << 16));
    if (floor != nullptr) {
      const auto on_floor = hn::Ne(hn::PromoteTo(d32, hn::LoadU(d8, floor + x)), hn::Zero(d32));
      counts = hn::Or(counts, hn::IfThenElseZero(on_floor, hn::Set(d32, 1)));
    }
    const auto packed = hn::Add(hn::ShiftLeft<32>(hn::PromoteTo(d, v)), hn::PromoteTo(d, counts));
    const auto sums = running_sums(d, packed, before);
    const auto squares = running_sums(d, hn::PromoteTo(d, hn::Mul(v, v)), squares_before);
    hn::StoreU(sums, d, to + x + 1);
    hn::StoreU(squares, d, squares_to + x + 1);
    before = last_lane(d, sums);
    squares_before = last_lane(d, squares);
  }
  plain_labels::sum_disparities_from(x, values, floor, width, up_to, squares_up_to);
}

void sum_colours(const Rgb* HWY_RESTRICT colours, int width, std::uint64_t* HWY_RESTRICT up_to) {
  const Sums d;
  const hn::Rebind<std::int32_t, Sums> d32;
  const hn::Rebind<std::uint8_t, Sums> d8;
  const auto wide = [&](auto channel) { return hn::PromoteTo(d, hn::PromoteTo(d32, channel)); };
  auto* const to = reinterpret_cast<std::int64_t*>(up_to);
  const auto step = static_cast<int>(hn::Lanes(d));
  to[0] = 0;
  auto before = hn::Zero(d);
  int x = 0;
  for (; x + step <= width; x += step) {
    hn::Vec<decltype(d8)> r, g, b;
    hn::LoadInterleaved3(d8, reinterpret_cast<const std::uint8_t*>(colours + x), r, g, b);
    const auto packed = hn::Or(wide(r), hn::Or(hn::ShiftLeft<21>(wide(g)), hn::ShiftLeft<42>(wide(b))));
    const auto sums = running_sums(d, packed, before);
    hn::StoreU(sums, d, to + x + 1);
    before = last_lane(d, sums);
  }
  plain_labels::sum_colours_from(x, colours, width, up_to);
}

using Floats = hn::ScalableTag<float>;

int keep_known(const float* row, const float* by, int first, int last, float* HWY_RESTRICT kept) {
  const Floats d;
  const auto step = static_cast<int>(hn::Lanes(d));
  if (last < step) return plain_labels::keep_known(row, by, first, last, kept);
  int count = 0;
  const auto keep = [&](auto values, auto mask) {
    hn::StoreU(compress(values, mask), d, kept + count);
    count += static_cast<int>(hn::CountTrue(d, mask));
  };
  int x = first;
  for (; x + step <= last; x += step) {
    const auto known = hn::LoadU(d, by + x);
    keep(hn::LoadU(d, row + x), hn::Eq(known, known));
  }
  if (x == last) return count;
  // The last vector overlaps the one before.
  const auto known = hn::LoadU(d, by + last - step);
  const auto is_before = hn::FirstN(d, static_cast<std::size_t>(step - (last - x)));
  keep(hn::LoadU(d, row + last - step), hn::AndNot(is_before, hn::Eq(known, known)));
  return count;
}

FloatRange find_range(const float* HWY_RESTRICT values, std::size_t count) {
  const Floats d;
  const std::size_t step = hn::Lanes(d);
  if (count < step) return plain_labels::find_range(values, count);
  auto least = hn::LoadU(d, values + count - step);  // the last vector first: covers the remainder
  auto most = least;
  for (std::size_t i = 0; i + step <= count; i += step) {
    const auto v = hn::LoadU(d, values + i);
    least = hn::Min(least, v);
    most = hn::Max(most, v);
  }
  return {hn::GetLane(hn::MinOfLanes(d, least)), hn::GetLane(hn::MaxOfLanes(d, most))};
}

/// buckets.bucket() for several values.
template <class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> bucket(D d, hn::Vec<D> values, const Buckets& buckets) {
  const hn::RebindToSigned<D> di;
  const auto above = hn::Sub(values, hn::Set(d, buckets.least));
  const auto number = hn::ConvertTo(di, hn::Mul(above, hn::Set(d, buckets.scale)));
  return hn::Min(number, hn::Set(di, buckets.last));
}

std::size_t keep_bucket(const float* HWY_RESTRICT values, std::size_t count, const Buckets& given,
                        std::int32_t wanted, float* HWY_RESTRICT kept) {
  const Floats d;
  const Buckets buckets = given;
  const auto the_wanted = hn::Set(hn::RebindToSigned<Floats>(), wanted);
  std::size_t found = 0;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    const auto v = hn::LoadU(d, values + i);
    const auto counts = hn::RebindMask(d, hn::Eq(bucket(d, v, buckets), the_wanted));
    if (hn::AllFalse(d, counts)) continue;  // often: there are many buckets
    hn::StoreU(compress(v, counts), d, kept + found);
    found += hn::CountTrue(d, counts);
  }
  return found + plain_labels::keep_bucket(values + i, count - i, buckets, wanted, kept + found);
}

void number_buckets(const float* HWY_RESTRICT values, std::size_t count, const Buckets& given,
                    std::int32_t* HWY_RESTRICT numbers) {
  const Floats d;
  const Buckets buckets = given;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d))
    hn::StoreU(bucket(d, hn::LoadU(d, values + i), buckets), hn::RebindToSigned<Floats>(), numbers + i);
  plain_labels::number_buckets(values + i, count - i, buckets, numbers + i);
}

std::size_t find_marked(const std::uint8_t* HWY_RESTRICT marks, std::size_t count,
                        std::uint32_t* HWY_RESTRICT found) {
  const hn::ScalableTag<std::uint32_t> d;
  const hn::Rebind<std::uint8_t, decltype(d)> d8;
  auto here = hn::Iota(d, 0);
  std::size_t count_found = 0;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= count; i += hn::Lanes(d)) {
    const auto marked = hn::Ne(hn::PromoteTo(d, hn::LoadU(d8, marks + i)), hn::Zero(d));
    hn::StoreU(compress(here, marked), d, found + count_found);
    count_found += hn::CountTrue(d, marked);
    here = hn::Add(here, hn::Set(d, static_cast<std::uint32_t>(hn::Lanes(d))));
  }
  return plain_labels::find_marked_from(i, count_found, marks, count, found);
}

constexpr LabelKernels kLabelKernels{compare,       count_up,      find_runs,   differing,       past_crest,
                                     touches_right, touches_below, sum_grey,    sum_disparities, sum_colours,
                                     keep_known,    find_range,    keep_bucket, number_buckets,  find_marked};

}  // namespace
}  // namespace cairn::kernels::HWY_NAMESPACE
