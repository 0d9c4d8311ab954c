// The extension module pellucid._native.
#include "native.h"

using namespace pel::python;

PYBIND11_MODULE(_native, module) {
    module.doc() = "The C interface, for the Python files of this package alone.";
    py::register_exception_translator([](std::exception_ptr pending) {
        try {
            if (pending) std::rethrow_exception(pending);
        } catch (const CallError& e) {
            const py::object type = py::module_::import("pellucid._errors").attr("PellucidError");
            PyErr_SetObject(type.ptr(), type(int(e.code), e.message).ptr());
        }
    });
    module.def("version", &pelVersion);
    module.def("error_name", [](int code) { return pelErrorName(PelError(code)); });
    bindStructs(module);
    bindDevice(module);
    bindBuffer(module);
    bindMesh(module);
    bindProfile(module);
    bindScatter(module);
    bindTextureScatter(module);
    bindLut(module);
    bindShader(module);
    bindCompare(module);
    bindBatch(module);
}
