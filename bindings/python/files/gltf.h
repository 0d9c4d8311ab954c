#pragma once
#include <pybind11/pybind11.h>

namespace pellucid::python {

namespace py = pybind11;

// Profiles from files and glTF scenes.
void bindGltf(py::module_& module);

}  // namespace pellucid::python
