# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Objects from a rectified stereo pair, in metres, with a reason for every pixel that was refused.

    left, right = cairn.load_pair("left.png", "right.png")
    frame = cairn.segment(left, right, cairn.load_calibration("calib.txt"))
    frame.objects, frame.disparity, frame.reject

Every stage of the method is a function with its C++ name; cairn.options() lists all options.
"""

import sys

try:
    import numpy  # noqa: F401
except ImportError as error:
    raise ImportError(f"cairn needs numpy, and {sys.executable} cannot import it: {error}") from None
try:
    from . import _cairn
except ImportError as error:
    from ._import_error import explained

    raise explained(error) from None

from . import _calls, _frame, _options, _scores, _stages, _values
from ._cairn import __version__ as __version__

if hasattr(_cairn, "follow"):
    from . import _follow
else:
    from . import _no_follow as _follow

_names = {"Error": _cairn.Error, **_calls.CLASSES}
for _module in (_options, _values, _stages, _frame, _scores, _follow, _calls):
    # Public names: classes, checked functions and constants.
    _names.update({name: value for name, value in vars(_module).items()
                   if name in ("NO_MATCH", "HOLE_16") or (callable(value) and value.__module__ == "cairn")})
globals().update(_names)
__all__ = sorted(_names)
