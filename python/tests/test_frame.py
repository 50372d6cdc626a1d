# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Frames, objects and rigs, as used in a notebook; files."""

import json
import re

import numpy as np
import pytest

import cairn
from cairn import _cairn
from conftest import same

CHECKS = " ".join(name for name, *_ in _cairn.CHECKS)
STAGES = f"""correct_epipolar match refine_subpixel {CHECKS} combine
    noise_sigma select_textured fit_ground likely_ground reject_below_ground reject_speckles fit_background
    floor_under_reflections superpixel_edges hint_objects cut_superpixels grow_merge_tree estimate_confidence choose_objects refine_disparity superpixels groups
    measure refine_objects locate reject_sky floor_probability label_obstacles rejected_obstacles""".split()
PAPER_STAGES = f"""match refine_subpixel {CHECKS} combine noise_sigma
    fit_ground reject_below_ground reject_speckles label_floor segment_disparity segment_intensity fuse measure
    locate estimate_confidence label_obstacles rejected_obstacles""".split()


def test_objects_have_attributes_and_a_repr(sample):
    frame = sample.frame
    nearest = frame.objects[0]
    assert nearest.id == 1 and nearest.distance_m == nearest.position_in_camera_m[2] == pytest.approx(2.13, abs=0.1)
    mask = frame.objects_map == nearest.id
    assert mask.sum() == nearest.pixel_count
    x, y, width, height = nearest.box_px
    rows, columns = np.nonzero(mask)
    assert (columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1) == (x, y, width, height)
    assert nearest.disparity_px == pytest.approx(np.nanmedian(frame.disparity[mask]), abs=1)
    assert nearest.mean_colour == tuple(np.rint(sample.left[mask].mean(axis=0)).astype(int))
    assert 0 < nearest.confidence <= 1 and 0 < nearest.valid_share <= 1
    assert re.fullmatch(r"Object\(id=1, distance_m=2\.\d+, .* confidence=0\.\d+, box_on_floor=FloorBox\(.*\)\)", repr(nearest))


def test_objects_are_a_sequence(sample):
    objects = sample.frame.objects
    assert len(objects) == 4 and [o.id for o in objects] == [1, 2, 3, 4]
    assert objects[-1].id == 4 and [o.id for o in objects[1:3]] == [2, 3] and [o.id for o in objects[0:2]] == [1, 2]
    assert [o.disparity_px for o in objects] == sorted((o.disparity_px for o in objects), reverse=True)
    with pytest.raises(IndexError):
        objects[4]
    assert same(objects.labels, sample.frame.objects_map)


def test_distances_have_an_interval_and_boxes_are_on_the_floor(sample):
    frame = sample.frame
    nearest = frame.objects[0]
    low, high = nearest.depth_interval_m
    assert low < nearest.distance_m < high and nearest.disparity_sigma_px > 0
    box = nearest.box_on_floor
    forward, left, up = box.centre_in_floor_m
    assert forward == pytest.approx(nearest.distance_m, abs=0.4) and left > 0 and 0 < up < 1
    assert box.size_m[0] >= box.size_m[1] > 0 and box.size_m[2] == pytest.approx(0.8, abs=0.15)
    assert (np.linalg.eigvalsh(box.centre_covariance_m2) > 0).all() and repr(box).startswith("FloorBox(centre_in_floor_m=(")
    floor = frame.floor_frame
    assert cairn.floor_frame(frame.ground.plane, frame.rig).camera_height_m == floor.camera_height_m
    on_floor = np.array(floor.floor_from_camera) @ [*nearest.position_in_camera_m, 1]
    assert on_floor[:2] == pytest.approx(box.centre_in_floor_m[:2], abs=0.4)


@pytest.mark.parametrize("place", ["street", "yard", "lawn"])
def test_the_sky_is_free_and_no_obstacle(source, place):
    folder = source / "data/outdoors" / place
    pair, calibration = cairn.load_pair(folder / "left.png", folder / "right.png"), cairn.load_calibration(folder / "calib.txt")
    frame = cairn.segment(*pair, calibration)
    sky = (frame.reject & cairn.Reject.sky) != 0
    assert same(sky, frame.space == 64) and np.isnan(frame.disparity[sky]).all() and (frame.confidence[sky] == 0).all()
    infinitely_far = np.isnan(cairn.load_disparity(folder / "disp_left.png")) & (cairn.load_labels(folder / "objects.png") == 0)
    assert sky[infinitely_far].mean() > 0.9 and infinitely_far[sky].mean() > 0.98
    frame = cairn.segment(*pair, calibration, ground={"source": "off"})
    assert (frame.reject & cairn.Reject.sky == 0).all() and (frame.space != 64).all()


