# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Reads and writes fitted numbers as the library has them: cairn/fitted/fitted.hpp defines the format."""
import numpy as np


def write(path, kind, *arrays):
    """A file: the kind, then each array with its length, filled up to whole words. All little-endian."""
    with open(path, "wb") as out:
        out.write(b"cairn 1 " + kind)
        for array in arrays:
            bytes_ = np.ascontiguousarray(array).tobytes()
            out.write(np.uint32(len(array)).astype("<u4").tobytes() + bytes_ + b"\0" * (-len(bytes_) % 4))


def write_trees(path, base, roots, nodes):
    layout = np.dtype([("feature", "<i2"), ("below", "<i2"), ("value", "<f4")])
    write(path, b"tree", np.array([base], "<f4"), np.array(roots, "<i2"), np.array(nodes, layout))


def write_network(path, shapes, weights, bias, scale):
    write(path, b"net ", np.array(shapes, "<i4").ravel(), np.array(weights, "i1"), np.array(bias, "<i4"), np.array(scale, "<f4"))


def read_network(path):
    """The layers: (inputs, outputs, side, stride, least), weights, biases and scales of each."""
    data, at, arrays = path.read_bytes(), 12, []
    for kind in ("<i4", "i1", "<i4", "<f4"):
        count = int.from_bytes(data[at:at + 4], "little")
        arrays.append(np.frombuffer(data, kind, count, at + 4))
        at += 4 + -(-arrays[-1].nbytes // 4) * 4
    shapes, weights, bias, scale = arrays
    layers = []
    for shape in map(tuple, shapes.reshape(-1, 5).tolist()):
        inputs, outputs, side = shape[:3]
        count = inputs * outputs * side * side
        layers.append((shape, weights[:count], bias[:outputs], scale[:outputs]))
        weights, bias, scale = weights[count:], bias[outputs:], scale[outputs:]
    return layers
