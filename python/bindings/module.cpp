// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>

#include "bindings.hpp"

namespace py = pybind11;

PYBIND11_MODULE(_cairn, m) {
  py::register_exception<cairn::Error>(m, "Error", PyExc_ValueError);
  m.attr("__version__") = CAIRN_VERSION;
  cairn::python::bind_options(m);
  cairn::python::bind_values(m);
  cairn::python::bind_stages(m);
  cairn::python::bind_frame(m);
  cairn::python::bind_scores(m);
#ifdef CAIRN_PYTHON_FOLLOWS
  cairn::python::bind_follow(m);
#endif
}
