# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Code of docs/python.md; test_guide.py runs it."""

import cairn
import numpy as np


def rigs(folder):
    # [rig]
    rig = cairn.Rig(focal_px=700, baseline_m=0.12, cx_px=320, cy_px=240)
    rig = cairn.load_calibration(folder / "calib.txt")  # Middlebury, KITTI, OpenCV, ROS, YAML: see formats
    # [/rig]
    return rig


def frame_of(left, right, rig):
    # [frame]
    frame = cairn.segment(left, right, rig)
    nearest = frame.objects[0]
    pixels = frame.objects_map == nearest.id
    trusted = np.where(frame.confidence > 0.8, frame.disparity, np.nan)
    hidden = (frame.reject & cairn.Reject.left_right) != 0  # seen by one camera only
    # [/frame]
    return frame, pixels, trusted, hidden


def options_of(left, right, rig):
    # [options]
    frame = cairn.segment(left, right, rig, preset="paper", match={"num_disparities": 64, "cost": "sad"})

    config = cairn.Config("paper", match={"window_size": 11}, speckle={"size": 100})
    frame = cairn.segment(left, right, rig, config=config)
    coarse = [option for option in cairn.options() if option.name == "match.window_size"]
    # [/options]
    return frame, coarse


def video(pairs, rig):
    found = []
    # [video]
    segmenter = cairn.Segmenter(rig, match={"num_disparities": 48})
    for left, right in pairs:
        frame = segmenter.segment(left, right)
        found.append([(o.id, o.distance_m) for o in frame.objects])
    # [/video]
    return found


def overlapping(pairs, rig):
    found = []
    # [prefetch]
    segmenter = cairn.Segmenter(rig, exec=cairn.Exec(threads=2))
    for k, (left, right) in enumerate(pairs):
        if k + 1 < len(pairs):
            segmenter.prefetch(*pairs[k + 1])
        frame = segmenter.segment(left, right)
        found.append(len(frame.objects))
    # [/prefetch]
    return found


def followed(folder):
    found = []
    # [follow]
    for step in cairn.follow(folder, tracking={"min_hits": 2}):  # any source of `cairn follow`
        x, y, z = step.map_from_camera[:3, 3]  # position of the camera, m
        for track in step.tracks:
            if track.state == "confirmed":
                pixels = step.ids == track.id
                found.append((step.seconds, track.id, track.position_m, track.is_moving, pixels.sum()))
    # [/follow]
    return found


def fed(pairs, rig):
    # [follower]
    follower = cairn.Follower(rig)
    for k, (left, right) in enumerate(pairs):
        step = follower.next(left, right, seconds=0.1 * k)
    # [/follower]
    return step


def stages(left, right, rig):
    # [stages]
    matches = cairn.match(left, right, num_disparities=32)
    inconsistent = cairn.reject_inconsistent(matches, max_diff=1)
    bright = left.min(axis=2) > 250  # over-exposed: no data
    saturated = np.where(bright, cairn.Reject.no_data, cairn.Reject.none).astype(np.uint16)
    disparity = cairn.combine(cairn.refine_subpixel(matches), [inconsistent, saturated])
    frame = cairn.segment(left, rig=rig, disparity_map=disparity)
    # [/stages]
    return frame


def tuned(folder, left, right, rig):
    # [tune]
    frames = cairn.load_tuning_frames(folder, truth=True)  # folders with left.png, right.png, calib.txt, objects.png
    tuning = cairn.tune(frames, options=["superpixels.count", "objects.*"], evaluations=5, holdout=0.25)
    print(tuning)  # losses before and after, also on the frames held out
    better = cairn.segment(left, right, rig, config=tuning.config)
    # [/tune]
    return tuning, better


def doctor(left, right, rig, pairs):
    # [doctor]
    for finding in cairn.diagnose(cairn.measure_pair(left, right), rig):
        print(f"{finding.severity}, {finding.kind}: {finding.says}. {finding.remedy}")
    late = cairn.measure_synchrony(pairs).lag  # delay of the right camera in frames
    # [/doctor]
    return late
