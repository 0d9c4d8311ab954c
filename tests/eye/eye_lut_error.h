// A table of caustics against photons.
#pragma once
#include "reference/eye.h"

#include "tools.h"

namespace eye_test {

inline reference::Eye referenceOf(const PelEye& e) {
    reference::Eye eye;
    eye.sclera = e.scleraRadius, eye.cornea = e.corneaRadius, eye.conic = e.corneaConic,
    eye.limbus = e.limbusRadius;
    eye.limbusWidth = e.limbusWidth, eye.limbusDarkening = e.limbusDarkening, eye.chamber = e.chamberDepth;
    eye.nCornea = e.corneaIndex, eye.nAqueous = e.aqueousIndex, eye.concavity = e.irisConcavity;
    eye.iris = e.irisRadius > 0 ? e.irisRadius : e.limbusRadius, eye.pupil = e.pupilRadius;
    eye.texturePupil = e.texturePupil, eye.tearRoughness = e.tearRoughness,
    eye.wetLineRoughness = e.wetLineRoughness;
    eye.nTear = e.tearIndex;
    return eye;
}

struct LutError {
    double sum2 = 0, sum = 0, texels = 0;
    double flux = 0, trueFlux = 0;  // over texels whose light the photons counted
    double bounced = 0;
    double rms() const { return std::sqrt(sum2 / texels) / (sum / texels); }  // of the mean
    double fluxError() const { return std::abs(flux / trueFlux - 1); }
};

// Adds slice z of the table, RGB texels.
inline void addSlice(const PelEyeLutDesc& desc, const reference::Eye& eye, const std::vector<float>& texels,
                     uint32_t z, uint64_t photons, LutError* error) {
    const double angle = reference::largestAngle(eye) * z / (desc.depth - 1);
    const reference::Caustic truth =
        tracePhotons(eye, angle, int(desc.width), int(desc.height), photons, 17 + z);
    const double area = 2 * eye.iris / desc.width * eye.iris / desc.height;
    for (uint32_t j = 0; j < desc.height; ++j)
        for (uint32_t i = 0; i < desc.width; ++i) {
            const double is = texels[3 * ((size_t(z) * desc.height + j) * desc.width + i)],
                         should = truth.texels[size_t(j) * desc.width + i];
            const double x = ((i + 0.5) / desc.width * 2 - 1) * eye.iris;
            const double y = (j + 0.5) / desc.height * eye.iris;
            const double slope = 2 * eye.concavity * std::hypot(x, y) / (eye.iris * eye.iris);
            error->sum2 += (is - should) * (is - should);
            error->sum += should;
            error->texels += 1;
            error->flux += is * area * std::sqrt(1 + slope * slope);
        }
    error->trueFlux += truth.flux;
    error->bounced += truth.bounced;
}

}  // namespace eye_test
