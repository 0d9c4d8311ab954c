// Shared by the files of this module: numbers go to Python as arrays, structures as their bytes.
#pragma once
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace pellucid::python {

namespace py = pybind11;

template <class T>
py::bytes bytesOf(const T& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

using Pixels = py::array_t<float, py::array::c_style | py::array::forcecast>;

// A copy.
template <class T>
py::array_t<T> array(const std::vector<T>& values, std::vector<py::ssize_t> shape) {
    py::array_t<T> result(std::move(shape));
    if (!values.empty()) std::memcpy(result.mutable_data(), values.data(), values.size() * sizeof(T));
    return result;
}

template <class T>
py::array_t<T> rows(const std::vector<T>& values, py::ssize_t columns) {
    return array(values, {py::ssize_t(values.size()) / columns, columns});
}

// Absent normals or texture coordinates are None.
inline py::dict toDict(const io::MeshData& mesh) {
    py::dict d;
    d["positions"] = rows(mesh.positions, 3);
    d["normals"] = mesh.normals.empty() ? py::object(py::none()) : rows(mesh.normals, 3);
    d["uvs"] = mesh.uvs.empty() ? py::object(py::none()) : rows(mesh.uvs, 2);
    d["triangles"] = rows(mesh.triangles, 3);
    d["warnings"] = mesh.warnings;
    return d;
}

void bindGltf(py::module_& module);  // and profiles from files
void bindScene(py::module_& module);

}  // namespace pellucid::python
