// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/grouping/choose_objects.hpp>
#include <cairn/pipeline/segment.hpp>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "disparity.hpp"
#include "options.hpp"
#include "pickling.hpp"

namespace cairn::python {
namespace {

// ---- stages ----

Superpixels superpixels_of(const Config& config, const Exec& exec, const ImageArgument& left,
                           const DisparityArgument& disparity, float noise_sigma, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  const DisparityInput map(disparity, "disparity", exec);
  expect_size(map.size(), "disparity", in.size(), "left");
  expect_noise(noise_sigma);
  return released([&] {
    return cut_superpixels(in.gray(), in.rgb(), map.map().disparity_px, noise_sigma, config.superpixels,
                           exec);
  });
}

Segmentation as_segmentation(const Config&, const Exec& exec, const Superpixels& superpixels,
                             const ImageArgument& left, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  expect_size(in.size(), "left", superpixels.labels.size(), "superpixels");
  return released([&] { return segmentation_of(superpixels, in.gray(), exec); });
}

MergeTree tree_of(const Config&, const Exec& exec, const Superpixels& superpixels, const ImageArgument& left,
                  const DisparityArgument& disparity, const FloatsArgument& evidence_px, const Ground& ground,
                  const Background& background, float noise_sigma, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  const DisparityInput map(disparity, "disparity", exec);
  const BorrowedDisparities evidence(evidence_px, "evidence_px");
  const Size size = superpixels.labels.size();
  expect_size(in.size(), "left", size, "superpixels");
  expect_size(map.size(), "disparity", size, "superpixels");
  expect_size(evidence.size(), "evidence_px", size, "superpixels");
  expect_noise(noise_sigma);
  return released([&] {
    const Cues cues{in.gray(),  in.rgb(),   map.map().disparity_px, evidence.view(), ground,
                    background, noise_sigma};
    return grow_merge_tree(superpixels, cues, kSameThing, exec);
  });
}

/// One row of as many pixels as the tree's superpixels have: only the area of the image matters.
Size size_of(const MergeTree& tree) {
  std::int64_t area = 0;
  for (int i = 0; i < tree.superpixels; ++i) area += tree.nodes[slot(i)].area;
  return {static_cast<int>(area), 1};
}

ChosenObjects chosen_of(const Config& config, const Exec&, const MergeTree& tree) {
  return released(
      [&] { return choose_objects(tree, kWholeObject, limits_of(config.objects, size_of(tree))); });
}

Segmentation groups(const Config&, const Exec& exec, const Superpixels& superpixels,
                    const ChosenObjects& chosen, const DisparityArgument& disparity) {
  const DisparityInput map(disparity, "disparity", exec);
  expect_size(map.size(), "disparity", superpixels.labels.size(), "superpixels");
  if (chosen.object_of.size() != slot(superpixels.count)) {
    throw Error("chosen: is of " + std::to_string(chosen.object_of.size()) + " superpixels, expected the " +
                std::to_string(superpixels.count) + " of superpixels");
  }
  return released([&] { return groups_of(superpixels, chosen, map.map(), exec); });
}

// ---- what the classes show ----

Array<std::int32_t> parents(const MergeTree& self) {
  std::vector<std::int32_t> all(self.nodes.size());
  std::transform(self.nodes.begin(), self.nodes.end(), all.begin(),
                 [](const MergeNode& node) { return node.whole; });
  return array_from(std::move(all));
}

}  // namespace

void bind_grouping(py::module_& m) {
  using py::literals::operator""_a;

  py::class_<Superpixels>(m, "Superpixels",
                          "The image cut into connected pieces that no clear edge of brightness, colour or "
                          "depth runs through.")
      .def_property_readonly("labels", always_shown(&Superpixels::labels),
                             "(H, W) int32, read-only: 0 to count - 1")
      .def_readonly("count", &Superpixels::count, "number of superpixels, 1 or more")
      .def("__repr__",
           [](const Superpixels& self) {
             return "<cairn.Superpixels " + text(self.labels.size()) + ", " + std::to_string(self.count) +
                    ">";
           })
      .def(pickled<Superpixels>());
  py::class_<MergeTree>(m, "MergeTree",
                        "All regions that superpixels fuse to, from the superpixels to the whole image; its "
                        "length is the number of its nodes. Every node comes after its parts.")
      .def_readonly("superpixels", &MergeTree::superpixels,
                    "number of superpixels: node i below it is superpixel i")
      .def_property_readonly("parents", &parents,
                             "int32, for each node the node that it is a part of; -1 = none")
      .def("__len__", [](const MergeTree& self) { return self.nodes.size(); })
      .def("__repr__",
           [](const MergeTree& self) {
             return "<cairn.MergeTree of " + std::to_string(self.superpixels) + " superpixels, " +
                    std::to_string(self.nodes.size()) + " nodes>";
           })
      .def(pickled<MergeTree>());
  py::class_<ChosenObjects>(m, "ChosenObjects", "The regions of a MergeTree that are objects.")
      .def_readonly("object_of", &ChosenObjects::object_of,
                    "for each superpixel its object, 1 to len(scores) - 1; 0 = none")
      .def_readonly("scores", &ChosenObjects::scores,
                    "for each object how likely it is one, 0 to 1; scores[0] = 0")
      .def_readonly("likeliest", &ChosenObjects::likeliest,
                    "for each superpixel how likely the likeliest region that holds it is an object, 0 to 1")
      .def("__len__", [](const ChosenObjects& self) { return self.scores.size() - 1; })
      .def("__repr__",
           [](const ChosenObjects& self) {
             return "<cairn.ChosenObjects " + std::to_string(self.scores.size() - 1) + ">";
           })
      .def(pickled<ChosenObjects>());

  def_stage(m, "cut_superpixels", {"superpixels"},
            "Cuts the image into connected pieces that no clear edge runs through, by brightness, colour "
            "(where there is colour) and steps of disparity. noise_sigma as noise_sigma() gives it.",
            &superpixels_of, "left"_a, "disparity"_a, "noise_sigma"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "segmentation_of", {}, "The superpixels as a Segmentation, with their grey statistics.",
            &as_segmentation, "superpixels"_a, "left"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "grow_merge_tree", {},
            "Fuses the two neighbouring regions that are likeliest one thing, by every cue and by fitted "
            "trees, until none are left. evidence_px as find_evidence() gives it, ground as "
            "likely_ground(), noise_sigma as noise_sigma().",
            &tree_of, "superpixels"_a, "left"_a, "disparity"_a, "evidence_px"_a, "ground"_a, "background"_a,
            "noise_sigma"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "choose_objects", {"objects"},
            "Chooses the regions of the tree that are likeliest whole objects; no two share a superpixel. "
            "Of the options only min_area and min_confidence count.",
            &chosen_of, "tree"_a, py::kw_only());
  def_stage(m, "groups_of", {},
            "The chosen objects as a Segmentation: region 0 is all else (is_background), the others are the "
            "objects. Means in px.",
            &groups, "superpixels"_a, "chosen"_a, "disparity"_a, py::kw_only());
}

}  // namespace cairn::python
