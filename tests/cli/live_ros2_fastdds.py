# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""live_ros2_fastdds.py COMMAND LISTENER SOURCE_DIR [FRAMES [FOLDER]]: checks that another implementation of DDS
receives every frame of `cairn live --ros2`, with the results of `cairn segment`."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

command, listener, source = sys.argv[1:4]
frames = int(sys.argv[4]) if len(sys.argv) > 4 else 300
sample = pathlib.Path(sys.argv[5] if len(sys.argv) > 5 else f"{source}/data/samples/four_in_a_row").resolve()
name = f"/t{os.getpid()}"
environment = dict(os.environ, ROS_DOMAIN_ID=str(1 + os.getpid() % 100), ROS_LOCALHOST_ONLY="1")
for variable in ("CYCLONEDDS_URI", "ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE"):
    environment.pop(variable, None)


def lines(text):
    return [json.loads(line) for line in text.splitlines()]


with tempfile.TemporaryDirectory() as folder:
    # Extra frames: the first ones are published before the two have discovered each other.
    early = 30
    for index in range(frames + early):
        (pathlib.Path(folder) / f"{index:04d}").symlink_to(sample)
    truth = json.loads(subprocess.run(
        [command, "segment", str(sample / "left.png"), str(sample / "right.png"), "--calib", str(sample / "calib.txt"),
         "--json"], capture_output=True, check=True).stdout)
    with open(f"{folder}/heard", "w+", encoding="utf-8") as heard_file:
        peer = subprocess.Popen([listener, name], stdout=heard_file, env=environment)
        time.sleep(1)
        run = subprocess.run([command, "live", folder, "--no-tracks", "--every-frame", "--rate", "30", "--json-lines",
                              "--ros2", name], capture_output=True, text=True, env=environment, check=False)
        time.sleep(1)
        peer.terminate()
        peer.wait()
        heard_file.seek(0)
        heard = lines(heard_file.read())
print(run.stderr, end="")
assert run.returncode == 0, run.stderr
printed = [line["stamp_ns"] for line in lines(run.stdout)]
assert len(printed) == frames + early

by_topic = {topic: [message for message in heard if message["topic"] == topic]
            for topic in ("objects", "disparity", "grid")}
placed = [thing for thing in truth["objects"] if "position_m" in thing and thing["position_m"] is not None]
assert placed, "the sample has objects"
for topic, messages in by_topic.items():
    stamps = [message["stamp_ns"] for message in messages]
    expected = printed[printed.index(stamps[0]):] if stamps else []
    assert stamps == expected, f"{topic}: {len(stamps)} of {len(expected)} came"
    assert len(stamps) >= frames, f"{topic}: {len(stamps)} came, expected {frames}"
    print(f"{topic}: {len(stamps)} messages in a row, none lost")

for message in by_topic["objects"]:
    assert message["frame_id"] == "cairn_camera"
    assert len(message["objects"]) == len(placed)
    for found, thing in zip(message["objects"], placed):
        assert found["id"] == str(thing["id"]) and found["class"] == "object"
        assert abs(found["score"] - thing["confidence"]) < 1e-5
        assert all(abs(a - b) < 1e-5 for a, b in zip(found["position"], thing["position_m"]))
        assert all(abs(a - b) < 1e-5 for a, b in zip(found["size"], thing["extent_m"]))
first = by_topic["disparity"][0]
assert (first["width"], first["height"]) == (truth["image"]["width"], truth["image"]["height"])
assert abs(first["f"] - truth["rig"]["focal_px"]) < 1e-3 and abs(first["t"] - truth["rig"]["baseline_m"]) < 1e-6
assert first["encoding"] == "32FC1" and 0 < first["holes"] < first["width"] * first["height"] / 2
for message in by_topic["disparity"]:
    assert (message["holes"], message["sum"]) == (first["holes"], first["sum"])
for message in by_topic["grid"]:
    assert message["frame_id"] == "cairn_floor" and message["occupied"] > 0
