#pragma once
#include <pybind11/pybind11.h>

namespace pellucid::python {

namespace py = pybind11;

void bindScene(py::module_& module);

}  // namespace pellucid::python
