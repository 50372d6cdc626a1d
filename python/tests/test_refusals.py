# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Invalid calls are refused in one plain line that names the argument."""

import numpy as np
import pytest

import cairn

GREY = np.random.default_rng(7).integers(0, 256, (60, 80)).astype(np.uint8)
BAD_CALLS = [
    (lambda: cairn.segment(GREY, GREY, preset=3), "preset: found 3, expected a str"),
    (lambda: cairn.segment(GREY, GREY, bgr="yes"), "bgr: found 'yes', expected True or False"),
    (lambda: cairn.segment(), "segment: found no argument 'left', expected it"),
    (lambda: cairn.segment(GREY, GREY, None, None), "segment: found 4 arguments without a name, expected at most 3: left, right, rig"),
    (lambda: cairn.segment(GREY, GREY, left=GREY), "segment: found argument 'left' twice, expected it once"),
    (lambda: cairn.segment(GREY, GREY, window_size=9), "there is no keyword argument 'window_size', did you mean match={'window_size': …}?"),
    (lambda: cairn.segment(GREY, GREY, macth={}), "there is no keyword argument 'macth', did you mean 'match'?"),
    (lambda: cairn.segment(GREY, GREY, match=[9]), 'options match: found a value of type list, expected a dict such as match={"num_disparities": 64}'),
    (lambda: cairn.segment(GREY, GREY, "calib.txt"), "rig: found 'calib.txt', expected a cairn.Rig, a cairn.Calibration or None"),
    (lambda: cairn.segment(GREY, GREY, exec=2), "exec: found 2, expected a cairn.Exec or None"),
    (lambda: cairn.segment(GREY, GREY, config=3), "config: found 3, expected a cairn.Config, the name of a file, or None"),
    (lambda: cairn.match(GREY), "match: found no argument 'right', expected it"),
    (lambda: cairn.watershed(GREY.astype(np.uint16), sigma=2), "there is no keyword argument 'sigma'"),
    (lambda: cairn.reject_flat(GREY), "matches: found a value of type ndarray, expected a cairn.Matches"),
    (lambda: cairn.summarise([1, 2]), "frames: found a value of type list, expected a list, each entry a cairn.ObjectErrors"),
    (lambda: cairn.diagnose(3), "measures: found 3, expected a cairn.PairMeasures or a cairn.Synchrony"),
    (lambda: cairn.diagnose(cairn.measure_pair(GREY, GREY), limits=3), "limits: found 3, expected a dict or None"),
    (lambda: cairn.load_picture(3), "path: found 3, expected a path, str or os.PathLike"),
    (lambda: cairn.load_picture("x.png", gray=True), "load_picture: there is no argument 'gray', expected of these: path"),
    (lambda: cairn.Rig.from_file(None), "path: found None, expected a path, str or os.PathLike"),
    (lambda: cairn.Rig("700", 0.1, 0, 0), "focal_px: found '700', expected a number"),
    (lambda: cairn.Rig(700, baseline=0.1), "Rig: there is no argument 'baseline', did you mean 'baseline_m'?"),
    (lambda: cairn.Config(file=3), "file: found 3, expected the name of a file or None"),
    (lambda: cairn.Exec(2.5), "threads: found 2.5, expected a whole number"),
    (lambda: cairn.Exec(2**40), "threads: found 1099511627776, expected a whole number"),
    (lambda: cairn.Segmenter().segment(GREY), "Segmenter.segment: found no argument 'right', expected it"),
    (lambda: cairn.object_errors(GREY, GREY, min_area=np.arange(2)), "min_area: found a value of type ndarray, expected a whole number"),
]


@pytest.mark.parametrize("call, words", BAD_CALLS)
def test_an_invalid_call_is_refused_in_one_line(call, words):
    with pytest.raises(cairn.Error) as refusal:
        call()
    assert str(refusal.value) == words
    assert isinstance(refusal.value, TypeError) and isinstance(refusal.value, ValueError)


def test_wrong_values_of_options_are_reported_by_name():
    for value in ("x", 64.5, np.float32(64.5), None, float("nan"), 1e300, [1, 2]):
        with pytest.raises(cairn.Error, match="^option match.num_disparities: found '.*', expected a whole number, 1 … 1024$"):
            cairn.segment(GREY, GREY, match={"num_disparities": value})
    with pytest.raises(cairn.Error, match="^unknown option 'match.windowsize', did you mean 'match.window_size'?"):
        cairn.segment(GREY, GREY, match={"windowsize": 9})


@pytest.mark.parametrize("number", [float, np.float32, np.float64, np.int16, np.uint8, np.int64, int])
def test_a_whole_number_may_be_of_any_type(number):
    config = cairn.Config(match={"num_disparities": number(48), "min_disparity": number(0)})
    assert config["match.num_disparities"] == 48
    assert cairn.Config(match={"min_disparity": float(-5)})["match.min_disparity"] == -5
    assert cairn.Config(left_right={"max_diff": number(2)})["left_right.max_diff"] == 2
    assert cairn.match(GREY, GREY, num_disparities=number(8)).best.max() == 0
    assert cairn.Exec(number(1)).threads == 1
    ids = np.zeros((60, 80), np.int32)
    assert not cairn.object_errors(ids, ids, min_area=number(100)).truth
    cairn.disparity_errors(ids.astype(np.float32), ids.astype(np.float32), skip_left=number(3))


def test_every_function_and_method_refuses_in_one_line():
    """In one line, where pybind11 itself would list every signature."""

    class Odd:
        """Matches no argument type."""

    odd, told = Odd(), 0
    for name in cairn.__all__:
        value = getattr(cairn, name)
        calls = [value] if not isinstance(value, type) else []
        if isinstance(value, type) and not issubclass(value, Exception) and name != "Reject":
            calls = [getattr(value, key) for key, member in vars(value).items()
                     if not key.startswith("_") and not isinstance(member, property)]
            if "__init__" in vars(value):
                calls.append(value)
        for call in filter(callable, calls):
            with pytest.raises((cairn.Error, TypeError)) as refusal:
                call(odd, odd, odd, odd, odd, odd, odd, odd, odd, odd)
            assert "\n" not in str(refusal.value) and "incompatible" not in str(refusal.value), name
            told += 1
    assert told > 60


def test_an_error_raised_inside_a_call_is_unchanged():
    def images():
        yield GREY, GREY
        raise TypeError("made by the caller")

    with pytest.raises(TypeError, match="^made by the caller$"):
        cairn.measure_synchrony(images())


def test_functions_keep_signature_and_docstring():
    assert cairn.segment.__name__ == "segment" and cairn.segment.__module__ == "cairn"
    assert cairn.segment.__doc__.startswith("segment(left: ImageLike, right: Optional[ImageLike] = None, rig: RigLike = None")
