// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/track_error.hpp>

#include <dlib/optimization/max_cost_assignment.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace cairn {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kMatched = 0.5;
constexpr std::size_t kThresholds = 19;  // .05, .1, … .95

constexpr double threshold(std::size_t i) {
  return 0.05 * static_cast<double>(i + 1);
}

struct Grid {
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::vector<double> values;

  Grid(std::size_t rows_, std::size_t columns_)
      : rows(rows_), columns(columns_), values(rows_ * columns_, 0.0) {}
  double& operator()(std::size_t row, std::size_t column) { return values[row * columns + column]; }
  double operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// The assignment of columns to rows with the greatest sum, −1 = none. Scores ≥ 0.
std::vector<int> best_assignment(const Grid& scores) {
  const std::size_t side = std::max(scores.rows, scores.columns);
  std::vector<int> columns(scores.rows, -1);
  if (scores.rows == 0 || scores.columns == 0) return columns;
  // dlib sums integers. With 2^46 steps up to the greatest score, differences of 1e-13 still count, and the
  // sum of two cannot overflow.
  const double greatest = *std::max_element(scores.values.begin(), scores.values.end());
  if (greatest <= 0) return columns;
  const double steps = std::ldexp(1.0, 46) / greatest;
  const auto n = static_cast<long>(side);
  dlib::matrix<std::int64_t> costs(n, n);
  costs = 0;
  for (std::size_t row = 0; row < scores.rows; ++row) {
    for (std::size_t column = 0; column < scores.columns; ++column)
      costs(static_cast<long>(row), static_cast<long>(column)) = std::llround(scores(row, column) * steps);
  }
  const std::vector<long> chosen = dlib::max_cost_assignment(costs);
  for (std::size_t row = 0; row < scores.rows; ++row) {
    if (static_cast<std::size_t>(chosen[row]) < scores.columns) columns[row] = static_cast<int>(chosen[row]);
  }
  return columns;
}

/// All frames, with ids renumbered 0 … n − 1.
struct Sequence {
  std::vector<ScoredFrame> frames;
  std::vector<double> true_frames;  // number of frames of each id
  std::vector<double> our_frames;

