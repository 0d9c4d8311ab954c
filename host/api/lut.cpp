#include "api/entry.h"
#include "core/submission.h"
#include "ops/luts.h"

using namespace pel;

PelError pelCurvatureLutCreate(PelDevice device, const PelCurvatureLutDesc* desc, PelLut* lut,
                               const PelSubmit* submit) {
    return entry([&] {
        Device& d = fromHandle<Device>(device);
        const auto request = readStruct(desc, pelCurvatureLutDescDefaults(), "PelCurvatureLutDesc");
        PelLut& result = output(lut, "lut");
        Submission submission(d, submit);
        Ref<Lut> made = integrateCurvatureLut(Ref<Device>(&d), request);
        submission.finish();
        result = toHandle<PelLut>(std::move(made));
    });
}

PelError pelShadowLutCreate(PelDevice device, const PelShadowLutDesc* desc, PelLut* lut,
                            const PelSubmit* submit) {
    return entry([&] {
        Device& d = fromHandle<Device>(device);
        const auto request = readStruct(desc, pelShadowLutDescDefaults(), "PelShadowLutDesc");
        PelLut& result = output(lut, "lut");
        Submission submission(d, submit);
        Ref<Lut> made = integrateShadowLut(Ref<Device>(&d), request);
        submission.finish();
        result = toHandle<PelLut>(std::move(made));
    });
}

PelError pelSpecularLutCreate(PelDevice device, const PelSpecularLutDesc* desc, PelLut* lut,
                              const PelSubmit* submit) {
    return entry([&] {
        Device& d = fromHandle<Device>(device);
        const auto request = readStruct(desc, pelSpecularLutDescDefaults(), "PelSpecularLutDesc");
        PelLut& result = output(lut, "lut");
        Submission submission(d, submit);
        Ref<Lut> made = tabulateSpecularLut(Ref<Device>(&d), request);
        submission.finish();
        result = toHandle<PelLut>(std::move(made));
    });
}

PelError pelLutCreateFromTexels(PelDevice device, const PelLutInfo* info, const float* texels, size_t bytes,
                                PelLut* lut) {
    return entry([&] {
        Device& d = fromHandle<Device>(device);
        const auto known = readStruct(info, pelLutInfoDefaults(), "PelLutInfo");
        output(lut, "lut") = toHandle<PelLut>(uploadLut(Ref<Device>(&d), known, texels, bytes));
    });
}

void pelLutRetain(PelLut lut) {
    retainHandle(lut);
}
void pelLutRelease(PelLut lut) {
    releaseHandle(lut);
}

PelError pelLutGetInfo(PelLut lut, PelLutInfo* info) {
    return entry([&] { writeStruct(info, fromHandle<Lut>(lut).info(), "PelLutInfo"); });
}

PelError pelLutGetSize(PelLut lut, PelLutEncoding encoding, size_t* bytes) {
    return entry([&] { output(bytes, "bytes") = packedBytes(fromHandle<Lut>(lut), encoding); });
}

PelError pelLutRead(PelLut lut, PelLutEncoding encoding, void* destination, size_t bytes,
                    const PelSubmit* submit) {
    return entry([&] {
        Lut& l = fromHandle<Lut>(lut);
        const size_t needed = packedBytes(l, encoding);
        if (bytes < needed)
            invalidArgument("the LUT takes ", needed, " bytes in this encoding; destination has ", bytes);
        output(static_cast<char*>(destination), "destination");
        Submission submission(l.device(), submit);
        readLut(l, encoding, destination, submission.blocking());
        submission.finish();
    });
}
