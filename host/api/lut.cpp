#include "api/entry.h"
#include "core/submission.h"
#include "eye/eye.h"
#include "lut/luts.h"
#include "lut/skin.h"

using namespace pel;

namespace {

void checkDistances(const double* distances, uint32_t count, bool zero) {
    if (count > 0 && !distances) invalidArgument("distances are needed, not NULL");
    for (uint32_t i = 0; i < count; ++i)
        if (!std::isfinite(distances[i]) || distances[i] < 0 || (distances[i] == 0 && !zero))
            invalidArgument("distance ", i, " is ", distances[i], "; a finite length ",
                            zero ? "of 0 or more" : "above 0", " is needed");
}

// Makes a table from a description by `integrate`. `olderHeaders`: defaults for fields that older headers
// lack; the first headers had the fields of FaceWorks.
template <class Desc, class Integrate>
PelError createLut(PelDevice device, const Desc* desc, const Desc& olderHeaders, PelLut* lut,
                   const PelSubmit* submit, Integrate&& integrate) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const Desc request = readStruct(desc, olderHeaders);
        PelLut& result = output(lut, "lut");
        Ref<Lut> made;
        submitted(*d, submit, [&](bool) { made = integrate(d, request); });
        result = toHandle<PelLut>(std::move(made));
    });
}

void checkInfo(const PelLutInfo& info) {
    switch (info.kind) {
        case PEL_LUT_CURVATURE:
            return checkCurvatureDesc(info.curvature);
        case PEL_LUT_SHADOW:
            return checkShadowDesc(info.shadow);
        case PEL_LUT_SPECULAR:
            return checkSpecularDesc(info.specular);
        case PEL_LUT_EYE:
            return checkEyeLutDesc(info.eye);
    }
    invalidArgument(
        "PelLutInfo.kind is ", int(info.kind),
        "; PEL_LUT_CURVATURE (0), PEL_LUT_SHADOW (1), PEL_LUT_SPECULAR (2) or PEL_LUT_EYE (3) is needed");
}

}  // namespace

PelError pelCurvatureLutCreate(PelDevice device, const PelCurvatureLutDesc* desc, PelLut* lut,
                               const PelSubmit* submit) {
    return createLut(device, desc, pelCurvatureLutDescFaceWorks(), lut, submit, integrateCurvatureLut);
}

PelError pelShadowLutCreate(PelDevice device, const PelShadowLutDesc* desc, PelLut* lut,
                            const PelSubmit* submit) {
    return createLut(device, desc, pelShadowLutDescFaceWorks(), lut, submit, integrateShadowLut);
}

PelError pelSpecularLutCreate(PelDevice device, const PelSpecularLutDesc* desc, PelLut* lut,
                              const PelSubmit* submit) {
    return createLut(device, desc, pelSpecularLutDescDefaults(), lut, submit, tabulateSpecularLut);
}

PelError pelEyeLutCreate(PelDevice device, const PelEyeLutDesc* desc, PelLut* lut, const PelSubmit* submit) {
    return createLut(device, desc, pelEyeLutDescDefaults(), lut, submit,
                     [&](const Ref<Device>& d, const PelEyeLutDesc& request) {
                         return integrateEyeLut(d, request, submit == nullptr);
                     });
}

PelError pelLutCreateFromTexels(PelDevice device, const PelLutInfo* info, const float* texels, size_t bytes,
                                PelLut* lut) {
    return create(lut, "lut", [&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const auto known = readStruct(info, pelLutInfoDefaults());
        checkInfo(known);
        return uploadLut(d, known, texels, bytes);
    });
}

PEL_COUNTED(Lut)

PelError pelLutGetInfo(PelLut lut, PelLutInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Lut>(lut)->info()); });
}

PelError pelLutGetSize(PelLut lut, PelLutEncoding encoding, size_t* bytes) {
    return entry([&] {
        const Ref<Lut> l = fromHandle<Lut>(lut);
        output(bytes, "bytes") = packedBytes(*l, encoding);
    });
}

PelError pelLutReadStack(PelDevice device, const PelLutInfo* tables, uint32_t count, PelLutEncoding encoding,
                         void* destination, size_t bytes) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        output(static_cast<char*>(destination), "destination");
        std::vector<PelLutInfo> all;
        eachStruct(tables, count, [&](const PelLutInfo* given, uint32_t) {
            all.push_back(readStruct(given, pelLutInfoDefaults()));
            checkInfo(all.back());
        });
        submitted(*d, nullptr, [&](bool) { readLutStack(d, all, encoding, destination, bytes); });
    });
}

PelError pelLutCountClipped(PelLut lut, uint64_t* clipped) {
    return entry([&] {
        const Ref<Lut> l = fromHandle<Lut>(lut);
        output(clipped, "clipped") = countClipped(*l);
    });
}