  [[nodiscard]] std::size_t true_objects() const { return true_frames.size(); }
  [[nodiscard]] std::size_t our_objects() const { return our_frames.size(); }
};

std::vector<double> renumber(std::vector<ScoredFrame>& frames, std::vector<std::int64_t> ScoredFrame::*ids) {
  std::map<std::int64_t, std::size_t> numbers;
  for (const ScoredFrame& frame : frames) {
    for (const std::int64_t id : frame.*ids) numbers.emplace(id, 0);
  }
  std::size_t next = 0;
  for (auto& [id, number] : numbers) number = next++;
  std::vector<double> counts(numbers.size(), 0.0);
  for (ScoredFrame& frame : frames) {
    for (std::int64_t& id : frame.*ids) {
      const std::size_t number = numbers.at(id);
      counts[number] += 1;
      id = static_cast<std::int64_t>(number);
    }
  }
  return counts;
}

Sequence numbered(std::vector<ScoredFrame> frames) {
  Sequence sequence;
  sequence.frames = std::move(frames);
  sequence.true_frames = renumber(sequence.frames, &ScoredFrame::truth);
  sequence.our_frames = renumber(sequence.frames, &ScoredFrame::ours);
  return sequence;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Similarity of two ids over the whole sequence, before matching.
Grid alignment(const Sequence& sequence) {
  Grid common(sequence.true_objects(), sequence.our_objects());
  for (const ScoredFrame& frame : sequence.frames) {
    const std::size_t n = frame.truth.size();
    const std::size_t m = frame.ours.size();
    std::vector<double> of_truth(n, 0.0);
    std::vector<double> of_ours(m, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < m; ++j) {
        of_truth[i] += frame.at(i, j);
        of_ours[j] += frame.at(i, j);
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < m; ++j) {
        const double all = of_truth[i] + of_ours[j] - frame.at(i, j);
        if (all <= kEpsilon) continue;
        common(static_cast<std::size_t>(frame.truth[i]), static_cast<std::size_t>(frame.ours[j])) +=
            frame.at(i, j) / all;
      }
    }
  }
  for (std::size_t t = 0; t < common.rows; ++t) {
    for (std::size_t o = 0; o < common.columns; ++o)
      common(t, o) /= sequence.true_frames[t] + sequence.our_frames[o] - common(t, o);
  }
  return common;
}

void score_hota(const Sequence& sequence, TrackErrors& errors) {
  const double true_count = sum_of(sequence.true_frames);
  const double our_count = sum_of(sequence.our_frames);
  if (true_count == 0 || our_count == 0) {
    errors.loc_a = 1;  // as TrackEval defines it
    return;
  }
  const Grid aligned = alignment(sequence);
  std::array<double, kThresholds> right{};
  std::array<double, kThresholds> similarity{};
  std::vector<Grid> matches(kThresholds, Grid(sequence.true_objects(), sequence.our_objects()));
  for (const ScoredFrame& frame : sequence.frames) {
    Grid scores(frame.truth.size(), frame.ours.size());
    for (std::size_t i = 0; i < scores.rows; ++i) {
      for (std::size_t j = 0; j < scores.columns; ++j) {
        scores(i, j) = frame.at(i, j) * aligned(static_cast<std::size_t>(frame.truth[i]),
                                                static_cast<std::size_t>(frame.ours[j]));
      }
    }
    const std::vector<int> chosen = best_assignment(scores);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] < 0) continue;
      const auto j = static_cast<std::size_t>(chosen[i]);
      for (std::size_t a = 0; a < kThresholds; ++a) {
        if (frame.at(i, j) < threshold(a) - kEpsilon) continue;
        right[a] += 1;
        similarity[a] += frame.at(i, j);
        matches[a](static_cast<std::size_t>(frame.truth[i]), static_cast<std::size_t>(frame.ours[j])) += 1;
      }
    }
  }
  constexpr double kMin = 1e-10;
  for (std::size_t a = 0; a < kThresholds; ++a) {
    double ass_a = 0;
    double ass_re = 0;
    double ass_pr = 0;
    for (std::size_t t = 0; t < sequence.true_objects(); ++t) {
      for (std::size_t o = 0; o < sequence.our_objects(); ++o) {
        const double n = matches[a](t, o);
        ass_a += n * n / std::max(1.0, sequence.true_frames[t] + sequence.our_frames[o] - n);
        ass_re += n * n / std::max(1.0, sequence.true_frames[t]);
        ass_pr += n * n / std::max(1.0, sequence.our_frames[o]);
      }
    }
    const double found = std::max(1.0, right[a]);
    const double det_a = right[a] / std::max(1.0, true_count + our_count - right[a]);
    errors.det_a += det_a / kThresholds;
    errors.det_re += right[a] / std::max(1.0, true_count) / kThresholds;
    errors.det_pr += right[a] / std::max(1.0, our_count) / kThresholds;
    errors.ass_a += ass_a / found / kThresholds;
    errors.ass_re += ass_re / found / kThresholds;
    errors.ass_pr += ass_pr / found / kThresholds;
    errors.loc_a += std::max(kMin, similarity[a]) / std::max(kMin, right[a]) / kThresholds;
    errors.hota += std::sqrt(det_a * ass_a / found) / kThresholds;
  }
}

std::vector<std::vector<int>> clear_matches(const Sequence& sequence) {
  constexpr double kKept = 1000;  // far above any sum of similarities, so earlier matches persist
  std::vector<std::int64_t> before(sequence.true_objects(), -1);
  std::vector<std::vector<int>> all;
  for (const ScoredFrame& frame : sequence.frames) {
    all.emplace_back(frame.truth.size(), -1);
    if (frame.truth.empty() || frame.ours.empty()) continue;  // as in TrackEval: `before` persists
    Grid scores(frame.truth.size(), frame.ours.size());
    for (std::size_t i = 0; i < scores.rows; ++i) {
      for (std::size_t j = 0; j < scores.columns; ++j) {
        if (frame.at(i, j) < kMatched - kEpsilon) continue;
        const bool kept = before[static_cast<std::size_t>(frame.truth[i])] == frame.ours[j];
        scores(i, j) = (kept ? kKept : 0) + frame.at(i, j);
      }
    }
    std::vector<int>& chosen = all.back();
    chosen = best_assignment(scores);
    std::fill(before.begin(), before.end(), -1);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (chosen[i] >= 0 && scores(i, static_cast<std::size_t>(chosen[i])) <= kEpsilon) chosen[i] = -1;
      if (chosen[i] < 0) continue;
      before[static_cast<std::size_t>(frame.truth[i])] = frame.ours[static_cast<std::size_t>(chosen[i])];
    }
  }
  return all;
}

