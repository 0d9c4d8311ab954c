// An eye of the library as the oracle takes it.
#pragma once
#include <pellucid/pellucid.h>

#include "reference/eye.h"

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

}  // namespace eye_test
