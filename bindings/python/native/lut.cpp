#include <memory>

#include "io/lut/bc6h.h"
#include "progress.h"

namespace pel::python {

namespace {
// The table, and the event of its integration.
template <class Desc, PelError (*Create)(PelDevice, const Desc*, PelLut*, const PelSubmit*)>
std::pair<pellucid::Lut, pellucid::Event> created(const Device& d, const py::object& desc, const Waits& waits) {
    const auto lut = std::make_shared<pellucid::Lut>();
    const pellucid::Event done = submitInterruptibly(
        waits, [lut, device = d.handle, what = *structOf<Desc>(desc)](const PelSubmit* submit) {
            PelLut handle = nullptr;
            const PelError error = Create(device.get(), &what, &handle, submit);
            *lut = pellucid::Lut(handle);
            return error;
        });
    return {*lut, done};
}

// Blocks of three halves per texel, and what they cost. On a copy of the texels, for Ctrl-C may abandon it.
py::tuple encodedBc6h(uint32_t width, uint32_t height, uintptr_t texels) {
    struct Work {
        std::vector<uint16_t> texels;
        std::vector<uint8_t> blocks;
        pellucid::io::TexelError error;
    };
    const auto work = std::make_shared<Work>();
    const auto* first = static_cast<const uint16_t*>(pointer(texels));
    work->texels.assign(first, first + size_t(width) * height * 3);
    callInterruptibly([work, width, height] {
        work->blocks = pellucid::io::encodeBc6h(width, height, work->texels, &abandoned);
        if (work->blocks.empty()) return PEL_ERROR_CANCELLED;
        work->error =
            pellucid::io::differenceOf(work->texels, pellucid::io::decodeBc6h(width, height, work->blocks));
        return PEL_SUCCESS;
    });
    return py::make_tuple(py::bytes(reinterpret_cast<const char*>(work->blocks.data()), work->blocks.size()),
                          work->error.max, work->error.rms);
}
}  // namespace

void bindLut(py::module_& module) {
    using pellucid::Lut;
    module.def("encode_bc6h", &encodedBc6h);
    py::class_<Lut, Owner<Lut>>(module, "Lut")
        .def_static("curvature", created<PelCurvatureLutDesc, pelCurvatureLutCreate>)
        .def_static("shadow", created<PelShadowLutDesc, pelShadowLutCreate>)
        .def_static("specular", created<PelSpecularLutDesc, pelSpecularLutCreate>)
        .def_static("eye", created<PelEyeLutDesc, pelEyeLutCreate>)
        .def_static("from_texels",
                    [](const Device& d, const py::object& info, uintptr_t texels, size_t bytes) {
                        const auto lut = std::make_shared<Lut>();
                        callInterruptibly([=, device = d.handle, what = *structOf<PelLutInfo>(info)] {
                            PelLut handle = nullptr;
                            const PelError error = pelLutCreateFromTexels(
                                device.get(), &what, static_cast<const float*>(pointer(texels)), bytes, &handle);
                            *lut = Lut(handle);
                            return error;
                        });
                        return *lut;
                    })
        .def("info",
             [](const Lut& l) {
                 PelLutInfo info = pelLutInfoDefaults();
                 call([&] { return pelLutGetInfo(l.get(), &info); });
                 return bytesOf(info);
             })
        .def("clipped",
             [](const Lut& l) {
                 const auto clipped = std::make_shared<uint64_t>();
                 callInterruptibly([l, clipped] { return pelLutCountClipped(l.get(), clipped.get()); });
                 return *clipped;
             })
        .def("read", [](const Lut& l, uint32_t encoding, uintptr_t to, size_t bytes, const Waits& waits) {
            return submitInterruptibly(waits, [=](const PelSubmit* submit) {
                return pelLutRead(l.get(), PelLutEncoding(encoding), pointer(to), bytes, submit);
            });
        });
}

}  // namespace pel::python
