// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <functional>
#include <random>
#include <string>
#include <vector>

/// The search by which programs choose numbers on the fit set: one option after the other.
namespace cairn::report {

struct Knob {
  std::string option;
  std::vector<std::string> values;  // those tried
};

/// One value per knob, in their order.
using Values = std::vector<std::string>;

struct KnobSearch {
  int rounds = 3;  // at most
  std::function<double(const Values&)> score;
  /// Called after each setting tried, before the next; `knob` is the one that differs.
  std::function<void(std::size_t knob, const Values& tried, double score, bool kept)> tried;
};

/// One of each knob's values at random.
inline Values drawn(const std::vector<Knob>& knobs, std::mt19937& random) {
  Values values;
  for (const Knob& knob : knobs) values.push_back(knob.values[random() % knob.values.size()]);
  return values;
}

/// From `start` each knob takes each of its values in turn; one that scores higher is kept at once, so ties
/// keep what was there. Ends after a round without a gain. The same scores give the same values.
inline Values search_knobs(const std::vector<Knob>& knobs, const Values& start, const KnobSearch& search) {
  Values best = start;
  double highest = search.score(best);
  for (int round = 0; round < search.rounds; ++round) {
    bool changed = false;
    for (std::size_t k = 0; k < knobs.size(); ++k) {
      for (const std::string& value : knobs[k].values) {
        if (value == best[k]) continue;
        Values candidate = best;
        candidate[k] = value;
        const double score = search.score(candidate);
        const bool kept = score > highest;
        search.tried(k, candidate, score, kept);
        if (!kept) continue;
        best = candidate;
        highest = score;
        changed = true;
      }
    }
    if (!changed) break;
  }
  return best;
}

}  // namespace cairn::report
