#include "native.h"

namespace pel::python {
namespace {
// The table, and the event of its integration.
template <class Desc, PelError (*Create)(PelDevice, const Desc*, PelLut*, const PelSubmit*)>
std::pair<pellucid::Lut, pellucid::Event> created(const Device& d, const py::object& desc,
                                                  const Waits& waits) {
    Argument<const PelSubmit*> submit(waits);
    pellucid::Lut lut = wrapped<pellucid::Lut>([&, what = structOf<Desc>(desc)](PelLut* handle) {
        return Create(d.get(), what, handle, submit.get());
    });
    return {std::move(lut), pellucid::Event(submit.done)};
}
}  // namespace

// The bytes of FaceWorks' description.
py::bytes faceworks(const std::string& name) {
    if (name == "PelCurvatureLutDesc") return bytesOf(pelCurvatureLutDescFaceWorks());
    if (name == "PelShadowLutDesc") return bytesOf(pelShadowLutDescFaceWorks());
    throw py::value_error(name + " has no preset of FaceWorks");
}

void bindLut(py::module_& module) {
    using pellucid::Lut;
    module.def("faceworks_defaults", &faceworks);
    py::class_<Lut, Owner<Lut>>(module, "Lut")
        .def_static("curvature", created<PelCurvatureLutDesc, pelCurvatureLutCreate>)
        .def_static("shadow", created<PelShadowLutDesc, pelShadowLutCreate>)
        .def_static("specular", created<PelSpecularLutDesc, pelSpecularLutCreate>)
        .def_static("eye", created<PelEyeLutDesc, pelEyeLutCreate>)
        .def_static("from_texels", maker<Lut>(pelLutCreateFromTexels))
        .def("info", structure<pelLutInfoDefaults>(pelLutGetInfo))
        .def("clipped", value<uint64_t>(pelLutCountClipped))
        .def("read", function(pelLutRead))
        .def_static("read_stack", [](const Device& d, uintptr_t tables, uint32_t count, uint32_t encoding,
                                     uintptr_t to, size_t bytes) {
            call([&] {
                return pelLutReadStack(d.get(), static_cast<const PelLutInfo*>(pointer(tables)), count,
                                       PelLutEncoding(encoding), pointer(to), bytes);
            });
        });
}

}  // namespace pel::python
