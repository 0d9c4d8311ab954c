#include "io/lut/bc6h.h"
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

// Blocks of three halves per texel, and what they cost.
py::tuple encodedBc6h(uint32_t width, uint32_t height, uintptr_t halves) {
    const std::span texels(static_cast<const uint16_t*>(pointer(halves)), size_t(width) * height * 3);
    std::vector<uint8_t> blocks;
    pellucid::io::TexelError error;
    call([&] {
        blocks = pellucid::io::encodeBc6h(width, height, texels, signalled);
        if (!blocks.empty())
            error = pellucid::io::differenceOf(texels, pellucid::io::decodeBc6h(width, height, blocks));
        return PEL_SUCCESS;
    });
    if (blocks.empty()) throw py::error_already_set();
    return py::make_tuple(py::bytes(reinterpret_cast<const char*>(blocks.data()), blocks.size()), error.max,
                          error.rms);
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
    module.def("encode_bc6h", &encodedBc6h);
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
