// The extension module pellucid._native, with a table of the plain structures generated from pellucid.h.
#include "native.h"

using namespace pel::python;

namespace {
struct StructInfo {
    const char* name;
    size_t bytes;
    void (*defaults)(void* to);
    std::vector<std::pair<const char*, size_t>> offsets;
};
#include "structs.inc"

const StructInfo& find(const std::string& name) {
    for (const StructInfo& info : structInfos)
        if (name == info.name) return info;
    throw py::key_error(name);
}
}  // namespace

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
    module.def("struct_defaults", [](const std::string& name) {
        const StructInfo& info = find(name);
        std::string bytes(info.bytes, '\0');
        info.defaults(bytes.data());
        return py::bytes(bytes);
    });
    module.def("struct_offsets", [](const std::string& name) {
        py::dict offsets;
        for (const auto& [field, offset] : find(name).offsets) offsets[field] = offset;
        return offsets;
    });
    bindDevice(module);
    bindMesh(module);
    bindProfile(module);
    bindScatter(module);
    bindLut(module);
    bindShader(module);
    bindBatch(module);
}
