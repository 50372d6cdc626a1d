# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Every stage under its C++ name; run in sequence, they give the frame."""

import re

import numpy as np
import pytest

import cairn
from conftest import same, same_frame


def test_every_stage_of_the_umbrella_header_is_bound(source):
    text = (source / "cairn" / "cairn.hpp").read_text()
    names = {name for words in re.findall(r"// ([a-z_, ]+)(?::.*)?$", text, re.M) for name in words.split(", ")}
    for header in (source / "cairn" / "stereo").glob("*.hpp"):  # the checks, which it includes through Config
        names |= set(re.findall(r"^Image<Reject> (reject_\w+)\(", header.read_text(), re.M))
    assert {"match", "fuse", "measure", "cut_superpixels", "segment", "diagnose", "reject_flat"} <= names
    assert [name for name in sorted(names) if not callable(getattr(cairn, name.strip(), None))] == []


def by_the_paper(sample):
    config = cairn.Config("paper", match={"num_disparities": 32})
    rig = sample.calibration.rig
    matches = cairn.match(sample.left, sample.right, config=config)
    refined = cairn.refine_subpixel(matches, config=config)
    verdicts = [
        cairn.reject_inconsistent(matches, config=config),
        cairn.reject_ambiguous(matches, config=config),
        cairn.reject_flat(matches, config=config),
        cairn.reject_textureless(sample.left, config=config),
    ]
    disparity = cairn.combine(refined, verdicts)
    ground = cairn.fit_ground(disparity, rig, config=config)
    disparity = cairn.reject_below_ground(disparity, ground, rig, config=config)
    disparity = cairn.reject_speckles(disparity, config=config)
    floor = cairn.label_floor(disparity, ground, rig, config=config)
    by_disparity = cairn.segment_disparity(disparity, floor, config=config)
    by_intensity = cairn.segment_intensity(sample.left, config=config)
    fusion = cairn.fuse(by_intensity, by_disparity)
    noise = cairn.noise_sigma(sample.left)
    objects = cairn.measure(fusion.labels, fusion.is_floor, disparity, sample.left, noise, config=config)
    objects = cairn.locate(objects, disparity, ground, rig)
    confidence = cairn.estimate_confidence(matches, disparity, config=config)
    return disparity, confidence, {"by_intensity": by_intensity, "by_disparity": by_disparity, "fusion": fusion}, objects


def by_hierarchy(sample):
    rig = sample.calibration.rig
    noise = cairn.noise_sigma(sample.left)
    offset = cairn.find_epipolar_offset(sample.left, sample.right, num_disparities=32)
    assert offset.outcome == "aligned"
    matches = cairn.match_semi_global(sample.left, sample.right, num_disparities=32)
    disparity = cairn.combine(cairn.refine_subpixel(matches), [cairn.reject_inconsistent(matches)])
    evidence = cairn.select_textured(sample.left, disparity, noise)
    seen = cairn.fit_ground(evidence, rig, left=sample.left)
    ground = cairn.likely_ground(seen, disparity, rig, textured_px=evidence, left=sample.left)
    disparity = cairn.reject_below_ground(disparity, ground, rig)
    disparity = cairn.reject_speckles(disparity)
    seen = cairn.floor_under_reflections(disparity, ground)
    background = cairn.fit_background(evidence, ground, rig)
    hints = cairn.hint_objects(sample.left, seen, evidence, ground, background, noise)
    superpixels = cairn.cut_superpixels(sample.left, seen, noise, hints)
    tree = cairn.grow_merge_tree(superpixels, sample.left, seen, evidence, ground, background, noise)
    assert hints.shape == (120, 160, 5) and hints.dtype == np.int16 and np.abs(hints[..., :2]).max() <= 96
    shows_object = hints[..., 0].repeat(2, 0).repeat(2, 1) > 0  # per pixel
    assert (shows_object & (sample.frame.objects_map > 0)).sum() > 0.8 * (sample.frame.objects_map > 0).sum()
    chosen = cairn.choose_objects(tree)
    groups = cairn.object_regions(superpixels, chosen, disparity)
    objects = cairn.measure_chosen(groups.labels, chosen.scores, disparity, sample.left, noise)
    objects = cairn.refine_objects(objects, disparity, sample.left, sample.right)
    objects = cairn.locate(objects, disparity, ground, rig)
    confidence = cairn.estimate_confidence(matches, disparity)
    refined = cairn.refine_disparity(superpixels, tree, chosen, sample.left, seen, evidence, ground, background, confidence,
                                     hints, noise)
    disparity = cairn.reject_sky(disparity, sample.left, confidence, ground, superpixels, objects, rig)
    confidence = np.where(disparity.reject == 0, confidence, np.float32(0))
    without_sky = cairn.without_sky(refined, disparity.reject)
    likely_floor = cairn.floor_probability(objects, disparity, confidence, ground, background, seen, superpixels, without_sky,
                                           hints, rig)
    space = cairn.label_obstacles(objects, disparity, confidence, ground, background, seen, rig, without_sky, likely_floor)
    by_disparity = cairn.label_obstacles(objects, disparity, confidence, ground, background, seen, rig, without_sky)
    is_judged = ~np.isnan(likely_floor)
    assert same(space[is_judged] == 128, likely_floor[is_judged] >= np.float32(0.7)) and is_judged.mean() > 0.3
    assert same(space[~is_judged], by_disparity[~is_judged])
    assert same(refined.confidence, sample.frame.refined.confidence)
    likely = cairn.likely_disparities(refined, disparity.reject, 0.5)
    assert same(np.isnan(likely.disparity_px), likely.reject != 0)
    assert same(likely.reject & cairn.Reject.unlikely != 0, refined.confidence < 0.5)
    with pytest.raises(cairn.Error, match="tree: was grown from other superpixels"):
        cairn.refine_disparity(cairn.cut_superpixels(sample.left, seen, noise), tree, chosen, sample.left, seen, evidence,
                               ground, background, confidence, hints, noise)
    assert same(space, sample.frame.space)
    regions = {"superpixels": cairn.superpixel_regions(superpixels, sample.left), "groups": groups}
    return disparity, confidence, regions, objects


