// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/object_hints.hpp>
#include <cstdint>
#include <span>
#include <vector>

/// The slow twins of hint_input(), from the table of its channels in docs/stages/object_hints.md, and of hint_objects(), from
/// the definition of a convolution.
namespace cairn::reference {

/// The parameters of a HintNetwork.
struct HintNumbers {
  std::vector<HintLayer> layers;
  std::vector<std::int8_t> weights;
  std::vector<std::int32_t> bias;
  std::vector<float> scale;
  [[nodiscard]] HintNetwork network() const { return {layers, weights, bias, scale}; }
};

/// `input`: as for hint_objects().
Image<ObjectHint> hint_objects(View<const std::int16_t> input, const HintNumbers& numbers);

Image<std::int16_t> hint_input(View<const std::uint16_t> edges, const Cues& cues);

}  // namespace cairn::reference