void score_clear(const Sequence& sequence, TrackErrors& errors) {
  constexpr double kMostly = 0.8;
  constexpr double kHardly = 0.2;
  const std::vector<std::vector<int>> matches = clear_matches(sequence);
  std::vector<std::int64_t> last(sequence.true_objects(), -1);  // last id matched, ever
  std::vector<char> tracked(sequence.true_objects(), 0);        // in the previous frame
  std::vector<int> stretches(sequence.true_objects(), 0);
  std::vector<double> matched(sequence.true_objects(), 0.0);
  for (std::size_t k = 0; k < sequence.frames.size(); ++k) {
    const ScoredFrame& frame = sequence.frames[k];
    errors.missed += static_cast<int>(frame.truth.size());
    errors.wrong += static_cast<int>(frame.ours.size());
    if (frame.truth.empty() || frame.ours.empty()) continue;
    std::vector<char> now(sequence.true_objects(), 0);
    for (std::size_t i = 0; i < matches[k].size(); ++i) {
      if (matches[k][i] < 0) continue;
      const auto j = static_cast<std::size_t>(matches[k][i]);
      const auto t = static_cast<std::size_t>(frame.truth[i]);
      ++errors.right;
      --errors.missed;
      --errors.wrong;
      errors.motp += frame.at(i, j);
      errors.switches += last[t] >= 0 && last[t] != frame.ours[j] ? 1 : 0;
      last[t] = frame.ours[j];
      matched[t] += 1;
      stretches[t] += tracked[t] != 0 ? 0 : 1;
      now[t] = 1;
    }
    tracked = now;
  }
  const int true_count = errors.right + errors.missed;
  errors.motp /= std::max(1, errors.right);
  errors.mota = static_cast<double>(errors.right - errors.wrong - errors.switches) / std::max(1, true_count);
  for (std::size_t t = 0; t < sequence.true_objects(); ++t) {
    const double share = matched[t] / sequence.true_frames[t];
    errors.mostly_tracked += share > kMostly ? 1 : 0;
    errors.partly_tracked += share <= kMostly && share >= kHardly ? 1 : 0;
    errors.mostly_lost += share < kHardly ? 1 : 0;
    errors.fragments += std::max(0, stretches[t] - 1);
  }
  // As TrackEval does for a sequence without detections; here also for one without truth.
  if (true_count == 0 || sequence.our_objects() == 0) errors.mota = 0;
}

void score_identity(const Sequence& sequence, TrackErrors& errors) {
  Grid common(sequence.true_objects(), sequence.our_objects());
  for (const ScoredFrame& frame : sequence.frames) {
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      for (std::size_t j = 0; j < frame.ours.size(); ++j) {
        if (frame.at(i, j) < kMatched) continue;
        common(static_cast<std::size_t>(frame.truth[i]), static_cast<std::size_t>(frame.ours[j])) += 1;
      }
    }
  }
  // An unmatched pair costs all of its frames, a matched one those not in common, so the cheapest assignment
  // is the one with the most frames in common.
  const std::vector<int> chosen = best_assignment(common);
  double right = 0;
  for (std::size_t t = 0; t < chosen.size(); ++t) {
    if (chosen[t] >= 0) right += common(t, static_cast<std::size_t>(chosen[t]));
  }
  errors.id_right = static_cast<int>(right);
  errors.id_missed = static_cast<int>(sum_of(sequence.true_frames) - right);
  errors.id_wrong = static_cast<int>(sum_of(sequence.our_frames) - right);
  errors.id_recall = right / std::max(1, errors.id_right + errors.id_missed);
  errors.id_precision = right / std::max(1, errors.id_right + errors.id_wrong);
  errors.id_f1 = right / std::max(1.0, right + 0.5 * errors.id_wrong + 0.5 * errors.id_missed);
}

double best_similarity(const ScoredFrame& frame, std::size_t true_object) {
  double best = 0;
  for (std::size_t j = 0; j < frame.ours.size(); ++j) best = std::max(best, frame.at(true_object, j));
  return best;
}

}  // namespace

TrackErrors track_errors(const std::vector<ScoredFrame>& frames) {
  const Sequence sequence = numbered(frames);
  TrackErrors errors;
  score_hota(sequence, errors);
  score_clear(sequence, errors);
  score_identity(sequence, errors);
  return errors;
}

std::vector<std::vector<int>> clear_matches(const std::vector<ScoredFrame>& frames) {
  return clear_matches(numbered(frames));
}

std::vector<ScoredFrame> oracle_ids(std::vector<ScoredFrame> frames) {
  std::int64_t own = -1;
  for (ScoredFrame& frame : frames) {
    const std::size_t m = frame.ours.size();
    std::vector<int> best(m, -1);
    for (std::size_t j = 0; j < m; ++j) {
      double most = 0;
      for (std::size_t i = 0; i < frame.truth.size(); ++i) {
        if (frame.at(i, j) <= most) continue;
        most = frame.at(i, j);
        best[j] = static_cast<int>(i);
      }
    }
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      int keeper = -1;
      for (std::size_t j = 0; j < m; ++j) {
        if (best[j] != static_cast<int>(i)) continue;
        if (keeper >= 0 && frame.at(i, j) <= frame.at(i, static_cast<std::size_t>(keeper))) {
          best[j] = -1;
          continue;
        }
        if (keeper >= 0) best[static_cast<std::size_t>(keeper)] = -1;
        keeper = static_cast<int>(j);
      }
    }
    for (std::size_t j = 0; j < m; ++j)
      frame.ours[j] = best[j] >= 0 ? frame.truth[static_cast<std::size_t>(best[j])] : own--;
  }
  return frames;
}

