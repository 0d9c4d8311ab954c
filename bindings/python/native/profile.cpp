#include <algorithm>

#include "progress.h"

namespace pel::python {

namespace {
using pellucid::Profile;
using Triple = std::array<float, 3>;

Profile named(const std::string& name, const std::function<PelError(PelProfile*)>& create) {
    PelProfile handle = nullptr;
    call([&] { return create(&handle); });
    Profile profile(handle);
    if (!name.empty()) call([&] { return pelProfileSetName(handle, name.c_str()); });
    return profile;
}
}  // namespace

void bindProfile(py::module_& module) {
    py::class_<Profile>(module, "Profile")
        .def_static("skin", [](const std::string& name) { return named(name, pelProfileCreateSkin); })
        .def_static("gaussians",
                    [](const std::vector<std::pair<float, Triple>>& terms, const std::string& name) {
                        std::vector<PelGaussian> all;
                        for (const auto& [variance, weight] : terms)
                            all.push_back({variance, {weight[0], weight[1], weight[2]}});
                        return named(name, [&](PelProfile* out) {
                            return pelProfileCreateGaussians(all.data(), uint32_t(all.size()), out);
                        });
                    })
        .def_static("burley",
                    [](const Triple& path, const Triple& albedo, uint32_t fit, const std::string& name) {
                        return named(name, [&](PelProfile* out) {
                            return pelProfileCreateBurley(path.data(), albedo.data(), PelBurleyFit(fit), out);
                        });
                    })
        .def_static("burley_distance",
                    [](const Triple& distance, const std::string& name) {
                        return named(name, [&](PelProfile* out) {
                            return pelProfileCreateBurleyDistance(distance.data(), out);
                        });
                    })
        .def_static("named",
                    [](const std::string& material) {
                        return named("", [&](PelProfile* out) {
                            return pelProfileCreateNamed(material.c_str(), out);
                        });
                    })
        .def_static("of_address",  // of the module that reads files
                    [](uintptr_t address) {
                        const auto handle = reinterpret_cast<PelProfile>(address);
                        pelProfileRetain(handle);
                        return Profile(handle);
                    })
        .def_static("library_names",
                    [] {
                        std::vector<std::string> names;
                        for (uint32_t i = 0; const char* name = pelProfileLibraryName(i); ++i)
                            names.push_back(name);
                        return names;
                    })
        .def_static(
            "dipole",
            [](const Triple& absorption, const Triple& scattering, float eta, const std::string& name) {
                return named(name, [&](PelProfile* out) {
                    return pelProfileCreateDipole(absorption.data(), scattering.data(), eta, out);
                });
            })
        .def_static("table",
                    [](uintptr_t distances, uintptr_t values, uint32_t count, const std::string& name) {
                        return named(name, [&](PelProfile* out) {
                            return pelProfileCreateTable(static_cast<const float*>(pointer(distances)),
                                                         static_cast<const float*>(pointer(values)), count,
                                                         out);
                        });
                    })
        .def("info",
             [](const Profile& p) {
                 PelProfileInfo info = pelProfileInfoDefaults();
                 call([&] { return pelProfileGetInfo(p.get(), &info); });
                 return bytesOf(info);
             })
        .def("transmission",
             [](const Profile& p, uintptr_t distances, uint32_t count, uintptr_t through) {
                 const auto* first = static_cast<const double*>(pointer(distances));
                 auto* to = static_cast<double*>(pointer(through));
                 call([&] { return pelProfileTransmission(p.get(), first, count, to); });
             })
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
}

}  // namespace pel::python
