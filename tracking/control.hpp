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

enum class ControlMethod : std::uint8_t { off, watch };
inline constexpr std::array kControlMethods{Choice{"off", ControlMethod::off},
                                            Choice{"watch", ControlMethod::watch}};

/// Whether other values of options are tried during a sequence.
struct ControlConfig {
  ControlMethod method = ControlMethod::off;
  int window = 10;       // frames
  int hold = 30;         // frames
  float budget = 0.25F;  // share of the frames
  float lead = 10;       // %
};
template <class V>
void fields(ControlConfig& c, V&& v) {
  const auto on = unless("control.method", "off");
  v("method", c.method, "", "whether steadier values of options are looked for and reported",
    kControlMethods);
  v("window", c.window, "frames", "on which two settings are compared at least", range(3, 1000), on);
  v("hold", c.hold, "frames", "between two reports at least", range(1, 10000), on);
  v("budget", c.budget, "", "share of frames that are segmented a second time", range(0.0F, 1.0F), on);
  v("lead", c.lead, "%", "by which a setting must be steadier to be better", range(0.0F, 100.0F), on);
}

/// One option's other value.
struct Arm {
  std::string option;
  std::string value;
  friend bool operator==(const Arm&, const Arm&) = default;
};

/// What may be tried beside `config`: `step` times the value of options that matter, and its `step`th part,
/// or the other choice. None that has no effect or lies out of its range. Always in the same order.
std::vector<Arm> arms_of(const Config& config, Size image, float step = 2);

/// The steadiness of an arm and of the present setting on the same frames. See steadiness().
struct ArmScore {
  Arm arm;
  std::vector<float> of_arm;
  std::vector<float> of_present;
};

/// By how much the arm is steadier, as a share of the present's mean: the mean, and its lower end at 95 %,
/// one-sided, of paired differences; −1 below two frames.
struct Lead {
  double mean = -1;
  double low = -1;
};
Lead lead_of(const ArmScore& score);

/// What a round of successive halving (Jamieson and Talwalkar 2016) leaves: at most half of the arms, those
/// that lead most, and none whose lead is less than half of `lead`. Ties: the earlier one.
std::vector<ArmScore> halved(std::vector<ArmScore> round, float lead_percent);

/// Whether the arm is to be reported: compared on `window` frames or more, its lead is at least `lead`, and
/// more than 0 for sure.
bool is_better(const ArmScore& score, const ControlConfig& config);

}  // namespace cairn
