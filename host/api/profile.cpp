#include "lut/profile.h"

#include <cmath>

#include "api/entry.h"
#include "lut/profile_library.h"

using namespace pel;

PelError pelProfileCreateSkin(PelProfile* profile) {
    return entry([&] { handOut(profile, "profile", [&] { return Profile::skin(); }); });
}

PelError pelProfileCreateGaussians(const PelGaussian* gaussians, uint32_t count, PelProfile* profile) {
    return entry([&] { handOut(profile, "profile", [&] { return Profile::gaussians(gaussians, count); }); });
}

PelError pelProfileCreateBurley(const float meanFreePath[3], const float albedo[3], PelBurleyFit fit,
                                PelProfile* profile) {
    return entry(
        [&] { handOut(profile, "profile", [&] { return Profile::burley(meanFreePath, albedo, fit); }); });
}

PelError pelProfileCreateBurleyDistance(const float distance[3], PelProfile* profile) {
    return entry([&] { handOut(profile, "profile", [&] { return Profile::burleyDistance(distance); }); });
}

PelError pelProfileCreateNamed(const char* name, PelProfile* profile) {
    return entry([&] { handOut(profile, "profile", [&] { return namedProfile(name); }); });
}

const char* pelProfileLibraryName(uint32_t index) {
    return index < profileLibrary().size() ? profileLibrary()[index].name : nullptr;
}

PelError pelProfileTransmission(PelProfile profile, const double* distances, uint32_t count,
                                double* transmission) {
    return entry([&] {
        const Ref<Profile> held = fromHandle<Profile>(profile);
        const ProfileShape& shape = held->shape();
        if (count > 0 && !distances) invalidArgument("distances are needed, not NULL");
        if (count > 0 && !transmission) invalidArgument("a transmission to fill is needed, not NULL");
        for (uint32_t i = 0; i < count; ++i)
            if (!std::isfinite(distances[i]) || distances[i] < 0)
                invalidArgument("distance ", i, " is ", distances[i],
                                "; a finite length of 0 or more is needed");
        for (uint32_t i = 0; i < count; ++i) {
            const Rgb t = shape.transmission(distances[i]);
            std::copy(t.begin(), t.end(), transmission + 3 * i);
        }
    });
}

PelError pelProfileCreateDipole(const float absorption[3], const float reducedScattering[3], float eta,
                                PelProfile* profile) {
    return entry([&] {
        handOut(profile, "profile", [&] { return Profile::dipole(absorption, reducedScattering, eta); });
    });
}

PelError pelProfileCreateTable(const float* distances, const float* values, uint32_t count,
                               PelProfile* profile) {
    return entry(
        [&] { handOut(profile, "profile", [&] { return Profile::table(distances, values, count); }); });
}

void pelProfileRetain(PelProfile profile) {
    retainEntry<Profile>(profile);
}
void pelProfileRelease(PelProfile profile) {
    releaseEntry<Profile>(profile);
}

PelError pelProfileGetInfo(PelProfile profile, PelProfileInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Profile>(profile)->info(), "PelProfileInfo"); });
}

PelError pelProfileSetName(PelProfile profile, const char* name) {
    return entry([&] { fromHandle<Profile>(profile)->setName(name); });
}

PelError pelProfileEvaluate(PelProfile profile, const double* distances, uint32_t count, double* radial,
                            double* lineSpread) {
    return entry([&] {
        const Ref<Profile> held = fromHandle<Profile>(profile);
        const ProfileShape& shape = held->shape();
        if (count > 0 && !distances) invalidArgument("distances are needed, not NULL");
        for (uint32_t i = 0; i < count; ++i)
            if (!std::isfinite(distances[i]) || distances[i] <= 0)
                invalidArgument("distance ", i, " is ", distances[i], "; a finite length above 0 is needed");
        for (uint32_t i = 0; i < count; ++i)
            for (int c = 0; c < 3; ++c) {
                if (radial) radial[3 * i + c] = shape.radial(distances[i])[c];
                if (lineSpread) lineSpread[3 * i + c] = shape.lineSpread(distances[i])[c];
            }
    });
}