@pytest.mark.parametrize("preset, stages", [("paper", by_the_paper), ("default", by_hierarchy)])
def test_stage_by_stage_gives_the_frame(sample, preset, stages):
    frame = cairn.segment(sample.left, sample.right, sample.calibration, preset=preset)
    disparity, confidence, regions, objects = stages(sample)
    assert same(disparity.disparity_px, frame.disparity) and same(disparity.reject, frame.reject)
    assert same(confidence, frame.confidence)
    for name, made in regions.items():
        assert same(made.labels, getattr(frame, name).labels), name
    assert same(objects.labels, frame.objects_map) and repr(objects) == repr(frame.objects)


def test_a_merge_tree_ends_in_the_whole_image(sample):
    disparity = sample.frame.disparity_map
    superpixels = cairn.cut_superpixels(sample.left, disparity, 1, count=50)
    assert superpixels.count == 50 and superpixels.labels.max() == 49
    evidence = cairn.select_textured(sample.left, disparity, 1)
    background = cairn.fit_background(evidence, sample.frame.ground)
    tree = cairn.grow_merge_tree(superpixels, sample.left, disparity, evidence, sample.frame.ground, background, 1)
    parents = tree.parents
    assert tree.superpixels == 50 and len(tree) == len(parents) == 2 * 50 - 1
    assert parents[-1] == -1 and (parents[:-1] > np.arange(len(tree) - 1)).all()
    assert (np.bincount(parents[:-1])[50:] == 2).all()
    chosen = cairn.choose_objects(tree, min_confidence=0, min_area=0)
    assert len(chosen.object_of) == 50 and max(chosen.object_of) == len(chosen) == len(chosen.scores) - 1
    assert len(cairn.choose_objects(tree, min_area=100)) <= 1


def test_a_segmentation_is_gradient_watershed_graph_growing(sample):
    gray = sample.gray()[0]
    basins = cairn.watershed(cairn.gradient(gray, 1.5))
    graph = cairn.build_graph(basins.labels, gray)
    merges = cairn.grow_statistical(
        graph, mean_difference_max=3, deviation_max=1, sigma_min=2, min_region_area=int(np.ceil(0.0003 * gray.size - 1e-9))
    )
    made = cairn.apply_merges(basins.labels, graph, merges)
    assert len(graph) == basins.count and 0 in graph.neighbours(graph.neighbours(0)[0])
    assert same(made.labels, cairn.segment_intensity(gray).labels)


