#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares distances, sizes, floor and obstacles with the truth: geometry.py DATA [--fit] (PYTHONPATH: the built module)

The rendered rooms have exact truth. Measures floor and obstacles per pixel, and for each object found (IoU of 0.5 or
more) its depth, depth interval, extent and box. Prints a table with the fit and the validation sets in columns. --fit
fits on the fit set the three coefficients of locate() that predict the error of a median disparity, and the six of
sight() that predict that of a mask's centre. The trees of refine_objects() have seen the fit set, so these
coefficients come out too small.
"""
import math
import pathlib
import sys

import numpy as np

import cairn

SETS = {
    "fit": ["dev/320x240", "dev/640x480", "train/320x240"],
    "validate": ["validate/320x240", "validate/640x480"],
}


class Truth:
    def __init__(self, folder):
        self.left, self.right = cairn.load_pair(folder / "left.png", folder / "right.png")
        self.calibration = cairn.load_calibration(folder / "calib.txt")
        self.disparity = cairn.load_disparity(folder / "disp_left.png")
        self.objects = cairn.load_labels(folder / "objects.png")
        self.is_floor = cairn.load_labels(folder / "ground.png") == 255
        numbers = [line.split() for line in (folder / "ground.txt").read_text().splitlines() if line and line[0] != "#"]
        self.plane = [float(number) for number in numbers[-1]]
        rig = self.calibration.rig
        self.rig = rig
        rows, columns = np.mgrid[: self.disparity.shape[0], : self.disparity.shape[1]]
        self.floor_px = self.plane[0] * columns + self.plane[1] * rows + self.plane[2]
        depth = rig.focal_px * rig.baseline_m / (self.disparity + rig.doffs_px)
        self.points = np.stack([(columns - rig.cx_px) * depth / rig.focal_px, (rows - rig.cy_px) * depth / rig.focal_px, depth], -1)
        plane = true_plane(self)
        self.floor_frame = cairn.floor_frame(plane, rig) if plane else None


def true_plane(truth):
    """The true floor as a GroundPlane: the plane that fit_ground() finds in the true disparities."""
    return cairn.fit_ground(np.where(np.isnan(truth.disparity), np.nan, truth.floor_px).astype(np.float32), truth.rig).plane


def span(values):
    """Extent of true points without the outermost 0.5 % on each side."""
    low, high = np.percentile(values, [0.5, 99.5])
    return high - low


def box_size(points, frame):
    """Longer side, shorter side and height of the upright box whose sides are closest to the points."""
    matrix = np.array(frame.floor_from_camera)
    x, y, z = matrix[:3, :3] @ points.T
    best = None
    for yaw in np.radians(np.arange(90)):
        u, v = x * math.cos(yaw) + y * math.sin(yaw), y * math.cos(yaw) - x * math.sin(yaw)
        off = [np.abs(a - np.percentile(a, p)) for a in (u, v) for p in (0.5, 99.5)]
        distance = np.min(off, axis=0).sum()
        if best is None or distance < best[0]:
            best = distance, sorted([span(u), span(v)], reverse=True)
    return [*best[1], span(z)]


def found_objects(truth, frame):
    """Pairs of a found object and the mask of the true object that it matches."""
    labels = frame.objects_map
    for found in frame.objects:
        mask = labels == found.id
        ids, counts = np.unique(truth.objects[mask], return_counts=True)
        for k, shared in zip(ids, counts):
            true = truth.objects == k
            if 0 < k < 255 and shared >= 0.5 * (mask.sum() + true.sum() - shared):
                known = true & ~np.isnan(truth.disparity)
                if known.any():
                    yield found, known


def approached(truth):
    """Simulates an approach: for each object that covers 1 % of the image, a window around it of which it covers 40
    %, if that is at least 140 px wide. Yields the share of the object's pixels that are objects or obstacles."""
    height, width = truth.objects.shape
    for k in np.unique(truth.objects):
        whole = truth.objects == k
        if k in (0, 255) or whole.sum() < 0.01 * whole.size:
            continue
        rows, columns = np.nonzero(whole)
        for scale in np.arange(1, 140 / width, -0.02):
            w, h = int(width * scale), int(height * scale)
            x = int(np.clip((columns.min() + columns.max()) // 2 - w // 2, 0, width - w))
            y = int(np.clip((rows.min() + rows.max()) // 2 - h // 2, 0, height - h))
            window = np.s_[y : y + h, x : x + w]
            if whole[window].mean() >= 0.4:
                break
        else:
            continue
        rig = cairn.Rig(focal_px=truth.rig.focal_px, cx_px=truth.rig.cx_px - x, cy_px=truth.rig.cy_px - y, baseline_m=truth.rig.baseline_m)
        range_px = min(int(np.nanmax(truth.disparity)) + 4, w)
        pair = [np.ascontiguousarray(image[window]) for image in (truth.left, truth.right)]
        frame = cairn.segment(*pair, rig, match={"num_disparities": range_px})
        yield (frame.space[whole[window]] == 255).mean()


def measure(folders):
    pixels = dict.fromkeys(["floor", "called_floor", "floor_right", "obstacle_called", "obstacle_right", "object", "object_obstacle", "object_floor"], 0)
    rows, near_by, frames, grounds, right_grounds = [], [], 0, 0, 0
    for folder in folders:
        truth = Truth(folder)
        frame = cairn.segment(truth.left, truth.right, truth.calibration)
        frames += 1
        near_by += approached(truth)
        if frame.ground.plane:
            grounds += 1
            a, b, c = frame.ground.plane
            height, width = truth.disparity.shape
            columns, lines = np.arange(width)[None, :], np.arange(height)[:, None]
            off = np.abs(a * columns + b * lines + c - truth.floor_px)
            right_grounds += np.median(off[truth.is_floor] if truth.is_floor.any() else off) <= 1
        space, is_object = frame.space, (truth.objects > 0) & (truth.objects < 255)
        called, obstacle = space == 128, space == 255
        for name, mask in dict(floor=truth.is_floor, called_floor=called, floor_right=called & truth.is_floor, obstacle_called=obstacle,
                               obstacle_right=obstacle & ~truth.is_floor, object=is_object, object_obstacle=is_object & obstacle,
                               object_floor=is_object & called).items():
            pixels[name] += int(mask.sum())
        for found, mask in found_objects(truth, frame):
            rig = truth.rig
            depth = rig.focal_px * rig.baseline_m / (np.median(truth.disparity[mask]) + rig.doffs_px)
            low, high = found.depth_interval_m
            points = truth.points[mask]
            row = dict(depth=depth, off=abs(found.distance_m - depth), inside=low <= depth <= high,
                       across=np.hypot(*across_ray(truth, found, mask)),
                       extent=[e / span(p) for e, p in zip(found.extent_in_camera_m, points.T)], box=None)
            if found.box_on_floor and truth.floor_frame:
                row["box"] = [ours / true for ours, true in zip(found.box_on_floor.size_m, box_size(points, truth.floor_frame))]
            rows.append(row)
    share = lambda part, whole: 100 * pixels[part] / max(pixels[whole], 1)
    near = np.array([row["off"] for row in rows if 2 <= row["depth"] <= 4])
    boxes = np.array([row["box"] for row in rows if row["box"]])
    extents = np.array([row["extent"] for row in rows])
    return {
        "frames": f"{frames}",
        "ground found / right within 1 px, frames": f"{grounds} / {right_grounds}",
        "floor, precision / recall": f"{share('floor_right', 'called_floor'):.1f} / {share('floor_right', 'floor'):.1f} %",
        "obstacles, precision": f"{share('obstacle_right', 'obstacle_called'):.1f} %",
        "pixels of objects that are obstacles / floor": f"{share('object_obstacle', 'object'):.1f} / {share('object_floor', 'object'):.1f} %",
        "objects that fill two fifths of a window": f"{len(near_by)}",
        "… of their pixels obstacles, mean": f"{100 * np.mean(near_by):.1f} %",
        "… of them obstacles by 95 % of their pixels": f"{100 * np.mean(np.array(near_by) >= 0.95):.0f} %",
        "objects found": f"{len(rows)}",
        "depth at 2–4 m, objects": f"{len(near)}",
        "… error, median / 90th percentile": centimetres(near),
        "position across the ray, error, median / 90th percentile": centimetres([row["across"] for row in rows]),
        "true depth in the 95 % interval": f"{100 * np.mean([row['inside'] for row in rows]):.1f} %",
        "width / height, median error": " / ".join(f"{100 * e:.1f}" for e in np.median(np.abs(extents - 1), 0)[:2]) + " %",
        "extent more than twice too large, width / height / depth": " / ".join(f"{100 * s:.0f}" for s in (extents > 2).mean(0)) + " %",
        "size of the box on the floor, median error": f"{100 * np.median(np.abs(boxes - 1)):.1f} %",
        "… of its longer side / shorter side / height": " / ".join(f"{100 * e:.1f}" for e in np.median(np.abs(boxes - 1), 0)) + " %",
    }


def rows_of(folders):
    """Of each object found: signs and error of its disparity, and the row of fit_middle() or None."""
    for folder in folders:
        truth = Truth(folder)
        frame = cairn.segment(truth.left, truth.right, truth.calibration)
        for found, mask in found_objects(truth, frame):
            ours = frame.disparity[(frame.objects_map == found.id) & ~np.isnan(frame.disparity)]
            low, high = np.quantile(ours, [0.25, 0.75])
            signs = [1, math.log(high - low + 0.1), found.valid_share]
            yield signs, abs(found.disparity_px - np.median(truth.disparity[mask])), middle_of(truth, found, mask)


def middle_of(truth, found, mask):
    """Errors of an object's position across and along the ray, and the values that predict them; None for small objects."""
    if found.position_in_camera_m is None or mask.sum() < 200 * (mask.shape[1] / 320) ** 2:
        return None
    pz = found.position_in_camera_m[2]
    c = min(max(found.confidence, 0.02), 0.99)
    return [*across_ray(truth, found, mask), pz - truth.points[mask].mean(0)[2], pz / truth.rig.focal_px, *found.extent_in_camera_m,
            math.log((1 - c) / c), pz * pz * found.disparity_sigma_px / (truth.rig.focal_px * truth.rig.baseline_m)]


def across_ray(truth, found, mask):
    """The way from the middle of an object's visible part to the ray through its position, right and down, at that depth, in m."""
    px, py, pz = found.position_in_camera_m
    x, y, z = truth.points[mask].mean(0)
    return px * z / pz - x, py * z / pz - y


def centimetres(errors):
    return f"{100 * np.median(errors):.1f} / {100 * np.quantile(errors, 0.9):.1f} cm"


def fit_sigma(signs, errors):
    """Coefficients of ln sigma = bias + spread * ln(interquartile range + 0.1 px) + seen * share of valid pixels.
    Maximum likelihood for errors with a Laplace distribution, then widened until 1.96 sigma covers 95 % of them."""
    signs, errors = np.array(signs), np.array(errors)
    weights = np.linalg.lstsq(signs, np.log(errors + 0.02), rcond=None)[0]
    for _ in range(2000):  # gradient descent; errors beyond 6 sigma are clipped
        weights -= 0.05 * signs.T @ (1 - np.minimum(errors / np.exp(signs @ weights), 6)) / len(errors)
    weights[0] += math.log(np.quantile(errors / np.exp(signs @ weights), 0.95) / 1.96)
    return len(errors), weights


def fit_middle(rows):
    """The numbers of sight() in cairn/sequence/detect.cpp before they are widened: standard deviations of an object's position
    against the mean point of its visible part, across the ray by width and height and along it. The likeliest scales of
    Student's t with 3 degrees of freedom, since a few masks miss half of an object."""
    off_x, off_y, off_z, pixel, width, height, depth, odds, sigma_z = np.array(rows, float).T

    def loss(logs):
        edge, wide, high, disparity, deep = np.exp(logs[:5])
        doubt = np.exp(logs[5] * odds)
        scales = [np.hypot(edge * pixel, doubt * share * extent) for share, extent in ((wide, width), (high, height))]
        scales.append(np.hypot(disparity * sigma_z, deep * depth))
        return sum(np.mean(np.log(s) + 2 * np.log1p((e / s) ** 2 / 3)) for e, s in zip((off_x, off_y, off_z), scales))

    best = np.array([-0.3, -2.8, -2.0, -0.6, -3.0, 0.45])
    step = 0.5
    while step > 1e-3:  # along each number in turn
        moves = [best + sign * step * direction for direction in np.eye(len(best)) for sign in (1, -1)]
        least = min(moves, key=loss)
        if loss(least) < loss(best):
            best = least
        else:
            step /= 2
    return len(rows), [*np.exp(best[:5]), best[5]]


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--fit"]
    if len(arguments) != 1:
        sys.exit(__doc__)
    rendered = pathlib.Path(arguments[0]) / "rendered"
    if not rendered.is_dir():
        sys.exit(f"geometry: {rendered}: no such folder, expected the rendered rooms of the data collection")
    folders = {name: [f for s in sets for f in sorted((rendered / s).iterdir()) if f.is_dir()] for name, sets in SETS.items()}
    if "--fit" in sys.argv:
        signs, errors, middles = zip(*rows_of(folders["fit"]))
        count, (bias, spread, seen) = fit_sigma(signs, errors)
        print(f"{count} objects: bias {bias:.3f}, spread {spread:.3f}, seen {seen:.3f}")
        count, numbers = fit_middle([row for row in middles if row])
        names = ["edge px", "width share", "height share", "disparity share", "depth share", "doubt power"]
        print(f"{count} objects, middle: " + ", ".join(f"{name} {number:.3f}" for name, number in zip(names, numbers)))
        return
    found = {name: measure(of) for name, of in folders.items()}
    print("| | " + " | ".join(found) + " |\n|---|" + "---:|" * len(found))
    for key in next(iter(found.values())):
        print(f"| {key} | " + " | ".join(table[key] for table in found.values()) + " |")


if __name__ == "__main__":
    main()
