#include "api/entry.h"
#include "core/submission.h"
#include "eye/check_eye.h"
#include "eye/eye_lut.h"
#include "lut/lut_check.h"
#include "lut/luts.h"

using namespace pel;

namespace {

// Makes a table from a description by `integrate`. `olderHeaders`: defaults for fields that older headers
// lack; the first headers had the fields of FaceWorks.
template <class Desc, class Integrate>
PelError createLut(PelDevice device, const Desc* desc, const Desc& olderHeaders, const char* name,
                   PelLut* lut, const PelSubmit* submit, Integrate&& integrate) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const Desc request = readStruct(desc, olderHeaders, name);
        PelLut& result = output(lut, "lut");
        Submission submission(*d, submit);
        Ref<Lut> made = integrate(d, request);
        submission.finish();
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
    invalidArgument("PelLutInfo.kind is ", int(info.kind),
                    "; PEL_LUT_CURVATURE (0), PEL_LUT_SHADOW (1), PEL_LUT_SPECULAR (2) or PEL_LUT_EYE (3) is "
                    "needed");
}

}  // namespace

PelError pelCurvatureLutCreate(PelDevice device, const PelCurvatureLutDesc* desc, PelLut* lut,
                               const PelSubmit* submit) {
    return createLut(device, desc, pelCurvatureLutDescFaceWorks(), "PelCurvatureLutDesc", lut, submit,
                     [](const Ref<Device>& d, const PelCurvatureLutDesc& request) {
                         return integrateCurvatureLut(d, request);  // with the default number of nodes
                     });
}

PelError pelShadowLutCreate(PelDevice device, const PelShadowLutDesc* desc, PelLut* lut,
                            const PelSubmit* submit) {
    return createLut(device, desc, pelShadowLutDescFaceWorks(), "PelShadowLutDesc", lut, submit,
                     integrateShadowLut);
}

PelError pelSpecularLutCreate(PelDevice device, const PelSpecularLutDesc* desc, PelLut* lut,
                              const PelSubmit* submit) {
    return createLut(device, desc, pelSpecularLutDescDefaults(), "PelSpecularLutDesc", lut, submit,
                     tabulateSpecularLut);
}

PelError pelEyeLutCreate(PelDevice device, const PelEyeLutDesc* desc, PelLut* lut, const PelSubmit* submit) {
    return createLut(device, desc, pelEyeLutDescDefaults(), "PelEyeLutDesc", lut, submit,
                     [&](const Ref<Device>& d, const PelEyeLutDesc& request) {
                         return integrateEyeLut(d, request, submit == nullptr);
                     });
}

PelError pelLutCreateFromTexels(PelDevice device, const PelLutInfo* info, const float* texels, size_t bytes,
                                PelLut* lut) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const auto known = readStruct(info, pelLutInfoDefaults(), "PelLutInfo");
        checkInfo(known);
        handOut(lut, "lut", [&] { return uploadLut(d, known, texels, bytes); });
    });
}

void pelLutRetain(PelLut lut) {
    retainEntry<Lut>(lut);
}
void pelLutRelease(PelLut lut) {
    releaseEntry<Lut>(lut);
}

PelError pelLutGetInfo(PelLut lut, PelLutInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Lut>(lut)->info(), "PelLutInfo"); });
}

PelError pelLutGetSize(PelLut lut, PelLutEncoding encoding, size_t* bytes) {
    return entry([&] {
        const Ref<Lut> l = fromHandle<Lut>(lut);
        output(bytes, "bytes") = packedBytes(*l, encoding);
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
        Submission submission(l->device(), submit);
        readLut(*l, encoding, destination, submission.blocking());
        submission.finish();
    });
}
