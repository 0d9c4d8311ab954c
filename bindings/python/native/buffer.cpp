#include "progress.h"

namespace pel::python {

void bindBuffer(py::module_& module) {
    using pellucid::Buffer;
    const auto made = [](const std::function<PelError(PelBuffer*)>& create) {
        PelBuffer handle = nullptr;
        call([&] { return create(&handle); });
        return Buffer(handle);
    };
    py::class_<Buffer, Owner<Buffer>>(module, "Buffer")
        .def_static("create",
                    [made](const Device& d, size_t bytes, uintptr_t initial) {
                        return made([&](PelBuffer* out) {
                            return pelBufferCreate(d.handle.get(), bytes, pointer(initial), out);
                        });
                    })
        .def_static("from_host",
                    [made](const Device& d, uintptr_t memory, size_t bytes) {
                        return made([&](PelBuffer* out) {
                            return pelBufferCreateFromHost(d.handle.get(), pointer(memory), bytes, out);
                        });
                    })
        .def_static("from_cl",
                    [made](const Device& d, uintptr_t mem) {
                        return made([&](PelBuffer* out) {
                            return pelBufferCreateFromCl(d.handle.get(), pointer(mem), out);
                        });
                    })
        .def("size",
             [](const Buffer& b) {
                 size_t bytes = 0;
                 call([&] { return pelBufferGetSize(b.get(), &bytes); });
                 return bytes;
             })
        .def("cl",
             [](const Buffer& b) {
                 void* mem = nullptr;
                 call([&] { return pelBufferGetCl(b.get(), &mem); });
                 return address(mem);
             })
        .def("read",
             [](const Buffer& b, size_t offset, size_t bytes, uintptr_t to, const Waits& waits) {
                 return submitted(waits, [&](const PelSubmit* submit) {
                     return pelBufferRead(b.get(), offset, bytes, pointer(to), submit);
                 });
             })
        .def("write",
             [](const Buffer& b, size_t offset, size_t bytes, uintptr_t from, const Waits& waits) {
                 return submitted(waits, [&](const PelSubmit* submit) {
                     return pelBufferWrite(b.get(), offset, bytes, pointer(from), submit);
                 });
             })
        .def("map",
             [](const Buffer& b) {
                 void* memory = nullptr;
                 call([&] { return pelBufferMap(b.get(), &memory); });
                 return address(memory);
             })
        .def("unmap", [](const Buffer& b) { call([&] { return pelBufferUnmap(b.get()); }); });
}

}  // namespace pel::python
