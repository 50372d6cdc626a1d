// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/grouping/choose_objects.hpp>
#include <cairn/grouping/superpixels.hpp>

#include "warp.hpp"

namespace cairn {

enum class RepairMethod : std::uint8_t { off, objects };
inline constexpr std::array kRepairMethods{Choice{"off", RepairMethod::off},
                                           Choice{"objects", RepairMethod::objects}};

/// How what was seen before helps to choose objects now.
struct RepairConfig {
  RepairMethod method = RepairMethod::objects;
  float weight = 0.5F;
};
template <class V>
void fields(RepairConfig& c, V&& v) {
  v("method", c.method, "", "whether tracks help to choose objects", kRepairMethods,
    when("fusion.method", "hierarchy"));
  v("weight", c.weight, "", "of what a track says of a region, against what this frame's picture says",
    range(0.0F, 1.0F), unless("repair.method", "off"));
}

/// How likely each node of the tree is a whole object, by this frame (`scores`) and by what the tracks were
/// like: where a share t of it is expected to show tracks, weighted by their confidence,
///
///     (1 − λ)·score + λ·confidence of the track that it fits best·fit,   λ = weight·t
///
/// and fit is 0 up to an IoU with the track's predicted mask of 0.3, 1 from 0.8 on. So a region that is but a
/// part of a known thing, or more than it, loses, and the thing itself is found again where the picture
/// leaves doubt; but only among the regions that this frame's picture has, and what it denies for long
/// loses its track's confidence as well. (docs/stages/tracking.md, beyond the paper)
std::vector<float> repaired_scores(const MergeTree& tree, std::vector<float> scores,
                                   const Superpixels& superpixels, const Warped& warped, const Tracks& tracks,
                                   const RepairConfig& config);

/// Objects, and what may be some: regions outside of theirs that are at least `low_confidence` likely, behind
/// them. Tracks look at both.
ChosenObjects choose_candidates(const MergeTree& tree, const std::vector<float>& scores,
                                const ChoiceLimits& limits, float low_confidence);

}  // namespace cairn