ScoredFrame scored_frame(View<const TrackId> ours, View<const TruthId> truth, const ScoredFrameRules& rules) {
  assert(ours.size() == truth.size());
  std::map<TruthId, int> true_area;
  std::map<TrackId, int> our_area;          // excluding don't-care pixels
  std::map<TrackId, int> our_on_dont_care;  // don't-care pixels only
  std::map<std::pair<TruthId, TrackId>, int> common;
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) {
      const TruthId t = truth(x, y);
      const TrackId o = ours(x, y);
      if (t == TruthId::dont_care) {
        if (o != TrackId::none) ++our_on_dont_care[o];
        continue;
      }
      if (t != TruthId::none) ++true_area[t];
      if (o == TrackId::none) continue;
      ++our_area[o];
      ++common[{t, o}];
    }
  }
  for (const auto& [o, area] : our_on_dont_care) our_area.emplace(o, 0);

  ScoredFrame frame;
  for (const auto& [t, area] : true_area) {
    if (area >= rules.min_area) frame.truth.push_back(number(t));
  }
  const auto common_of = [&](TruthId t, TrackId o) {
    const auto found = common.find({t, o});
    return found == common.end() ? 0 : found->second;
  };
  std::map<TrackId, int> unjudged = our_on_dont_care;
  for (const auto& [pair, area] : common) {
    const auto& [t, o] = pair;
    const bool is_small = t != TruthId::none && true_area.at(t) < rules.min_area;
    if (is_small || (t == TruthId::none && rules.partial)) unjudged[o] += area;
  }
  for (const auto& [o, area] : our_area) {
    const auto dont_care = our_on_dont_care.find(o);
    const int whole = area + (dont_care == our_on_dont_care.end() ? 0 : dont_care->second);
    const auto left_out = unjudged.find(o);
    if (left_out != unjudged.end() && 2 * left_out->second > whole) continue;
    frame.ours.push_back(number(o));
  }
  for (const std::int64_t t : frame.truth) {
    for (const std::int64_t o : frame.ours) {
      const auto true_id = static_cast<TruthId>(t);
      const auto our_id = static_cast<TrackId>(o);
      const int both = common_of(true_id, our_id);
      const int either = true_area.at(true_id) + our_area.at(our_id) - both;
      frame.similarity.push_back(static_cast<double>(both) / either);
    }
  }
  return frame;
}

Steadiness steadiness(const std::vector<ScoredFrame>& frames) {
  Steadiness sum;
  double differences = 0;
  struct ObjectHistory {
    double iou = 0;
    bool was_found = false;  // since it entered the view
    bool is_lost = false;
  };
  std::map<std::int64_t, ObjectHistory> before;
  for (const ScoredFrame& frame : frames) {
    std::map<std::int64_t, ObjectHistory> now;
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      const double iou = best_similarity(frame, i);
      const bool is_found = iou >= kMatched;
      ObjectHistory seen{iou, is_found, false};
      const auto earlier = before.find(frame.truth[i]);
      if (earlier != before.end()) {
        ++sum.pairs;
        differences += std::abs(iou - earlier->second.iou);
        sum.found_again += is_found && earlier->second.is_lost ? 1 : 0;
        seen.was_found = is_found || earlier->second.was_found;
        seen.is_lost = !is_found && earlier->second.was_found;
      }
      ++sum.object_frames;
      sum.found += is_found ? 1 : 0;
      now[frame.truth[i]] = seen;
    }
    before = std::move(now);
  }
  sum.iou_difference = sum.pairs > 0 ? differences / sum.pairs : std::numeric_limits<double>::quiet_NaN();
  return sum;
}

double squared_mahalanobis(Point3 error_m, const Covariance3& c) {
  // Cholesky decomposition; an indefinite matrix has no such distance.
  const double l00 = std::sqrt(c[0]);
  const double l10 = c[3] / l00;
  const double l20 = c[6] / l00;
  const double l11 = std::sqrt(c[4] - l10 * l10);
  const double l21 = (c[7] - l20 * l10) / l11;
  const double l22 = std::sqrt(c[8] - l20 * l20 - l21 * l21);
  const double x = error_m.x / l00;
  const double y = (error_m.y - l10 * x) / l11;
  const double z = (error_m.z - l20 * x - l21 * y) / l22;
  const double squared = x * x + y * y + z * z;
  return std::isfinite(squared) ? squared : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace cairn
