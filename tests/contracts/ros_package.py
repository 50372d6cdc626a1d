# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""ros_package.py SOURCE_DIR: checks that ros2 is a valid ROS package, and that it depends on
everything that its sources include and its CMakeLists.txt finds. Exit code 77 (skipped) without
python3-catkin-pkg."""
import pathlib
import re
import sys

try:
    from catkin_pkg.package import parse_package
except ImportError:
    print("skipped: no python3-catkin-pkg")
    sys.exit(77)

folder = pathlib.Path(sys.argv[1]) / "ros2"
warnings = []
package = parse_package(str(folder / "package.xml"), warnings=warnings)
package.validate(warnings=warnings)
assert not warnings, warnings
assert package.name == "cairn_ros" and package.get_build_type() == "ament_cmake"
depends = {depend.name for depend in package.build_depends}

cmake = (folder / "CMakeLists.txt").read_text()
found = set(re.findall(r"find_package\((\w+)", cmake)) - {"ament_cmake", "cairn"}
assert found == depends, f"CMakeLists.txt finds {sorted(found)}, package.xml has {sorted(depends)}"

sources = list(folder.rglob("*.?pp"))
assert sources
for source in sources:
    for package_name in re.findall(r"#include <(\w+)/[\w/]+\.hp*>", source.read_text()):
        assert package_name in depends | {"cairn", "cairn_ros"}, f"{source.name} includes {package_name}"
version = re.search(r"VERSION (\S+)", (folder.parent / "CMakeLists.txt").read_text().split("project(cairn")[1]).group(1)
assert package.version == version, f"package.xml has {package.version}, expected {version}"
