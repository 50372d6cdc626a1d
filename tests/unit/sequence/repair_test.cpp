// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/sequence/repair.hpp>

namespace cairn {
namespace {

/// A row of 40 pixels in four columns of 10: superpixels 0 … 3. Nodes 4 = 0 + 1, 5 = 2 + 3, 6 = all.
struct Row {
  MergeTree tree;
  Superpixels superpixels;
  MaskPrediction warped;
  Tracks tracks;

  Row() {
    tree.superpixels = 4;
    tree.nodes.resize(7);
    for (std::size_t i = 0; i < 4; ++i) tree.nodes[i].area = 10;
    join(4, 0, 1);
    join(5, 2, 3);
    join(6, 4, 5);
    superpixels.count = 4;
    superpixels.labels = Image<RegionId>({40, 1});
    for (int x = 0; x < 40; ++x) superpixels.labels(x, 0) = RegionId{x / 10};
    warped.ids = Image<TrackId>({40, 1}, TrackId::none, {});
  }
  void join(std::int32_t whole, std::int32_t a, std::int32_t b) {
    MergeNode& node = tree.nodes[slot(whole)];
    node.part_a = a;
    node.part_b = b;
    node.area = tree.nodes[slot(a)].area + tree.nodes[slot(b)].area;
    tree.nodes[slot(a)].whole = whole;
    tree.nodes[slot(b)].whole = whole;
  }
  /// A track predicted on the pixels begin … end − 1.
  void expect(std::int64_t id, float confidence, int begin, int end) {
    Track track;
    track.id = TrackId{id};
    track.confidence = confidence;
    tracks.list.push_back(track);
    for (int x = begin; x < end; ++x) warped.ids(x, 0) = track.id;
  }
  std::vector<float> repaired(std::vector<float> scores, float weight = 0.5F) const {
    return repaired_scores(tree, std::move(scores), superpixels, warped, tracks,
                           {RepairMethod::objects, weight});
  }
  /// The superpixels of each object.
  std::vector<std::int32_t> objects(const std::vector<float>& scores) const {
    return choose_by_scores(tree, scores, {0.3F, 1}).object_of;
  }
};

const std::vector<float> kPartsRatherThanWhole{0.4F, 0.4F, 0, 0, 0.6F, 0, 0};

TEST(Repair, ASplitObjectIsMerged) {
  Row row;
  const std::vector<float> shattered{0.5F, 0.5F, 0, 0, 0.4F, 0, 0};
  EXPECT_EQ(row.objects(shattered), (std::vector<std::int32_t>{2, 1, 0, 0}));
  row.expect(1, 0.9F, 0, 20);
  EXPECT_EQ(row.objects(row.repaired(shattered)), (std::vector<std::int32_t>{1, 1, 0, 0}));
}

TEST(Repair, TwoMergedObjectsAreSplit) {
  Row row;
  const std::vector<float> merged{0, 0, 0, 0, 0.3F, 0.3F, 0.7F};
  EXPECT_EQ(row.objects(merged), (std::vector<std::int32_t>{1, 1, 1, 1}));
  row.expect(1, 0.9F, 0, 20);
  row.expect(2, 0.9F, 20, 40);
  EXPECT_EQ(row.objects(row.repaired(merged)), (std::vector<std::int32_t>{2, 2, 1, 1}));
}

TEST(Repair, AnUncertainObjectIsConfirmed) {
  Row row;
  const std::vector<float> doubtful{0, 0, 0, 0, 0.2F, 0, 0};
  EXPECT_EQ(row.objects(doubtful), (std::vector<std::int32_t>{0, 0, 0, 0}));
  row.expect(1, 0.9F, 0, 20);
  EXPECT_EQ(row.objects(row.repaired(doubtful)), (std::vector<std::int32_t>{1, 1, 0, 0}));
}

TEST(Repair, ObjectsWithoutTracksAreUnchanged) {
  Row row;
  row.expect(1, 0.9F, 0, 20);
  const std::vector<float> scores{0, 0, 0, 0, 0.5F, 0.44F, 0};
  EXPECT_EQ(row.repaired(scores)[5], 0.44F);
}

TEST(Repair, ScoresFollowTheFormula) {
  Row row;
  row.expect(1, 0.8F, 0, 16);  // of node 4's 20 pixels
  // t = 16/20 · 0.8 = 0.64, λ = 0.32; IoU = 16/20 = 0.8: fits wholly.
  EXPECT_NEAR(row.repaired(kPartsRatherThanWhole)[4], 0.68 * 0.6 + 0.32 * 0.8, 1e-6);
  // Superpixel 1: t = 6/10 · 0.8 = 0.48, λ = 0.24; IoU = 6/(10 + 16 − 6) = 0.3: does not fit.
  EXPECT_NEAR(row.repaired(kPartsRatherThanWhole)[1], 0.76 * 0.4, 1e-6);
}

TEST(Repair, AnObjectMissingForLongIsDropped) {
  // The track's confidence follows the repaired score as in tracking: it must decay.
  float confidence = 1;
  for (int frame = 0; frame < 60; ++frame) {
    Row row;
    row.expect(1, confidence, 0, 20);
    const float score = row.repaired({0, 0, 0, 0, 0.001F, 0, 0})[4];
    confidence += 0.2F * (score - confidence);
  }
  EXPECT_LT(confidence, 0.01F);
}

TEST(Repair, OffChangesNothing) {
  Row row;
  row.expect(1, 0.9F, 0, 20);
  EXPECT_EQ(repaired_scores(row.tree, kPartsRatherThanWhole, row.superpixels, row.warped, row.tracks,
                            {RepairMethod::off, 0.5F}),
            kPartsRatherThanWhole);
  EXPECT_EQ(row.repaired(kPartsRatherThanWhole, 0), kPartsRatherThanWhole);
}

TEST(Candidates, FollowObjectsAndOverlapNone) {
  const Row row;
  const std::vector<float> scores{0.2F, 0, 0, 0.2F, 0.5F, 0.15F, 0};
  const ChosenObjects chosen = choose_candidates(row.tree, scores, {0.3F, 1}, 0.1F);
  EXPECT_EQ(chosen.object_of, (std::vector<std::int32_t>{1, 1, 0, 2}));
  ASSERT_EQ(chosen.scores.size(), 3U);
  EXPECT_EQ(chosen.scores[1], 0.5F);
  EXPECT_EQ(chosen.scores[2], 0.2F);
  EXPECT_EQ(choose_candidates(row.tree, scores, {0.3F, 1}, 0.3F).scores.size(), 2U);
}

}  // namespace
}  // namespace cairn