PelError pelLutRead(PelLut lut, PelLutEncoding encoding, void* destination, size_t bytes,
                    const PelSubmit* submit) {
    return entry([&] {
        const Ref<Lut> l = fromHandle<Lut>(lut);
        const size_t needed = packedBytes(*l, encoding);
        if (bytes < needed)
            invalidArgument("the LUT takes ", needed, " bytes in this encoding; destination has ", bytes);
        output(static_cast<char*>(destination), "destination");
        submitted(l->device(), submit, [&](bool blocking) { readLut(*l, encoding, destination, blocking); });
    });
}

PelError pelProfileCreateSkin(PelProfile* profile) {
    return create(profile, "profile", [&] { return Profile::skin(); });
}

PelError pelProfileCreateGaussians(const PelGaussian* gaussians, uint32_t count, PelProfile* profile) {
    return create(profile, "profile", [&] { return Profile::gaussians(gaussians, count); });
}

PelError pelProfileCreateBurley(const float meanFreePath[3], const float albedo[3], PelBurleyFit fit,
                                PelProfile* profile) {
    return create(profile, "profile", [&] { return Profile::burley(meanFreePath, albedo, fit); });
}

PelError pelProfileCreateBurleyDistance(const float distance[3], PelProfile* profile) {
    return create(profile, "profile", [&] { return Profile::burleyDistance(distance); });
}

PelError pelProfileCreateSkinLayers(const PelSkin* skin, PelProfile* profile) {
    return create(profile, "profile", [&] { return skinLayersProfile(readSkin(skin)); });
}

PelError pelSkinGetInfo(const PelSkin* skin, PelSkinInfo* info) {
    return entry([&] { writeStruct(info, skinInfo(readSkin(skin))); });
}

PelError pelSkinReflectance(const PelSkin* skin, const float* nanometres, uint32_t count,
                            float* reflectance) {
    return entry([&] {
        const PelSkin read = readSkin(skin);
        if (count > 0 && (!nanometres || !reflectance))
            invalidArgument("wavelengths and a reflectance to fill are needed, not NULL");
        skinReflectance(read, {nanometres, count}, reflectance);
    });
}

PelError pelSkinAlbedo(const PelSkin* skin, const float* melanin, const float* blood, uint64_t count,
                       float* albedo, float* radius) {
    return entry([&] {
        const PelSkin read = readSkin(skin);
        if (count > 0 && (!melanin || !blood)) invalidArgument("melanin and blood are needed, not NULL");
        skinAlbedo(read, melanin, blood, count, albedo, radius);
    });
}

PelError pelSkinFromAlbedo(const PelSkin* skin, const float* albedo, uint64_t count, float* melanin,
                           float* blood, float* difference) {
    return entry([&] {
        const PelSkin read = readSkin(skin);
        if (count > 0 && (!albedo || !melanin || !blood))
            invalidArgument("an albedo, and melanin and blood to fill, are needed, not NULL");
        skinFromAlbedo(read, albedo, count, melanin, blood, difference);
    });
}

PelError pelProfileCreateNamed(const char* name, PelProfile* profile) {
    return create(profile, "profile", [&] { return namedProfile(name); });
}

const char* pelProfileLibraryName(uint32_t index) {
    return index < profileLibrary().size() ? profileLibrary()[index].name : nullptr;
}

PelError pelProfileTransmission(PelProfile profile, const double* distances, uint32_t count,
                                double* transmission) {
    return entry([&] {
        const Ref<Profile> held = fromHandle<Profile>(profile);
        checkDistances(distances, count, true);
        if (count > 0 && !transmission) invalidArgument("a transmission to fill is needed, not NULL");
        for (uint32_t i = 0; i < count; ++i)
            std::ranges::copy(held->shape().transmission(distances[i]), transmission + 3 * i);
    });
}

PelError pelProfileCreateDipole(const float absorption[3], const float reducedScattering[3], float eta,
                                PelProfile* profile) {
    return create(profile, "profile", [&] { return Profile::dipole(absorption, reducedScattering, eta); });
}

PelError pelProfileCreateTable(const float* distances, const float* values, uint32_t count,
                               PelProfile* profile) {
    return create(profile, "profile", [&] { return Profile::table(distances, values, count); });
}

PEL_COUNTED(Profile)

PelError pelProfileGetInfo(PelProfile profile, PelProfileInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Profile>(profile)->info()); });
}

PelError pelProfileSetName(PelProfile profile, const char* name) {
    return entry([&] { fromHandle<Profile>(profile)->setName(name); });
}

PelError pelProfileEvaluate(PelProfile profile, const double* distances, uint32_t count, double* radial,
                            double* lineSpread) {
    return entry([&] {
        const Ref<Profile> held = fromHandle<Profile>(profile);
        checkDistances(distances, count, false);
        for (uint32_t i = 0; i < count; ++i) {
            if (radial) std::ranges::copy(held->shape().radial(distances[i]), radial + 3 * i);
            if (lineSpread) std::ranges::copy(held->shape().lineSpread(distances[i]), lineSpread + 3 * i);
        }
    });
}
