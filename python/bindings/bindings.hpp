// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

#include <io/image_files.hpp>

namespace cairn::python {

// One file each, in the order in which the types need each other.
void bind_options(pybind11::module_& m);     // Option, Config, Exec
void bind_rig(pybind11::module_& m);         // Rig, Calibration
void bind_matching(pybind11::module_& m);    // correct_epipolar … refine_subpixel
void bind_disparity(pybind11::module_& m);   // the checks, combine, evidence, confidence
void bind_ground(pybind11::module_& m);      // floor and walls
void bind_regions(pybind11::module_& m);     // watershed … segment_disparity
void bind_grouping(pybind11::module_& m);    // cut_superpixels … groups_of
void bind_objects(pybind11::module_& m);     // fuse, measure
void bind_frame(pybind11::module_& m);       // segment, estimate_disparity, Segmenter
void bind_evaluation(pybind11::module_& m);  // comparison with truth
void bind_diagnosis(pybind11::module_& m);   // finding faults of a rig
void bind_tuning(pybind11::module_& m);      // search for the best options
void bind_io(pybind11::module_& m);          // files and images
void bind_follow(pybind11::module_& m);      // sequences

/// Colour if the file has it, else grey.
pybind11::object picture_array(io::Picture picture);

}  // namespace cairn::python
