// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/fields.hpp>
#include <cairn/regions/choose_objects.hpp>
#include <cairn/regions/superpixels.hpp>

#include <cairn/sequence/warp.hpp>

namespace cairn {

enum class RepairMethod : std::uint8_t { off, objects };
inline constexpr std::array kRepairMethods{Choice{"off", RepairMethod::off},
                                           Choice{"objects", RepairMethod::objects}};

/// The use of tracks for the choice of objects.
struct RepairConfig {
  RepairMethod method = RepairMethod::objects;
  float weight = 0.5F;  // a constant, not an option: of tracks against the scores of the frame
};
template <class V>
void fields(RepairConfig& c, V&& v) {
  v("method", c.method, "", "use of tracks in the choice of objects", kRepairMethods,
    when("pipeline.method", "region_tree"));
}

/// The probability of each node of the tree to be a whole object, from this frame (`scores`) and from the
/// tracks: for a region of which a share t is expected to show tracks, weighted by their confidence,
///
///     (1 − λ)·score + λ·(confidence of the best fitting track)·fit,   λ = weight·t
///
/// where fit is 0 up to an IoU of 0.3 with the predicted mask of the track, and 1 from 0.8 on. So a part of a
/// known object, or a region beyond it, loses, and the object itself is found again if the image is
/// ambiguous; but only among the regions of this frame, and a track that the image contradicts for long loses
/// its confidence. (docs/stages/tracking.md, beyond the paper)
std::vector<float> repaired_scores(const MergeTree& tree, std::vector<float> scores,
                                   const Superpixels& superpixels, const MaskPrediction& warped,
                                   const Tracks& tracks, const RepairConfig& config);

/// Objects, followed by candidates: regions outside of the objects with a probability of at least
/// `low_confidence`. Tracking uses both.
ChosenObjects choose_candidates(const MergeTree& tree, const std::vector<float>& scores,
                                const ChoiceLimits& limits, float low_confidence);

}  // namespace cairn
