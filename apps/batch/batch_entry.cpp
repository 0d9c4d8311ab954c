#include "batch/batch_entry.h"

#include "io/lut/lut_exr.h"

namespace pellucid::io {
namespace {

Lut submitted(const Device& device, const PelLutInfo& info) {
    const PelSubmit queued{nullptr, 0, nullptr};
    if (info.kind == PEL_LUT_CURVATURE) return Lut(device, info.curvature, &queued);
    if (info.kind == PEL_LUT_SHADOW) return Lut(device, info.shadow, &queued);
    return Lut(device, info.specular, &queued);
}

}  // namespace

std::string makeEntryFile(const Device& device, const BatchEntry& entry) {
    const Lut lut = submitted(device, entry.info);
    size_t bytes = 0;
    check(pelLutGetSize(lut.get(), entry.encoding, &bytes));
    std::string texels(bytes, '\0');
    PelEvent done = nullptr;
    const PelSubmit reading{nullptr, 0, &done};
    check(pelLutRead(lut.get(), entry.encoding, texels.data(), bytes, &reading));
    Event(done).wait();
    return encodeLutExr(lut.info(), entry.encoding, texels, entry.key);
}

}  // namespace pellucid::io