def test_obstacles_are_reported_whether_objects_or_not(sample):
    frame = sample.frame
    assert set(np.unique(frame.space)) == {0, 128, 255}
    assert (frame.space[frame.objects_map > 0] == 255).all() and same(frame.floor, (frame.space == 128).astype(np.uint8) * 255)
    reasons = {left.reason for left in frame.left_out}
    sure = cairn.segment(sample.left, sample.right, sample.calibration, objects={"min_confidence": 0.97})
    reasons |= {left.reason for left in sure.left_out}
    assert reasons == {"background", "too small", "low confidence"} and repr(frame.left_out[0]).startswith("LeftOut(reason='")
    scan, grid = frame.scan(), frame.grid()
    seen = scan.ranges_m[np.isfinite(scan.ranges_m)]
    assert len(scan) == len(scan.ranges_m) and 1 < seen.min() < frame.objects[0].distance_m
    assert set(np.unique(grid.cells)) == {-1, 0, 100} and grid.cells.shape == (240, 120)
    assert frame.ground_steps() == []
    without = cairn.segment(sample.left, sample.right, match={"num_disparities": 32})
    assert without.scan() is None and without.ground_steps() is None and without.grid() is None and without.floor_frame is None


def test_a_kerb_is_a_step_of_the_ground(kerb, tmp_path):
    step, = kerb.ground_steps()
    assert abs(step.height_m - 0.12) < 0.01 and repr(step).startswith("GroundStep(")
    assert abs(step.from_m[0] - 2) < 0.15 and abs(step.to_m[0] - 2) < 0.15 and abs(step.from_m[2]) < 0.01
    assert step.to_m[1] - step.from_m[1] > 1.5
    grid = kerb.grid()
    middle = (np.add(step.from_m, step.to_m)[:2] / 2 - grid.origin_in_floor_m) / grid.cell_size_m
    assert grid.cells[int(middle[1]), int(middle[0])] == 100
    drawn = kerb.overlay()
    assert (np.abs(drawn[..., :3] - np.array([255, 210, 60.0])).sum(2) < 30).sum() > 300  # the line of the step
    kerb.save(tmp_path)
    assert same(drawn, cairn.load_picture(tmp_path / "overlay.png"))
    written, = json.loads(kerb.to_json())["ground_steps"]
    assert np.allclose([*written["from_m"], *written["to_m"], written["height_m"]], [*step.from_m, *step.to_m, step.height_m])


def test_depth_and_points_are_arrays(sample):
    frame = sample.frame
    depth, points = frame.depth_m(), frame.points()
    rig = frame.rig
    assert depth.dtype == np.float32 and (np.isnan(depth) == np.isnan(frame.disparity)).all()
    known = ~np.isnan(depth)
    assert depth[known] == pytest.approx(rig.focal_px * rig.baseline_m / (frame.disparity[known] + rig.doffs_px), rel=1e-5)
    assert same(points[..., 2].copy(), depth)
    own = frame.points(frame.objects[0])
    assert own.shape == ((known & (frame.objects_map == 1)).sum(), 3) and same(own, frame.points(1))
    with pytest.raises(cairn.Error, match="object: found id 5, expected 1 … 4"):
        frame.points(5)
    with pytest.raises(cairn.Error, match="a frame without a rig has no metres"):
        cairn.segment(sample.left, sample.right, match={"num_disparities": 32}).depth_m()


def test_without_a_rig_there_are_no_metres(sample):
    frame = cairn.segment(sample.left, sample.right, match={"num_disparities": 32})
    assert frame.rig is None and frame.objects[0].distance_m is None and frame.objects[0].position_in_camera_m is None
    assert repr(frame.objects[0]).startswith("Object(id=1, distance_m=None, ")


