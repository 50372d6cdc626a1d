# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Objects from a rectified stereo pair, in metres, with a reason for every pixel that was refused.

    left, right = cairn.load_pair("left.png", "right.png")
    frame = cairn.segment(left, right, cairn.load_calibration("calib.txt"))
    frame.objects, frame.disparity, frame.reject

Every stage of the method is a function with its C++ name; cairn.options() lists all options.
"""

try:
    from . import _cairn
except ImportError as error:
    from ._import_error import explained

    raise explained(error) from None
from ._cairn import *  # noqa: F403
from ._cairn import __version__ as __version__

__all__ = [name for name in dir(_cairn) if not name.startswith("_")]