def test_a_custom_check_is_an_array(sample):
    """examples/03_your_own_check.cpp in Python."""
    matches = cairn.match(sample.left, sample.right, num_disparities=32)
    saturated = np.where(sample.gray()[0] >= 150, np.uint16(cairn.Reject.no_data), np.uint16(0))
    disparity = cairn.combine(cairn.refine_subpixel(matches), [cairn.reject_inconsistent(matches), saturated])
    assert np.isnan(disparity.disparity_px[saturated != 0]).all() and (saturated != 0).any()
    frame = cairn.segment(sample.left, rig=sample.calibration, disparity_map=disparity)
    assert ((frame.reject & cairn.Reject.no_data) != 0).sum() == (saturated != 0).sum()


def test_matches_contain_the_input_of_the_checks(sample):
    matches = cairn.match(sample.left, sample.right, num_disparities=16)
    for name in ("best", "best_right", "cost", "runner_up", "mean_cost", "cost_before", "cost_after"):
        assert getattr(matches, name).shape == (240, 320), name
    assert matches.row_offset is None and matches.best.dtype == np.int16
    assert cairn.match(np.zeros((9, 9), np.uint8), np.zeros((9, 9), np.uint8), num_disparities=1).best.shape == (9, 9)
    assert cairn.reject_inconsistent(matches, method="vote").dtype == np.uint16
    assert not cairn.reject_ambiguous(matches).any()  # disabled in the preset default


def test_a_stages_option_without_effect_is_refused(sample):
    pair = (sample.left, sample.right)
    with pytest.raises(cairn.Error, match="^match.cost has no effect with match.method=semi_global; set match.method=window first$"):
        cairn.match(*pair, cost="sad")
    assert cairn.match(*pair, cost="sad", method="window", num_disparities=16).row_offset is None
    assert cairn.reject_textureless(sample.left, threshold=4).any()
    paper = cairn.Config("paper")
    assert cairn.match_semi_global(*pair, penalty_small=0.5, num_disparities=16, config=paper).best.shape == (240, 320)
    with pytest.raises(cairn.Error, match="match.cost has no effect"):
        cairn.match_semi_global(*pair, cost="sad", config=paper)
    # A stage of the method that the configuration does not select: calling it selects that method.
    assert len(cairn.segment_intensity(sample.left, mean_difference_max=5)) > 0


def test_the_ground_uses_the_calibration(sample):
    points = [(10, 200, 4, 200), (300, 210, 293, 210), (20, 230, 12, 230), (280, 190, 275, 190)]
    known = cairn.Calibration(sample.calibration.rig, ground_points=np.array(points), camera_height_m=0.4, camera_pitch_deg=15)
    assert known.ground_points == points and known.camera_height_m == np.float32(0.4) and known.camera_pitch_deg == 15
    disparity = sample.frame.disparity_map
    by_points = cairn.fit_ground(disparity, known, source="points")
    by_pose = cairn.fit_ground(disparity, known, source="pose")
    assert by_points.support == by_pose.support == 1 and tuple(by_points.plane) != tuple(by_pose.plane)
    frame = cairn.segment(sample.left, sample.right, known, ground={"source": "points"}, match={"num_disparities": 32})
    assert tuple(frame.ground.plane) == tuple(by_points.plane)
    segmenter = cairn.Segmenter(known, ground={"source": "points"}, match={"num_disparities": 32})
    assert tuple(segmenter.segment(sample.left, sample.right).ground.plane) == tuple(by_points.plane)
    for source, words in (("points", "needs ground_points"), ("pose", "needs a calibration with camera_height")):
        with pytest.raises(cairn.Error, match=words):
            cairn.fit_ground(disparity, sample.calibration, source=source)
    with pytest.raises(cairn.Error, match="camera_height is 0, expected 0.01"):
        cairn.Calibration(camera_height_m=0)


