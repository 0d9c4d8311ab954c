#include "eye/eye_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cl/error.h"

namespace pel {

double EyeShape::sag(double r) const {
    return r * r / (cornea * (1 + std::sqrt(std::max(0.0, 1 - (1 + conic) * r * r / (cornea * cornea)))));
}

double EyeShape::slope(double r) const {
    return r / (cornea * std::sqrt(std::max(1e-12, 1 - (1 + conic) * r * r / (cornea * cornea))));
}

EyeShape::EyeShape(const PelEyeLutDesc& d, const char* structure)
    : sclera(d.scleraRadius),
      cornea(d.corneaRadius),
      conic(d.corneaConic),
      limbus(d.limbusRadius),
      iris(d.irisRadius > 0 ? d.irisRadius : d.limbusRadius),
      concavity(d.irisConcavity) {
    if (limbus >= sclera)
        invalidArgument(structure, ".limbusRadius is ", limbus, "; it must be below scleraRadius, ", sclera);
    // Keeps the slope finite at the edge of the cornea.
    if ((1 + conic) * limbus * limbus > 0.98 * cornea * cornea)
        invalidArgument(structure, ".limbusRadius is ", limbus, "; a cornea of corneaRadius ", cornea,
                        " and corneaConic ", conic, " is only ", cornea / std::sqrt(1 + conic),
                        " wide; the limbus may be at most 0.98 of that");
    if (iris > limbus)
        invalidArgument(structure, ".irisRadius is ", iris, "; it must not exceed limbusRadius, ", limbus);
    limbusZ = std::sqrt(sclera * sclera - limbus * limbus);
    apexZ = limbusZ + sag(limbus);
    irisZ = apexZ - d.chamberDepth;
    if (d.chamberDepth < sag(iris))
        invalidArgument(structure, ".chamberDepth is ", d.chamberDepth,
                        "; the iris would cut through the cornea, which lies ", sag(iris),
                        " below its apex at the rim of the iris: at least that is needed");
    if (irisZ - concavity <= -sclera || std::hypot(iris, irisZ) > sclera)
        invalidArgument(structure, ".chamberDepth is ", d.chamberDepth, " and irisConcavity ", concavity,
                        "; the iris would leave the sclera, of scleraRadius ", sclera);
    // Light reaches a point of the cornea above the point's own horizon and above that of the sclera.
    largestAngle = 0;
    for (int i = 1; i <= 256; ++i) {
        const double r = limbus * i / 256, z = apexZ - sag(r), far = std::hypot(r, z);
        const double local = std::atan(slope(r)),
                     past = std::atan2(r, z) + std::acos(std::min(1.0, sclera / far));
        largestAngle = std::max(largestAngle, std::numbers::pi / 2 + std::min(local, past));
    }
}

}  // namespace pel
