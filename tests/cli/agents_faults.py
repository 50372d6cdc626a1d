#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""agents_faults.py CAIRN SOURCE_DIR [--full]: what agents (docs/agents.md) do when one is killed or hangs, or the network
fails, with two network namespaces as two computers; and what sharing costs. Prints a table, and fails where a result is
wrong or a time is more than ten times what is asked. Needs root and the data collection; else exit code 77. --full: more
kills, and ten minutes under load."""
import contextlib
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

HERE, THERE = "cairn_here", "cairn_there"
SLACK = 10
LANDMARKS = 2000


class Table:
    def __init__(self):
        self.wrong = []

    def row(self, what, found, asked, is_right):
        print(f"| {what} | {found} | {asked} |{'' if is_right else ' **wrong**'}", flush=True)
        if not is_right:
            self.wrong.append(what)


class Fleet:
    """The processes of one trial; those of `network` THERE are on the other computer."""

    def __init__(self, cairn, folder):
        self.cairn, self.folder, self.processes = cairn, folder, {}

    def start(self, name, network, *arguments, **environment):
        interface = "here0" if network == HERE else "there0"
        log = open(self.folder / f"{name}.out", "w"), open(self.folder / f"{name}.err", "w")
        command = ["ip", "netns", "exec", network, self.cairn, *map(str, arguments), "--fleet-interface", interface]
        self.processes[name] = subprocess.Popen(command, stdout=log[0], stderr=log[1], cwd=self.folder,
                                                env=dict(os.environ, **environment))
        return self.processes[name]

    def robot(self, name, network, source, **environment):
        return self.start(name, network, "live", source, "--loop", "--every-frame", "--map", f"{name}.db", "--share", name,
                          **environment)

    def map(self, network, **environment):
        return self.start("map", network, "agent", "map", "fleet.db", **environment)

    def watch(self, network, **environment):
        return self.start("watch", network, "agent", "watch", "--json-lines", **environment)

    def end(self, name, how=signal.SIGTERM):
        process = self.processes.pop(name)
        process.send_signal(how)
        return process.wait(60)

    def close(self):
        for name in list(self.processes):
            self.end(name, signal.SIGKILL)

    def lines(self):
        lines = []
        for line in open(self.folder / "watch.out"):
            with contextlib.suppress(json.JSONDecodeError):  # half written
                lines.append(json.loads(line))
        return lines

    def state(self, name):
        lines = self.lines()
        states = [agent["state"] for agent in (lines[-1]["agents"] if lines else []) if agent["name"] == name]
        return states[-1] if states else ""

    def landmarks(self, name):
        lines = self.lines()
        known = [robot["landmarks"] for robot in (lines[-1]["robots"] if lines else []) if robot["name"] == name]
        return known[0] if known else 0

    def is_alive(self, name):
        return self.state(name) in ("ok", "warning", "error")


def seconds_until(condition, limit):
    """How long it takes until the condition holds; infinite after the limit."""
    began = time.monotonic()
    while time.monotonic() - began < limit:
        if condition():
            return time.monotonic() - began
        time.sleep(0.05)
    return float("inf")


def run(*command):
    subprocess.run([str(word) for word in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@contextlib.contextmanager
def two_computers():
    def clear():
        for network in (HERE, THERE):
            subprocess.run(["ip", "netns", "del", network], stderr=subprocess.DEVNULL, check=False)
    clear()
    for network in (HERE, THERE):
        run("ip", "netns", "add", network)
        run("ip", "-n", network, "link", "set", "lo", "up")
    run("ip", "link", "add", "here0", "netns", HERE, "type", "veth", "peer", "name", "there0", "netns", THERE)
    for network, link, address in ((HERE, "here0", "10.213.7.1/24"), (THERE, "there0", "10.213.7.2/24")):
        run("ip", "-n", network, "address", "add", address, "dev", link)
        run("ip", "-n", network, "link", "set", link, "up")
    try:
        yield
    finally:
        clear()


def large_map(path, count):
    """Copies the landmarks of a map, side by side, until there are so many; in far places, so that none is in view."""
    with sqlite3.connect(path) as file:
        columns = [row[1] for row in file.execute("PRAGMA table_info(landmark)")]
        others = ", ".join(column for column in columns if column not in ("id", "x", "y"))
        known = [row[0] for row in file.execute("SELECT id FROM landmark ORDER BY id")]
        for i in range(count - len(known)):
            source, new = known[i % len(known)], 1000 + i
            file.execute(f"INSERT INTO landmark(id, x, y, {others}) SELECT ?, x + ?, y + ?, {others} FROM landmark "
                         "WHERE id = ?", (new, 200 + 7 * (i % 50), 200 + 7 * (i // 50), source))
            file.execute("INSERT INTO look SELECT ?, octant, hist, NULL, pixels FROM look WHERE landmark = ?", (new, source))


def mapped(cairn, source, path, count):
    """A map of the source, filled up to `count` landmarks."""
    run(cairn, "follow", source, "--map", path)
    if count > 0:
        large_map(path, count)


def content(path):
    """The landmarks of a map, without ids and crops."""
    with sqlite3.connect(path) as file:
        return sorted(file.execute("SELECT round(x, 9), round(y, 9), round(z, 9), seen, expected, log_odds FROM landmark"))


def faults(cairn, source, table, full):
    with tempfile.TemporaryDirectory() as place:
        fleet = Fleet(cairn, pathlib.Path(place))
        mapped(cairn, source, fleet.folder / "a.db", 0)
        fleet.watch(HERE)
        fleet.map(HERE)
        fleet.robot("a", THERE, source)
        wait = seconds_until(lambda: fleet.landmarks("a") > 0, 60)
        table.row("robot on another computer known to the map", f"{wait:.1f} s", "", wait < 60)

        noticed = []
        for _ in range(20 if full else 5):
            fleet.end("a", signal.SIGKILL)
            noticed.append(seconds_until(lambda: fleet.state("a") == "SILENT", 30))
            fleet.robot("a", THERE, source)
            if seconds_until(lambda: fleet.is_alive("a"), 60) == float("inf"):
                noticed.append(float("inf"))
        table.row(f"kill -9 of a robot noticed after ({len(noticed)} times)", f"{min(noticed):.2f} to {max(noticed):.2f} s",
                  "≤ 1.5 s", max(noticed) < 1.5 * SLACK)
        sound = subprocess.run([cairn, "map", "check", fleet.folder / "a.db"], stdout=subprocess.DEVNULL, check=False)
        table.row("its map file after that", "valid" if sound.returncode == 0 else "damaged", "valid", sound.returncode == 0)

        fleet.processes["a"].send_signal(signal.SIGSTOP)
        hang = seconds_until(lambda: fleet.state("a") == "SILENT", 30)
        fleet.processes["a"].send_signal(signal.SIGCONT)
        back = seconds_until(lambda: fleet.is_alive("a"), 30)
        table.row("stopped process noticed after; back after", f"{hang:.2f} s; {back:.2f} s", "≤ 1.5 s", hang < 1.5 * SLACK)

        before = fleet.landmarks("a")
        for _ in range(20 if full else 3):
            fleet.end("map", signal.SIGKILL)
            fleet.map(HERE)
            seconds_until(lambda: fleet.is_alive("map") and fleet.landmarks("a") >= before, 60)
        table.row("landmarks after kills of the map agent", fleet.landmarks("a"), f"≥ {before}",
                  fleet.landmarks("a") >= before)

        for cut in (3, 60):
            run("ip", "-n", THERE, "link", "set", "there0", "down")
            gone = seconds_until(lambda: fleet.state("a") == "SILENT", 30)
            time.sleep(max(0, cut - gone))
            run("ip", "-n", THERE, "link", "set", "there0", "up")
            healed = seconds_until(lambda: fleet.is_alive("a"), 60)
            table.row(f"{cut} s without network: noticed after; healed after", f"{gone:.2f} s; {healed:.2f} s",
                      "≤ 1.5 s; ≤ 2 s", gone < 1.5 * SLACK and healed < 2 * SLACK)
        fleet.end("a")
        time.sleep(3)
        fleet.end("map")
        equal = content(fleet.folder / "a.db") == content(fleet.folder / "fleet.db")
        table.row("the shared map after all of it", "equal" if equal else "different", "equal to the robot's", equal)
        fleet.close()


def many_rows(cairn, source, table):
    for lossy in (0, 10, 30):
        with tempfile.TemporaryDirectory() as place:
            fleet = Fleet(cairn, pathlib.Path(place))
            mapped(cairn, source, fleet.folder / "a.db", LANDMARKS)
            lost = {}
            if lossy:
                lost["CYCLONEDDS_URI"] = ("<CycloneDDS><Domain><Internal><Test><XmitLossiness>"
                                          f"{10 * lossy}</XmitLossiness></Test></Internal></Domain></CycloneDDS>")
            fleet.watch(HERE)
            fleet.robot("a", THERE, source, **lost)
            seconds_until(lambda: fleet.is_alive("a"), 60)
            time.sleep(3)
            fleet.map(HERE, **lost)
            # The map agent says once a second what it has.
            wait = seconds_until(lambda: fleet.landmarks("a") >= LANDMARKS, 300)
            asked = 30 if lossy else 3
            table.row(f"late map agent has {LANDMARKS} landmarks, {lossy} % of packets lost on both sides", f"{wait:.1f} s",
                      f"≤ {asked} s", wait < asked * SLACK)
            fleet.close()


def false_alarms(cairn, source, table, full):
    with tempfile.TemporaryDirectory() as place:
        fleet = Fleet(cairn, pathlib.Path(place))
        fleet.watch(HERE)
        fleet.map(HERE)
        fleet.robot("a", THERE, source)
        seconds_until(lambda: fleet.is_alive("a") and fleet.is_alive("map"), 60)
        burners = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(8)]
        seconds = 600 if full else 30
        time.sleep(seconds)
        alarms = sum(agent["state"] == "SILENT" for line in fleet.lines() for agent in line["agents"])
        for burner in burners:
            burner.kill()
            burner.wait()
        table.row(f"false alarms in {seconds} s with eight processes that compute", alarms, "0", alarms == 0)
        fleet.close()


def keys(cairn, root, source, table):
    """Agents with certificates see each other, and one without sees nobody."""
    if shutil.which("openssl") is None:
        return
    with tempfile.TemporaryDirectory() as place:
        fleet = Fleet(cairn, pathlib.Path(place))
        run(f"{root}/packaging/dds/fleet_keys.sh", fleet.folder / "keys", 40, "a", "map", "watch")
        settings = {name: {"CYCLONEDDS_URI": f"file://{fleet.folder}/keys/{name}/cyclonedds.xml"} for name in ("a", "map", "watch")}
        fleet.map(HERE, **settings["map"])
        fleet.robot("a", THERE, source, **settings["a"])
        seen = [subprocess.run(["ip", "netns", "exec", HERE, cairn, "agent", "watch", "--once", "--wait", "10", "--json-lines",
                                "--expect", "a", "--expect", "map", "--fleet-interface", "here0"], check=False,
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=dict(os.environ, **more)).stdout
                for more in (settings["watch"], {})]
        with_key, without = (len(json.loads(text)["agents"]) for text in seen)
        table.row("agents that a watch sees with a certificate; without", f"{with_key}; {without}", "2; 0",
                  (with_key, without) == (2, 0))
        fleet.close()


def cost(cairn, source, table):
    """Processor time of a run with and without sharing, in turn; a map agent and a watch listen."""
    latencies = {}

    def seconds_of(folder, *more):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        for name in ("x.db", "x.db-wal", "x.db-shm"):
            (folder / name).unlink(missing_ok=True)
        said = subprocess.run(["ip", "netns", "exec", HERE, cairn, "live", source, "--every-frame", "--map", folder / "x.db",
                               *more], check=True, capture_output=True, text=True).stderr
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        latencies.setdefault(len(more), []).append(float(re.search(r"from image to objects ([0-9.]+) ms", said)[1]))
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    with tempfile.TemporaryDirectory() as place:
        fleet = Fleet(cairn, pathlib.Path(place))
        fleet.watch(HERE)
        fleet.map(HERE)
        alone, shared = [], []
        for _ in range(5):
            alone.append(seconds_of(fleet.folder))
            began = time.monotonic()
            shared.append(seconds_of(fleet.folder, "--share", "x", "--fleet-interface", "here0"))
            length = time.monotonic() - began
        middle = lambda values: sorted(values)[len(values) // 2]
        extra = middle([s - a for s, a in zip(shared, alone)])
        table.row(f"processor time of sharing, of a core (runs of {length:.0f} s, five in turn)",
                  f"{100 * extra / length:.1f} %", "≤ 1 %", extra / length < 0.01 * SLACK)
        without, with_it = (middle(values) for values in latencies.values())
        table.row("median time from image to objects without and with sharing", f"{without:.1f}, {with_it:.1f} ms", "equal",
                  with_it < 1.5 * without)
        fleet.close()


def main():
    if os.geteuid() != 0 or shutil.which("ip") is None:
        print("skipped: needs root and ip (iproute2) for network namespaces")
        return 77
    full = "--full" in sys.argv
    cairn, root = [os.path.abspath(word) for word in sys.argv[1:] if not word.startswith("--")][:2]
    source = os.path.join(os.environ.get("CAIRN_DATA", f"{root}/../shared/data"), "rendered/tour_train")
    if not os.path.isdir(source):
        print(f"skipped: no {source}")
        return 77
    os.environ.pop("CYCLONEDDS_URI", None)
    table = Table()
    try:
        with two_computers():
            print("| what | found | asked |\n|---|---|---|")
            faults(cairn, source, table, full)
            many_rows(cairn, source, table)
            keys(cairn, root, source, table)
            false_alarms(cairn, source, table, full)
            cost(cairn, source, table)
    except subprocess.CalledProcessError as error:
        if error.cmd[0] == "ip":
            print("skipped: no network namespaces here")
            return 77
        raise
    for what in table.wrong:
        print(f"wrong: {what}", file=sys.stderr)
    return 1 if table.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
