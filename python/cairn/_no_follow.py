# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Replaces _follow.py in a build without sequences."""

from ._cairn import Error


def missing(name):
    def function(*args, **named):
        """Not available: this build has no sequences."""
        raise Error(f"cairn.{name}: this cairn was built without sequences; they need OpenCV's video and calib3d, Eigen, dlib and "
                    "SQLiteCpp (docs/install.md)")

    function.__name__, function.__module__ = name, "cairn"
    return function


Follower, follow, follow_options, score_sequence = map(missing, ("Follower", "follow", "follow_options", "score_sequence"))
