// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/grouping/choose_objects.hpp>
#include <cairn/grouping/object_hints.hpp>
#include <cairn/pipeline/segment.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

/// One row with as many pixels as the tree's superpixels have: only the image's area matters.
Size size_of(const MergeTree& tree) {
  std::int64_t area = 0;
  for (int i = 0; i < tree.superpixels; ++i) area += tree.nodes[slot(i)].area;
  return {static_cast<int>(area), 1};
}

Cues cues_of(const Picture& left, const DisparityInput& disparity, const Disparities& evidence_px,
             const Ground& ground, const Background& background, NoiseSigma noise) {
  return {left.gray(), left.rgb(), disparity.map().disparity_px, evidence_px.view(), ground,
          background,  noise.value};
}

Numbers<std::int16_t> numbers_of(const Image<ObjectHint>& hints) {
  Numbers<std::int16_t> numbers{{}, {hints.height(), hints.width(), 5}};
  for (int y = 0; y < hints.height(); ++y) {
    for (int x = 0; x < hints.width(); ++x) {
      const ObjectHint& h = hints(x, y);
      numbers.values.insert(numbers.values.end(), {h.object, h.outline, h.to_x, h.to_y, h.size});
    }
  }
  return numbers;
}

Numbers<std::int32_t> parents(const MergeTree& self) {
  Numbers<std::int32_t> all;
  for (const MergeNode& node : self.nodes) all.values.push_back(node.whole);
  return all;
}

}  // namespace

void bind_grouping(py::module_& m) {
  using py::literals::operator""_a;

  Class<Superpixels>(
      m, "Superpixels",
      "The image cut into connected pieces that no clear edge of brightness, colour or depth runs "
      "through.")
      .shows("labels", &Superpixels::labels, "(H, W) int32, read-only: 0 to count - 1")
      .shows("count", &Superpixels::count, "number of superpixels, 1 or more");
  Class<MergeTree>(
      m, "MergeTree",
      "All regions that superpixels fuse to, from the superpixels to the whole image; its length is the "
      "number of its nodes. Every node comes after its parts.")
      .shows("superpixels", &MergeTree::superpixels, "number of superpixels: node i below it is superpixel i")
      .shows("parents", &parents, "int32, for each node the node that it is a part of; -1 = none")
      .method("__len__", "Nodes.", [](const MergeTree& self) { return self.nodes.size(); });
  Class<ChosenObjects>(m, "ChosenObjects", "The regions of a MergeTree that are objects.")
      .shows("object_of", &ChosenObjects::object_of,
             "for each superpixel its object, 1 to len(scores) - 1; 0 = none")
      .shows("scores", &ChosenObjects::scores, "for each object how likely it is one, 0 to 1; scores[0] = 0")
      .shows("likeliest", &ChosenObjects::likeliest,
             "for each superpixel how likely the likeliest region that holds it is an object, 0 to 1")
      .method("__len__", "Objects.", [](const ChosenObjects& self) { return self.scores.size() - 1; });

  stage(
      m, "cut_superpixels", {"superpixels"},
      "Cuts the image into connected pieces that no clear edge runs through, by brightness, colour (where "
      "there is "
      "colour) and steps of disparity. noise_sigma as noise_sigma() gives it.",
      [](const Call& call, const Picture& left, const DisparityInput& disparity, NoiseSigma noise) {
        return cut_superpixels(left.gray(), left.rgb(), disparity.map().disparity_px, noise.value,
                               call.config.superpixels, call.exec);
      },
      "left"_a, "disparity"_a, "noise_sigma"_a);
  stage(
      m, "segmentation_of", {}, "The superpixels as a Segmentation, with their grey statistics.",
      [](const Call& call, const Superpixels& superpixels, const Picture& left) {
        return segmentation_of(superpixels, left.gray(), call.exec);
      },
      "superpixels"_a, "left"_a);
  stage(
      m, "hint_objects", {},
      "Estimates of a small network, used by grow_merge_tree(): (rows, columns, 5) int16 for cells of about 2x2 "
      "pixels of a 320x240 image. Log-odds in 1/16 that the cell shows an object, and that an object's outline passes; "
      "the way to the object's centroid, x and y in 1/8 cell; log2 of its number of cells in 1/16.",
      [](const Call& call, const Superpixels& superpixels, const Picture& left,
         const DisparityInput& disparity, const Disparities& evidence_px, const Ground& ground,
         const Background& background, NoiseSigma noise) {
        const Cues cues = cues_of(left, disparity, evidence_px, ground, background, noise);
        return numbers_of(hint_objects(superpixels.edges, cues, call.exec));
      },
      "superpixels"_a, "left"_a, "disparity"_a, "evidence_px"_a, "ground"_a, "background"_a, "noise_sigma"_a);
  stage(
      m, "grow_merge_tree", {},
      "Merges the two neighbouring regions that most likely belong to one object, by all cues and fitted trees, "
      "until one is left. Calls hint_objects(). evidence_px as find_evidence() gives it, ground as likely_ground(), "
      "noise_sigma as noise_sigma().",
      [](const Call& call, const Superpixels& superpixels, const Picture& left,
         const DisparityInput& disparity, const Disparities& evidence_px, const Ground& ground,
         const Background& background, NoiseSigma noise) {
        Cues cues = cues_of(left, disparity, evidence_px, ground, background, noise);
        const Image<ObjectHint> hints = hint_objects(superpixels.edges, cues, call.exec);
        cues.hints = hints;
        return grow_merge_tree(superpixels, cues, same_thing_trees(), call.exec);
      },
      "superpixels"_a, "left"_a, "disparity"_a, "evidence_px"_a, "ground"_a, "background"_a, "noise_sigma"_a);
  stage(
      m, "choose_objects", {"objects"},
      "Chooses the regions of the tree that are likeliest whole objects; no two share a superpixel. Of the "
      "options "
      "only min_area and min_confidence count.",
      [](const Call& call, const MergeTree& tree) {
        return choose_objects(tree, whole_object_trees(), limits_of(call.config.objects, size_of(tree)),
                              call.exec);
      },
      "tree"_a);
  stage(
      m, "groups_of", {},
      "The chosen objects as a Segmentation: region 0 is all else (is_background), the others are the "
      "objects. Means "
      "in px.",
      [](const Call& call, const Superpixels& superpixels, const ChosenObjects& chosen,
         const DisparityInput& disparity) {
        if (chosen.object_of.size() != slot(superpixels.count)) {
          throw Error("chosen: is of " + std::to_string(chosen.object_of.size()) +
                      " superpixels, expected the " + std::to_string(superpixels.count) + " of superpixels");
        }
        return groups_of(superpixels, chosen, disparity.map(), call.exec);
      },
      "superpixels"_a, "chosen"_a, "disparity"_a);
}

}  // namespace cairn::python
