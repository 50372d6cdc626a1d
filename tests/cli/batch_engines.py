# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""batch_engines.py CAIRN SOURCE_DIR [ENGINE...]: checks that a batch run gives the same rows with every engine in
examples/batch as with a single worker. Engines that are not installed are skipped (apt: parallel, snakemake,
python3-distributed; slurm-wlm munge iproute2, for root: a one-node cluster in a network namespace). Exit code 77: all
skipped."""
import hashlib
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

SHARDS = 4
cairn, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()


class Skipped(Exception):
    pass


def run(*command, **options):
    """The program's output; on failure, an exception with it."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300, **options)
    assert done.returncode == 0, f"{command}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def needs(*programs):
    for program in programs:
        if not shutil.which(program):
            raise Skipped(f"no {program}")


def planned(folder):
    run(cairn, "batch", "plan", source / "data" / "samples", source / "data/sequences/rolling_ball", "-o", folder / "run")
    return folder / "run"


def merged(run_folder):
    """The digest of the rows, as printed by the command and as computed here."""
    rows = run_folder.parent / "rows.jsonl"
    said = run(cairn, "batch", "merge", run_folder, "-o", rows).split()[0]
    assert said == hashlib.sha256(rows.read_bytes()).hexdigest()
    return said


def one_worker(folder):
    run(cairn, "batch", "work", planned(folder))
    return merged(folder / "run")


def parallel(folder):
    needs("parallel")
    run(source / "examples/batch/parallel.sh", planned(folder), SHARDS)
    return merged(folder / "run")


def snakemake(folder):
    needs("snakemake")
    run("snakemake", "-s", source / "examples/batch/Snakefile", "--cores", "2", "--config", f"run={planned(folder)}",
        f"shards={SHARDS}", f"cairn={cairn}", cwd=folder)
    result = (folder / "run/result.jsonl").read_bytes()
    assert hashlib.sha256(result).hexdigest() == merged(folder / "run")
    return merged(folder / "run")


def dask(folder):
    if not importlib.util.find_spec("distributed"):
        raise Skipped("no python3-distributed")
    printed = run(sys.executable, source / "examples/batch/with_dask.py", planned(folder), SHARDS)
    assert printed.count("shard ") == SHARDS, printed
    return merged(folder / "run")


def slurm(folder):
    needs("slurmctld", "slurmd", "sbatch", "munged", "ip", "unshare")
    if os.geteuid() != 0:
        raise Skipped("a cluster of its own needs root")
    if subprocess.run(["unshare", "--net", "--uts", "--mount", "--pid", "--fork", "true"], capture_output=True).returncode:
        raise Skipped("no namespaces here")
    planned(folder)
    # The daemons end with the first process of the namespace.
    run("unshare", "--net", "--uts", "--mount", "--pid", "--fork", "--mount-proc", sys.executable, __file__, cairn, source,
        "--inside", folder)
    return merged(folder / "run")


# ---- a cluster of one node ----

CONFIG = """
ClusterName=test
SlurmctldHost=node(10.99.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
MailProg=/bin/true
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName=node NodeAddr=10.99.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=node Default=YES State=UP
"""


def until(what, is_so, seconds=120):
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, f"in {seconds} s not: {what}"
        time.sleep(0.3)


def start_cluster(folder):
    run("hostname", "node")
    run("ip", "link", "set", "lo", "up")
    run("ip", "address", "add", "10.99.0.1/24", "dev", "lo")  # with 127.0.0.1 alone no name is looked up
    (folder / "hosts").write_text("127.0.0.1 localhost\n10.99.0.1 node\n")
    run("mount", "--bind", folder / "hosts", "/etc/hosts")
    for name in ("munge", "state", "spool"):
        (folder / name).mkdir(mode=0o755)
    key = folder / "munge/key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o600)
    folder.chmod(0o755)
    run("munged", "--force", "--key-file", key, "--socket", folder / "munge/socket", "--pid-file", folder / "munge/pid",
        "--log-file", folder / "munge/log", "--seed-file", folder / "munge/seed")
    (folder / "slurm.conf").write_text(CONFIG.format(folder=folder))
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    # Output goes to files: reading a pipe would block until the daemons end.
    with open(folder / "daemons.log", "w") as log:
        for daemon in ("slurmctld", "slurmd"):
            subprocess.run([daemon], check=True, stdout=log, stderr=log)
    until("the node is idle", lambda: "idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True).stdout)


def inside(folder):
    """Cancels a task of an array, then submits the same line again: only that task's shard is processed."""
    start_cluster(folder)
    os.environ["CAIRN"] = str(cairn)
    os.chdir(folder)
    submit = ["sbatch", "--parsable", f"--array=1-{SHARDS}", source / "packaging/slurm/cairn.sbatch", folder / "run"]
    job = run(submit[0], "--hold", *submit[1:]).strip()
    run("scancel", f"{job}_3")
    run("scontrol", "release", job)
    until("the array has ended", lambda: not run("squeue", "-h").strip())
    parts = folder / "run/parts"
    first = {part.name: part.stat().st_mtime_ns for part in parts.iterdir()}
    assert sorted(first) == [f"part-{k}-of-{SHARDS}.jsonl" for k in (1, 2, 4)], first
    incomplete = subprocess.run([cairn, "batch", "merge", folder / "run", "-o", folder / "rows"], capture_output=True, text=True)
    assert incomplete.returncode == 3 and "missing" in incomplete.stderr, incomplete
    run(submit[0], "--wait", *submit[1:])
    again = {part.name: part.stat().st_mtime_ns for part in parts.iterdir()}
    assert len(again) == SHARDS and first.items() <= again.items(), (first, again)


def main(names):
    engines = {engine.__name__: engine for engine in (parallel, snakemake, dask, slurm)}
    wrong = skipped = 0
    with tempfile.TemporaryDirectory() as scratch:
        home = pathlib.Path(scratch)
        os.environ.update(HOME=scratch, XDG_CACHE_HOME=scratch, CAIRN=str(cairn))
        expected = one_worker(home / "alone")
        print(f"one worker: {expected}")
        for name in names or engines:
            folder = home / name
            folder.mkdir()
            begun = time.monotonic()
            try:
                digest = engines[name](folder)
            except Skipped as why:
                print(f"{name}: skipped: {why}")
                skipped += 1
                continue
            print(f"{name}: {digest}, {time.monotonic() - begun:.1f} s")
            wrong += digest != expected
    return 1 if wrong else 77 if skipped == len(names or engines) else 0


if __name__ == "__main__":
    if sys.argv[3:4] == ["--inside"]:
        inside(pathlib.Path(sys.argv[4]))
    else:
        sys.exit(main(sys.argv[3:]))
