# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""agents_fastdds.py COMMAND LISTENER SOURCE_DIR: checks that another implementation of DDS, with types of its own
generator, receives the rows of a robot by their keys, and the view of the shared map."""
import json
import os
import pathlib
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

command, listener, root = sys.argv[1:4]
domain = str(1 + os.getpid() % 100)
environment = dict(os.environ, ROS_DOMAIN_ID=domain, ROS_LOCALHOST_ONLY="1")
for variable in ("CYCLONEDDS_URI", "ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE"):
    environment.pop(variable, None)
source = f"{root}/data/sequences/rolling_ball"
COUNT = 30


def add_landmarks(path):
    hist = struct.pack("72f", 1, *[0] * 7, 1, *[0] * 63)
    covariance = struct.pack("9d", 1e-3, 0, 0, 0, 1e-3, 0, 0, 0, 1e-3)
    with sqlite3.connect(path) as file:
        for i in range(1, COUNT + 1):
            file.execute("INSERT INTO landmark VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
                         (i, 100.0 + i, i / 2, 0.25, covariance, 0.3, 0.4, 0.5, 0.25, 3.0, "present", "", i, i, 0, 0.0, 0, 0, 1))
            file.execute("INSERT INTO look VALUES(?,?,?,NULL,?)", (i, i % 8, hist, 500))


with tempfile.TemporaryDirectory() as place:
    folder = pathlib.Path(place)
    subprocess.run([command, "follow", source, "--map", folder / "a.db"], check=True, stdout=subprocess.DEVNULL)
    add_landmarks(folder / "a.db")
    robot = subprocess.Popen([command, "live", source, "--loop", "--map", folder / "a.db", "--share", "a", "--fleet-domain",
                              domain], stderr=subprocess.DEVNULL)
    agent = subprocess.Popen([command, "agent", "map", folder / "fleet.db", "--fleet-domain", domain],
                             stderr=subprocess.DEVNULL)
    time.sleep(4)  # so the listener is late
    with open(folder / "heard", "w+", encoding="utf-8") as heard_file:
        peer = subprocess.Popen([listener, "/cairn"], stdout=heard_file, env=environment)
        time.sleep(5)
        for process in (peer, robot, agent):
            process.terminate()
            process.wait()
        heard_file.seek(0)
        heard = [json.loads(line) for line in heard_file.read().splitlines()]

rows = [row for row in heard if row["topic"] == "rows"]
assert {row["id"] for row in rows} == set(range(1, COUNT + 1)), f"{len(rows)} rows came"
for row in rows:
    assert row["robot"] == "a" and row["looks"] == 1
    assert row["position"] == [100 + row["id"], row["id"] / 2, 0.25] and row["seen"] == row["id"]
maps = [message for message in heard if message["topic"] == "map"]
assert maps and len(maps[-1]["objects"]) == COUNT, "the view of the shared map did not come"
print(f"{len(rows)} rows of {COUNT} landmarks, {len(maps)} views of the shared map")
