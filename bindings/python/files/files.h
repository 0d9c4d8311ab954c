// Shared by the files of this module: numbers go to Python as arrays, structures as their bytes.
#pragma once
#include <pybind11/numpy.h>

#include <cstring>
#include <vector>

namespace pellucid::python {

namespace py = pybind11;

template <class T>
py::bytes bytesOf(const T& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

// A copy.
template <class T>
py::array_t<T> array(const std::vector<T>& values, std::vector<py::ssize_t> shape) {
    py::array_t<T> result(std::move(shape));
    if (!values.empty()) std::memcpy(result.mutable_data(), values.data(), values.size() * sizeof(T));
    return result;
}

void bindGltf(py::module_& module);  // and profiles from files
void bindScene(py::module_& module);

}  // namespace pellucid::python
