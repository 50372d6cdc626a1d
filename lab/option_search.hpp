// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <functional>
#include <random>
#include <string>
#include <vector>

/// Coordinate search for programs that choose parameters on the fit set.
namespace cairn::lab {

struct Knob {
  std::string option;
  std::vector<std::string> values;  // values to try
};

/// One value per knob, in order.
using Values = std::vector<std::string>;

struct KnobSearch {
  int rounds = 3;  // at most
  std::function<double(const Values&)> score;
  /// Called after each setting, before the next; `knob` is the one changed.
  std::function<void(std::size_t knob, const Values& tried, double score, bool kept)> tried;
};

/// A random value for each knob.
inline Values drawn(const std::vector<Knob>& knobs, std::mt19937& random) {
  Values values;
  for (const Knob& knob : knobs) values.push_back(knob.values[random() % knob.values.size()]);
  return values;
}

/// From `start`, each knob tries each of its values in turn; a higher score is kept at once, so ties keep the
/// earlier value. Ends after a round without improvement. Deterministic for deterministic scores.
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

}  // namespace cairn::lab
