// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include "bindings.hpp"

namespace py = pybind11;

namespace cairn::python {

/// Replaces follow.cpp in a build without sequences.
void bind_follow(py::module_& m) {
  for (const char* name : {"Follower", "follow", "follow_options"}) {
    m.def(
        name,
        [name](const py::args&, const py::kwargs&) {
          throw Error(std::string("cairn.") + name +
                      ": this cairn was built without sequences; they need OpenCV's video and calib3d, "
                      "Eigen, dlib and SQLiteCpp (docs/install.md)");
        },
        "Is not in this build: it has no sequences.");
  }
}

}  // namespace cairn::python
