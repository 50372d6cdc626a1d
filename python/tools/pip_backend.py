# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Backend of `pip install .` (PEP 517, see pyproject.toml): CMake builds and installs the module; a wheel is a zip file.

Downloads nothing; the library's dependencies (docs/install.md) must be installed. CMAKE_ARGS in the environment is
passed to CMake. Why no existing backend is used: docs/decisions/dependencies.md.
"""

import base64
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROJECT = re.search(r'project\(cairn VERSION (\S+).*?DESCRIPTION "(.*?)"', (SOURCE / "CMakeLists.txt").read_text(), re.S)
VERSION, SUMMARY = PROJECT.groups()


def metadata():
    head = ["Metadata-Version: 2.1", "Name: cairn", f"Version: {VERSION}", f"Summary: {SUMMARY}", "License: Apache-2.0",
            "Requires-Python: >=3.9", "Requires-Dist: numpy", "Description-Content-Type: text/markdown"]
    return "\n".join(head) + "\n\n" + (SOURCE / "README.md").read_text()


def run(*command):
    print("+", shlex.join(map(str, command)), flush=True)
    subprocess.run(command, check=True, cwd=SOURCE)


def installed_package(folder, tag):
    """Builds the module for the running Python and installs only it into the folder."""
    if not shutil.which("cmake"):
        raise SystemExit("cairn: found no cmake, expected 3.25 or later; docs/install.md lists the other dependencies")
    build = SOURCE / "build" / f"pip-{tag}"
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    run("cmake", "-S", SOURCE, "-B", build, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DCAIRN_PYTHON=ON",
        f"-DPython_EXECUTABLE={sys.executable}", "-DCAIRN_PYTHON_DIR=.", "-DCAIRN_TESTS=OFF", "-DCAIRN_EXAMPLES=OFF",
        *shlex.split(os.environ.get("CMAKE_ARGS", "")))
    run("cmake", "--build", build, "--target", "cairn_python", "--parallel", str(os.cpu_count() or 1))
    run("cmake", "--install", build, "--component", "python", "--prefix", folder, "--strip")


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Optional in PEP 517; without it pip would build twice to learn the name."""
    info = pathlib.Path(metadata_directory) / f"cairn-{VERSION}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(metadata())
    return info.name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    tag = f"{version}-{version}-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    name = f"cairn-{VERSION}"
    record = []
    with tempfile.TemporaryDirectory() as scratch, zipfile.ZipFile(
        pathlib.Path(wheel_directory) / f"{name}-{tag}.whl", "w", zipfile.ZIP_DEFLATED
    ) as wheel:
        installed_package(scratch, tag)
        files = {str(f.relative_to(scratch)): f.read_bytes() for f in sorted(pathlib.Path(scratch).rglob("*")) if f.is_file()}
        files[f"{name}.dist-info/METADATA"] = metadata().encode()
        files[f"{name}.dist-info/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: cairn\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
        files[f"{name}.dist-info/LICENSE"] = (SOURCE / "LICENSE").read_bytes()
        for path, content in files.items():
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{path},sha256={digest},{len(content)}\n")
            wheel.writestr(path, content)
        wheel.writestr(f"{name}.dist-info/RECORD", "".join(record) + f"{name}.dist-info/RECORD,,\n")
    return f"{name}-{tag}.whl"
