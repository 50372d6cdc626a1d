// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

// The order of the includes is that of the stages.
// clang-format off

/// The library, stage by stage, in the order in which data flows.
#include <cairn/core/error.hpp>
#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/stereo/epipolar_correction.hpp>  // correct_epipolar
#include <cairn/stereo/match.hpp>              // match_windows
#include <cairn/stereo/semi_global.hpp>        // match, match_semi_global
#include <cairn/stereo/subpixel.hpp>           // refine_subpixel
#include <cairn/stereo/left_right.hpp>        // reject_inconsistent
#include <cairn/stereo/uniqueness.hpp>        // reject_ambiguous
#include <cairn/stereo/flatness.hpp>          // reject_flat
#include <cairn/stereo/texture.hpp>           // reject_textureless
#include <cairn/stereo/disparity_map.hpp>     // combine, external_disparity
#include <cairn/image/noise.hpp>                 // noise_sigma
#include <cairn/regions/textured.hpp>          // select_textured
#include <cairn/scene/ground_plane.hpp>      // fit_ground, reject_below_ground, label_floor
#include <cairn/scene/floor_frame.hpp>       // floor_frame
#include <cairn/stereo/speckle.hpp>           // reject_speckles
#include <cairn/stereo/confidence.hpp>        // estimate_confidence
#include <cairn/scene/background.hpp>        // fit_background
#include <cairn/image/gradient.hpp>            // gradient, edge_strength
#include <cairn/stereo/gradient.hpp>        // quantised, gradient
#include <cairn/regions/watershed.hpp>           // watershed
#include <cairn/regions/region_graph.hpp>        // build_graph, apply_merges
#include <cairn/regions/grow_statistical.hpp>    // grow_statistical
#include <cairn/regions/grow_near_to_far.hpp>    // grow_near_to_far
#include <cairn/regions/segment_intensity.hpp>   // segment_intensity
#include <cairn/regions/segment_disparity.hpp>   // segment_disparity
#include <cairn/regions/superpixels.hpp>       // cut_superpixels
#include <cairn/regions/object_hints.hpp>      // hint_objects
#include <cairn/regions/merge_tree.hpp>        // grow_merge_tree
#include <cairn/regions/choose_objects.hpp>    // choose_objects, object_regions
#include <cairn/regions/refine_disparity.hpp>  // refine_disparity, likely_disparities
#include <cairn/objects/fuse.hpp>                // fuse
#include <cairn/objects/measure.hpp>             // measure
#include <cairn/objects/locate.hpp>              // locate
#include <cairn/objects/refine_objects.hpp>      // refine_objects
#include <cairn/objects/floor_probability.hpp>       // floor_probability
#include <cairn/objects/obstacles.hpp>               // label_obstacles
#include <cairn/objects/ground_steps.hpp>            // GroundStep
#include <cairn/objects/sky.hpp>                     // reject_sky
#include <cairn/pipeline/config.hpp>             // Config, presets, options
#include <cairn/pipeline/segment.hpp>            // segment: all of the above
#include <cairn/pipeline/segmenter.hpp>          // Segmenter: the same for video
#include <cairn/diagnosis/diagnose.hpp>          // measure_pair, diagnose: what is wrong with a rig
#include <cairn/diagnosis/given_disparity.hpp>   // Given disparities, compared with the pair
#include <cairn/diagnosis/rig_watch.hpp>         // RigWatch: the findings of a run
#include <cairn/diagnosis/synchrony.hpp>         // measure_synchrony
