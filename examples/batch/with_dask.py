# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""with_dask.py RUN [SHARDS [SCHEDULER]]: a batch run with Dask. Without a scheduler's address the workers are
processes on this machine."""
import os
import subprocess
import sys

from dask.distributed import Client, as_completed


def work(run, shard, shards):
    command = [os.environ.get("CAIRN", "cairn"), "batch", "work", run, "--shard", f"{shard}/{shards}", "--threads", "1"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main(run, shards=8, scheduler=None):
    shards = int(shards)
    options = {"address": scheduler} if scheduler else {"threads_per_worker": 1, "dashboard_address": None}
    with Client(**options) as client:
        # Pure: retrying or resubmitting a shard is the same task.
        tasks = [client.submit(work, os.path.abspath(run), shard, shards, retries=2) for shard in range(1, shards + 1)]
        for task in as_completed(tasks):
            print(task.result(), end="", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
