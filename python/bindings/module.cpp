// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <string>

#include "bindings.hpp"
#include "options.hpp"

namespace py = pybind11;

namespace {

/// Fails at import if numpy is missing, rather than with the first array.
void need_numpy() {
  try {
    py::module_::import("numpy");
  } catch (const py::error_already_set& error) {
    const auto python = py::str(py::module_::import("sys").attr("executable")).cast<std::string>();
    const auto why = py::str(error.value()).cast<std::string>();
    throw py::import_error("cairn needs numpy, and " + python + " cannot import it: " + why);
  }
}

}  // namespace

PYBIND11_MODULE(_cairn, m) {
  // The names shown to users, in error messages and help(), are those of the package.
  const py::object own_name = m.attr("__name__");
  m.attr("__name__") = "cairn";

  need_numpy();
  py::options docs;
  docs.disable_function_signatures();  // define() writes them in the format of the stubs
  py::register_exception<cairn::Error>(m, "Error", PyExc_ValueError);
  m.attr("Error").attr("__doc__") =
      "Bad input: what was found, what was expected, which argument, option or file. The command says the "
      "same.";
  const py::object both = py::make_tuple(m.attr("Error"), py::handle(PyExc_TypeError));
  py::register_exception<cairn::python::ArgumentError>(m, "ArgumentError", both);
  m.attr("ArgumentError").attr("__doc__") =
      "An Error that is a TypeError as well: an argument of a wrong type, one that there is not, or none "
      "where "
      "one is wanted.";
  m.attr("__version__") = CAIRN_VERSION;

  cairn::python::bind_options(m);
  cairn::python::bind_rig(m);
  cairn::python::bind_matching(m);
  cairn::python::bind_disparity(m);
  cairn::python::bind_ground(m);
  cairn::python::bind_regions(m);
  cairn::python::bind_grouping(m);
  cairn::python::bind_objects(m);
  cairn::python::bind_frame(m);
  cairn::python::bind_evaluation(m);
  cairn::python::bind_diagnosis(m);
  cairn::python::bind_tuning(m);
  cairn::python::bind_io(m);
  cairn::python::bind_follow(m);
  m.attr("__name__") = own_name;
}