def test_a_frame_renders_itself(sample, tmp_path):
    frame = sample.frame
    png = frame._repr_png_()
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    (tmp_path / "overlay.png").write_bytes(png)
    shown = cairn.load_picture(tmp_path / "overlay.png")
    assert same(shown, frame.overlay())
    assert same(shown, cairn.draw_objects(sample.left, frame.objects, frame.floor))
    view, drawn = frame.disparity_view(), cairn.draw_disparity(frame.disparity_map, sample.calibration)
    assert same(view[:, :640], drawn[:, :640])
    assert not same(view, drawn)  # the frame's legend lists only the reasons in force
    assert repr(frame).startswith("<cairn.Frame 320x240, ground found, Objects(4\n  Object(id=1")
    assert frame.ground and frame.ground.refusal == "none" and 0 < frame.ground.support <= 1
    a, b, c = frame.ground.plane
    assert frame.ground.plane.disparity_px(10, 20) == pytest.approx(a * 10 + b * 20 + c, rel=1e-5)
    assert list(frame.timings) == STAGES and min(frame.timings.values()) >= 0
    assert [o["id"] for o in json.loads(frame.to_json())["objects"]] == [1, 2, 3, 4]
    assert frame.epipolar.outcome == "aligned"


def test_the_preset_paper_runs_its_own_stages_only(sample):
    frame = cairn.segment(sample.left, sample.right, sample.calibration, preset="paper")
    assert list(frame.timings) == PAPER_STAGES


def test_reasons_have_names(sample):
    assert cairn.Reject(sample.frame.reject.max()) and cairn.Reject.left_right == 2
    assert repr(cairn.Reject.left_right | cairn.Reject.speckle).startswith("<Reject.left_right|speckle")
    assert {r.name for r in cairn.Reject} >= {"border", "left_right", "below_ground", "no_data"}
    seen_by_one = (sample.frame.reject & cairn.Reject.left_right) != 0
    assert seen_by_one.any() and np.isnan(sample.frame.disparity[seen_by_one]).all()


def test_a_rig_is_made_of_numbers_or_a_file(sample, tmp_path):
    rig = cairn.Rig(focal_px=700, baseline_m=0.12, cx_px=320, cy_px=240)
    assert rig.point_in_camera_m(320, 240, 42) == pytest.approx((0, 0, 2))
    assert rig.point_in_camera_m(0, 0, 0) is None
    assert repr(rig) == "Rig(focal_px=700, baseline_m=0.12, cx_px=320, cy_px=240, doffs_px=0)"
    assert eval(repr(rig), {"Rig": cairn.Rig}) == rig and rig != cairn.Rig(701, 0.12, 320, 240)
    assert cairn.Rig.from_file(sample.folder / "calib.txt") == sample.calibration.rig
    assert sample.calibration.image_size == (320, 240)
    with pytest.raises(cairn.Error, match="baseline is 0.0+, expected a positive number"):
        cairn.Rig(700, 0, 320, 240)
    with pytest.raises(cairn.Error):
        cairn.Rig(float("nan"), 0.1, 320, 240)
    with pytest.raises(cairn.ArgumentError, match="found no argument 'cx_px', expected it"):
        cairn.Rig(700, 0.12)
    with pytest.raises(cairn.Error, match="calib.txt"):
        cairn.load_calibration(tmp_path / "calib.txt")


def test_files_are_read_back_as_written(tmp_path):
    random = np.random.default_rng(3)
    disparity = (random.integers(1, 200 * 256, (20, 30)) / 256).astype(np.float32)
    disparity[3, 4] = np.nan
    for name in ("map.png", "map.pfm"):
        cairn.save_disparity(tmp_path / name, disparity)
        np.testing.assert_array_equal(cairn.load_disparity(tmp_path / name), disparity)
    for image in (random.integers(0, 256, (9, 7, 3)).astype(np.uint8), random.integers(0, 256, (9, 7)).astype(np.uint8)):
        cairn.save_png(tmp_path / "image.png", image)
        assert same(cairn.load_picture(str(tmp_path / "image.png")), np.ascontiguousarray(image)) or np.array_equal(
            cairn.load_picture(tmp_path / "image.png"), image
        )
    labels = random.integers(0, 60000, (9, 7)).astype(np.uint16)
    cairn.save_png(tmp_path / "labels.png", labels)
    np.testing.assert_array_equal(cairn.load_labels(tmp_path / "labels.png"), labels)
    with pytest.raises(cairn.Error, match="nowhere"):
        cairn.save_png(tmp_path / "nowhere" / "x.png", labels)
