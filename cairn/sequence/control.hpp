// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/pipeline/config.hpp>
#include <optional>
#include <string>
#include <vector>

namespace cairn {

enum class ControlMethod : std::uint8_t { off, watch, tune };
inline constexpr std::array kControlMethods{Choice{"off", ControlMethod::off},
                                            Choice{"watch", ControlMethod::watch},
                                            Choice{"tune", ControlMethod::tune}};

/// The trial of other option values during a sequence.
struct ControlConfig {
  ControlMethod method = ControlMethod::off;
  float budget = 0.25F;  // share of the frames
  // Constants, not options.
  int window = 10;      // frames; fewest to compare two settings on
  int cooldown = 30;    // frames; fewest between two reports or changes
  float min_gain = 10;  // %; smallest gain in steadiness of a value that is not the preset's
};
template <class V>
void fields(ControlConfig& c, V&& v) {
  v("method", c.method, "", "search for steadier option values: report (watch) or set (tune) them",
    kControlMethods);
  v("budget", c.budget, "", "share of frames segmented a second time", range(0.0F, 1.0F),
    unless("control.method", "off"));
}

/// Another value of one option.
struct OptionCandidate {
  std::string option;
  std::string value;
  bool restores = false;  // the preset's value, fitted on many scenes
  friend bool operator==(const OptionCandidate&, const OptionCandidate&) = default;
};

/// The value of a candidate's option in `config`.
std::string value_of(const Config& config, const std::string& option);

/// The alternatives to `config`: `step` times and 1/`step` times the value of relevant options, or the other
/// choice. Excludes values without effect or out of range. Always in the same order.
std::vector<OptionCandidate> option_candidates(const Config& config, Size image, float step = 2);

/// The values in `known` of the options that both read and that differ, as candidates that do not restore.
std::vector<OptionCandidate> differences(const Config& config, const Config& known);

/// Of these, the ones that may be set without asking the user, as restoring candidates. Omits knowledge of robot and
/// scene: `obstacles`, the origin of the floor, except off, and a disparity range that starts elsewhere or is
/// larger. A smaller range may be known as well, so the larger one does not count as restoring.
std::vector<OptionCandidate> restoring_candidates(const Config& config, const Config& known, Size image);

/// The preset with the fewest options that differ from those of `config`.
Config nearest_preset(const Config& config);

/// An option value that makes objects steadier.
struct ControlEvent {
  OptionCandidate candidate;
  bool is_set = false;  // from the next frame on, with ControlMethod::tune
  std::string before;   // the value of the option
  double gain = 0;      // share
};

/// The steadiness of a candidate and of the present setting on the same frames. See steadiness().
struct CandidateScore {
  OptionCandidate candidate;
  std::vector<float> of_candidate;
  std::vector<float> of_present;
};

/// The relative gain in steadiness of the candidate over the present setting: the mean, and its one-sided lower 95
/// % bound from paired differences; −1 below two frames.
struct CandidateGain {
  double mean = -1;
  double low = -1;
};
CandidateGain gain_of(const CandidateScore& score);

/// The survivors of a round of successive halving (Jamieson and Talwalkar 2016): at most half of the candidates,
/// those with the highest gain, and none without a gain or, unless it restores, with less than half of
/// `min_gain_percent`. Ties: the earlier one.
std::vector<CandidateScore> halved(std::vector<CandidateScore> round, float min_gain_percent);

/// Whether to report or set the candidate: compared on at least `window` frames, with a gain significantly above 0
/// and, unless it restores, of at least `min_gain`.
bool is_better(const CandidateScore& score, const ControlConfig& config);

}  // namespace cairn