def test_mismatched_arguments_are_refused(sample):
    frame, half = sample.frame, sample.left[:, :160]
    other = cairn.cut_superpixels(half, np.ones(half.shape[:2], np.float32), 1)
    superpixels = cairn.cut_superpixels(sample.left, frame.disparity_map, 1)
    walls = cairn.fit_background(frame.disparity, frame.ground)
    grown = (frame.disparity_map, frame.disparity, frame.ground, walls)
    chosen = cairn.choose_objects(cairn.grow_merge_tree(superpixels, sample.left, *grown, 1))
    fewer = cairn.cut_superpixels(sample.left, frame.disparity_map, 1, count=9)
    labels, ground = frame.groups.labels, [False] * len(frame.groups)
    scores = [0.5] * len(frame.groups)
    calls = [
        lambda: cairn.measure(labels, ground, frame.disparity_map, half, 1),
        lambda: cairn.measure(labels, ground[1:], frame.disparity_map, sample.left, 1),
        lambda: cairn.measure(labels - 1, ground, frame.disparity_map, sample.left, 1),
        lambda: cairn.measure(labels, ground, frame.disparity_map, sample.left, -1),
        lambda: cairn.measure(labels[:, 1:], ground, frame.disparity_map, sample.left, 1),
        lambda: cairn.fuse(cairn.superpixel_regions(other, half), frame.groups),
        lambda: cairn.select_textured(half, frame.disparity_map, 1),
        lambda: cairn.select_textured(sample.left, frame.disparity_map, float("nan")),
        lambda: cairn.cut_superpixels(half, frame.disparity_map, 1),
        lambda: cairn.cut_superpixels(sample.left, frame.disparity_map, -1),
        lambda: cairn.cut_superpixels(sample.left, frame.disparity_map, 1, np.zeros((120, 160, 4), np.int16)),
        lambda: cairn.superpixel_regions(superpixels, half),
        lambda: cairn.grow_merge_tree(other, sample.left, *grown, 1),
        lambda: cairn.grow_merge_tree(superpixels, half, *grown, 1),
        lambda: cairn.grow_merge_tree(superpixels, sample.left, *grown, -1),
        lambda: cairn.object_regions(fewer, chosen, frame.disparity_map),
        lambda: cairn.object_regions(superpixels, chosen, frame.disparity[1:]),
        lambda: cairn.measure_chosen(labels, scores[1:], frame.disparity_map, sample.left, 1),
        lambda: cairn.measure_chosen(labels, [2.0] * len(scores), frame.disparity_map, sample.left, 1),
        lambda: cairn.measure_chosen(labels, scores, frame.disparity_map, half, 1),
        lambda: cairn.measure_chosen(labels, scores, frame.disparity_map, sample.left, 1, min_area=1),
        lambda: cairn.likely_ground(frame.ground, frame.disparity_map, source="points"),
        lambda: cairn.likely_ground(frame.ground, frame.disparity_map, left=half),
        lambda: cairn.likely_ground(frame.ground, frame.disparity_map, textured_px=frame.disparity[1:]),
        lambda: cairn.fit_ground(frame.disparity, left=half),
        lambda: cairn.combine(frame.disparity, [frame.reject[:, 1:]]),
        lambda: cairn.segment_disparity(frame.disparity_map, frame.floor[1:]),
        lambda: cairn.build_graph(labels - 1, sample.gray()[0]),
        lambda: cairn.build_graph(labels * 2, sample.gray()[0]),
        lambda: cairn.build_graph(labels, sample.gray()[0][1:]),
        lambda: cairn.build_graph(labels.astype(float), sample.gray()[0]),
        lambda: cairn.apply_merges(labels, cairn.build_graph(labels, sample.gray()[0]), [0]),
        lambda: cairn.apply_merges(labels, cairn.build_graph(labels, sample.gray()[0]), [1, 0] + [0] * (len(frame.groups) - 2)),
        lambda: cairn.gradient(sample.gray()[0], 50),
        lambda: cairn.watershed(sample.gray()[0]),
        lambda: cairn.fit_ground(np.full((20, 20), 1e30, np.float32)),
        lambda: cairn.fit_ground(frame.disparity_map, source="points"),
        lambda: cairn.Calibration(ground_points=[(1, 2, 3, 4)]),
        lambda: cairn.match(sample.left, sample.right, num_disparities=321),
        lambda: cairn.shift_rows(sample.right, cairn.EpipolarOffset(float("nan"))),
    ]
    for number, call in enumerate(calls):
        with pytest.raises(cairn.Error):
            call()
            pytest.fail(f"call {number} was accepted")


def test_a_shifted_right_image_is_shifted_back(sample):
    moved = np.roll(sample.right, 2, axis=0)
    correction = cairn.correct_epipolar(sample.left, moved, num_disparities=32)
    assert correction.offset.outcome == "corrected" and abs(correction.offset.rows - 2) < 0.1
    assert correction.right.shape == (240, 320) and "corrected" in repr(correction.offset)
    back = cairn.shift_rows(moved, cairn.EpipolarOffset(2))
    np.testing.assert_array_equal(back[4:-4], sample.gray()[1][4:-4])
