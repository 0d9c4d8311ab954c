// Defaults and layout of the plain structures, from a table generated from pellucid.h.
#include "native.h"

namespace pel::python {

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

void bindStructs(py::module_& module) {
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
}

}  // namespace pel::python
