# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Options are listed, set and shown as in the library."""

import pickle
import re
import subprocess

import numpy as np
import pytest

import cairn
from conftest import same_frame


def test_options_equal_those_of_the_command(command):
    table = subprocess.run([command, "config", "--markdown"], capture_output=True, text=True, check=True).stdout
    listed = re.findall(r"^\| `(.*?)` \| (?:`(.*?)`)? ?\| (.*?) \| (.*?) \| (.*?) \|(?: `(.*?)`)? \|$", table.replace(r"\|", "¦"), re.M)
    options = cairn.options()
    assert [row[0] for row in listed] == [o.name for o in options]
    assert [(row[2], row[3].replace("¦", "|"), row[4].replace("¦", "|"), row[5]) for row in listed] == [
        (o.unit, o.range, o.help, o.needs) for o in options
    ]
    by_name = {o.name: o for o in options}
    assert by_name["match.num_disparities"].default == 64
    assert by_name["match.cost"].default == "zncc" and by_name["match.cost"].type == "choice"
    assert by_name["ground.label_floor"].default is True
    assert by_name["match.num_disparities"].group == "match"
    assert "num_disparities" in repr(by_name["match.num_disparities"])
    paper = {o.name: o.default for o in cairn.options("paper")}
    assert paper["match.method"] == "window" and by_name["match.method"].default == "semi_global"


def test_docstrings_list_the_options():
    for option in cairn.options():
        line = f"{option.name.split('.')[1]} = "
        assert line in cairn.segment.__doc__ and option.help in cairn.segment.__doc__
    assert "window_size = 9 px (3 … 31, odd, read while match.method=window)" in cairn.match.__doc__
    assert "speckle" not in cairn.match.__doc__


def test_a_config_is_preset_then_file_then_keywords(tmp_path):
    file = tmp_path / "config.yaml"
    file.write_text("match:\n  window_size: 11\n  row_band: 1\n")
    config = cairn.Config("paper", file, match={"row_band": 2})
    assert (config["match.method"], config["match.window_size"], config["match.row_band"]) == ("window", 11, 2)
    assert repr(config) == "Config('paper', match={'window_size': 11, 'row_band': 2})"
    assert eval(repr(config), {"Config": cairn.Config}) == config
    assert cairn.Config(**config.as_dict()) == config
    file.write_text("preset: paper\n" + config.yaml())
    assert cairn.Config(file=file) == config and cairn.Config(file=file).preset == "paper"
    assert cairn.Config() != cairn.Config("paper")
    with pytest.raises(cairn.Error, match="did you mean 'match.window_size'"):
        config["match.window_sise"]


def test_values_may_be_of_any_fitting_type():
    config = cairn.Config(
        "paper",
        match={"window_size": np.int64(11), "cost": "sad"},
        left_right={"max_diff": np.float32(0.1)},
        ground={"label_floor": np.bool_(False)},
    )
    assert config["match.window_size"] == 11 and config["match.cost"] == "sad"
    assert config["left_right.max_diff"] == 0.1 and config["ground.label_floor"] is False


@pytest.mark.parametrize("preset", cairn.preset_names())
def test_an_option_without_effect_is_refused(preset, tmp_path):
    options = cairn.options(preset)
    active = [o for o in options if o.active]
    assert len(active) <= 40 and len({o.unit for o in active if o.unit}) <= 10
    as_dict = cairn.Config(preset).as_dict()
    assert [f"{group}.{name}" for group, values in as_dict.items() for name in values] == [o.name for o in active]
    for option in options:
        name = option.name.split(".")[1]
        if option.active:
            cairn.Config(preset, **{option.group: {name: option.default}})
            continue
        assert option.needs and f"needs='{option.needs}', active=False" in repr(option)
        with pytest.raises(cairn.Error, match=f"^{option.name} has no effect with .*; set .* first$"):
            cairn.Config(preset, **{option.group: {name: option.default}})
    file = tmp_path / "config.yaml"
    file.write_text("match.cost: sad\n")
    assert cairn.Config("default", file, match={"method": "window"})["match.cost"] == "sad"
    with pytest.raises(cairn.Error, match="line 1: match.cost has no effect"):
        cairn.Config("default", file)


def test_a_calibrations_search_range_is_a_default(sample):
    frame = sample.frame
    assert frame.config["match.num_disparities"] == sample.calibration.num_disparities == 32
    given = cairn.segment(sample.left, sample.right, sample.calibration, match={"num_disparities": 40})
    assert given.config["match.num_disparities"] == 40
    by_config = cairn.segment(sample.left, sample.right, sample.calibration, config=cairn.Config(match={"num_disparities": 64}))
    assert by_config.config["match.num_disparities"] == 64
    inherited = cairn.segment(sample.left, sample.right, sample.calibration, config=cairn.Config(speckle={"size": 50}))
    assert same_frame(inherited, frame)
    rig_only = cairn.segment(sample.left, sample.right, sample.calibration.rig)
    assert rig_only.config["match.num_disparities"] == 64


def test_unknown_options_are_refused(sample):
    with pytest.raises(TypeError, match="no keyword argument 'window_size'"):
        cairn.segment(sample.left, sample.right, window_size=9)
    with pytest.raises(cairn.Error, match="options match: found 9, expected a dict"):
        cairn.segment(sample.left, sample.right, match=9)
    with pytest.raises(cairn.Error, match="unknown option 'match.windowsize', did you mean 'match.window_size'"):
        cairn.match(sample.left, sample.right, windowsize=9)
    with pytest.raises(cairn.Error, match="unknown preset 'papr'.*did you mean 'paper'"):
        cairn.segment(sample.left, sample.right, preset="papr")
    with pytest.raises(cairn.Error, match="config: found 3"):
        cairn.segment(sample.left, sample.right, config=3)
    with pytest.raises(cairn.Error, match="preset: found 'paper' together with a config"):
        cairn.segment(sample.left, sample.right, preset="paper", config=cairn.Config())
    with pytest.raises(cairn.Error, match="rig: found 'calib.txt'"):
        cairn.segment(sample.left, sample.right, "calib.txt")
    with pytest.raises(cairn.Error, match="exec: found 2"):
        cairn.segment(sample.left, sample.right, exec=2)


def test_exec_never_changes_a_result(sample):
    for exec in [cairn.Exec(1), cairn.Exec(3), *(cairn.Exec(2, name) for name in cairn.supported_targets())]:
        assert same_frame(cairn.segment(sample.left, sample.right, sample.calibration, exec=exec), sample.frame)
    assert cairn.Exec(3).threads in (1, 3)
    with pytest.raises(cairn.Error, match="target: unknown instruction set 'axv2'.*did you mean 'avx2'"):
        cairn.Exec(target="axv2")
    with pytest.raises(cairn.Error, match="threads: found -1"):
        cairn.Exec(-1)


def test_a_device_never_changes_a_result(sample):
    assert cairn.Exec().device == "off"
    with pytest.raises(cairn.Error, match="device nonsense: "):
        cairn.Exec(device="nonsense")
    try:
        on_device = cairn.Exec(1, device="0")
    except cairn.Error as error:
        pytest.skip(str(error))  # without Vulkan, or without a driver
    assert on_device.device != "off"
    assert pickle.loads(pickle.dumps(on_device)).device == on_device.device
    assert same_frame(cairn.segment(sample.left, sample.right, sample.calibration, exec=on_device), sample.frame)
    with pytest.warns(RuntimeWarning, match="match.method=window"):
        cairn.segment(sample.left, sample.right, preset="paper", exec=on_device)
