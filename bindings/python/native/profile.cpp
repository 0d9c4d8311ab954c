#include "native.h"

namespace pel::python {

void bindProfile(py::module_& module) {
    using pellucid::Profile;
    py::class_<Profile>(module, "Profile")
        .def_static("skin", maker<Profile>(pelProfileCreateSkin))
        .def_static("gaussians", maker<Profile>(pelProfileCreateGaussians))
        .def_static("burley", maker<Profile>(pelProfileCreateBurley))
        .def_static("burley_distance", maker<Profile>(pelProfileCreateBurleyDistance))
        .def_static("skin_layers", maker<Profile>(pelProfileCreateSkinLayers))
        .def_static("named", maker<Profile>(pelProfileCreateNamed))
        .def_static("dipole", maker<Profile>(pelProfileCreateDipole))
        .def_static("table", maker<Profile>(pelProfileCreateTable))
        .def("set_name", function(pelProfileSetName))
        .def_static("of_address",  // of the module that reads files
                    [](uintptr_t address) {
                        const auto handle = reinterpret_cast<PelProfile>(address);
                        pelProfileRetain(handle);
                        return Profile(handle);
                    })
        .def_static("library_names", &Profile::libraryNames)
        .def("info", structure<pelProfileInfoDefaults>(pelProfileGetInfo))
        .def("transmission", function(pelProfileTransmission))
        .def("evaluate",
             [](const Profile& p, uintptr_t distances, uint32_t count, uintptr_t radial, uintptr_t spread) {
                 const auto* at = static_cast<const double*>(pointer(distances));
                 auto *r = static_cast<double*>(pointer(radial)), *s = static_cast<double*>(pointer(spread));
                 bool stopped = false;
                 call([&] {
                     PelError error = PEL_SUCCESS;
                     // In pieces, so that Ctrl-C is soon noticed.
                     for (uint32_t from = 0, n; from < count && !error && !(stopped = signalled());
                          from += n) {
                         n = std::min(count - from, 4096u);
                         error = pelProfileEvaluate(p.get(), at + from, n, r + 3 * size_t(from),
                                                    s + 3 * size_t(from));
                     }
                     return error;
                 });
                 if (stopped) throw py::error_already_set();
             })
        .def("address", [](const Profile& p) { return address(p.get()); });
    module.def("skin_info", structure<pelSkinInfoDefaults>(pelSkinGetInfo));
    module.def("skin_reflectance", function(pelSkinReflectance));
    module.def("skin_albedo", function(pelSkinAlbedo));
    module.def("skin_from_albedo", function(pelSkinFromAlbedo));
}

}  // namespace pel::python
