// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/regions/choose_objects.hpp>
#include <cairn/regions/merge_tree.hpp>
#include <cairn/regions/region_cues.hpp>
#include <cairn/regions/superpixels.hpp>
#include <set>

/// The slow twins from superpixels to objects: all quantities are counted again from the pixels, by
/// exhaustive search. Only for small images.
namespace cairn::reference {

Superpixels cut_superpixels(View<const Gray> gray, View<const Rgb> rgb, View<const ObjectHint> hints,
                            View<const float> disparity_px, float noise_sigma, int count);

/// A region as a set of superpixels.
using Members = std::set<std::int32_t>;

RegionCues cues_of(const Members& members, const Superpixels& superpixels, const Cues& cues);
/// Cues of a over b; `length` is 0 if they do not touch. The cues' own a and b are 0.
ContactCues contact_of(const Members& a, const Members& b, const Superpixels& superpixels, const Cues& cues);
MergeTree grow_merge_tree(const Superpixels& superpixels, const Cues& cues, const FittedTrees& same_thing);
ChosenObjects choose_objects(const MergeTree& tree, const FittedTrees& whole_object,
                             const ChoiceLimits& limits);

}  // namespace cairn::reference
