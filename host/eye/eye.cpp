#include <numbers>

#include "core/check_range.h"
#include "eye/eye.h"

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

namespace {

// Steps of the integral over directions from one point of the iris: its error is below 1e-3.
constexpr int tiltSteps = 48, turnSteps = 64;
// Max width of the edge of the pupil, relative to the radii of iris and pupil.
constexpr float softRim = 0.02f, softPupil = 0.1f;
constexpr double maxDepth = 7;  // optical depth of a rim that darkens entirely

// 1 - reflectance (section 13 of the mathematics).
double transmitted(double cosine, double from, double to) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)) * from / to;
    if (sine >= 1) return 0;
    const double behind = std::sqrt(1 - sine * sine);
    const double s = (from * cosine - to * behind) / (from * cosine + to * behind),
                 p = (from * behind - to * cosine) / (from * behind + to * cosine);
    return 1 - 0.5 * (s * s + p * p);
}

// Ambient light at distance r from the axis: the transmittance of the cornea times the square of the index,
// averaged over the cosine-weighted hemisphere.
double ambientAt(const EyeShape& shape, const PelEyeLutDesc& desc, double r) {
    const double parabola = shape.concavity / (shape.iris * shape.iris), slope = 2 * parabola * r,
                 upright = 1 / std::hypot(1, slope);
    const double z = shape.irisZ - shape.concavity + parabola * r * r, conic1 = 1 + shape.conic;
    const double nc = desc.corneaIndex, na = desc.aqueousIndex;
    double sum = 0;
    for (int i = 0; i < tiltSteps; ++i)
        for (int j = 0; j < turnSteps; ++j) {
            // Cosine-weighted direction in the plane of the iris; x points away from the axis.
            const double s = std::sqrt((i + 0.5) / tiltSteps);
            const double turn = std::numbers::pi * (j + 0.5) / turnSteps;
            const double lx = s * std::cos(turn), ly = s * std::sin(turn), lz = std::sqrt(1 - s * s);
            const double dx = upright * (lx - slope * lz), dy = ly, dz = upright * (slope * lx + lz);
            // Intersection with the cornea, from inside.
            const double w = shape.apexZ - z, a = dx * dx + dy * dy + conic1 * dz * dz;
            const double b = r * dx + (shape.cornea - conic1 * w) * dz,
                         c = r * r + conic1 * w * w - 2 * shape.cornea * w;
            const double root = std::sqrt(std::max(0.0, b * b - a * c));
            // One root is positive, since c < 0.
            const double t = b > 0 ? -c / (b + root) : (root - b) / a;
            const double x = r + t * dx, y = t * dy, height = z + t * dz;
            if (!(t > 0) || std::hypot(x, y) > shape.limbus || height < shape.limbusZ) continue;
            double nx = x, ny = y, nz = shape.cornea - conic1 * (shape.apexZ - height);
            const double length = std::sqrt(nx * nx + ny * ny + nz * nz);
            nx /= length, ny /= length, nz /= length;
            const double inside = dx * nx + dy * ny + dz * nz;
            const double between2 = 1 - (1 - inside * inside) * na * na / (nc * nc);
            if (between2 <= 0) continue;
            const double through = transmitted(inside, na, nc) * transmitted(std::sqrt(between2), nc, 1);
            if (through <= 0) continue;
            // Outside it may run into the sclera.
            const double out = std::sqrt(std::max(0.0, 1 - (1 - inside * inside) * na * na)),
                         k = out - na * inside;
            const double ox = na * dx + k * nx, oy = na * dy + k * ny, oz = na * dz + k * nz;
            const double ahead = x * ox + y * oy + height * oz,
                         above = x * x + y * y + height * height - shape.sclera * shape.sclera;
            if (ahead < 0 && ahead * ahead > above) continue;
            sum += na * na * through;
        }
    return sum / (tiltSteps * turnSteps);
}

}  // namespace

PelEyeShape describeShape(const EyeShape& s, const PelEyeLutDesc& desc, double scale) {
    PelEyeShape shape{};
    shape.sclera2 = float(s.sclera * scale * s.sclera * scale);
    shape.cornea = float(s.cornea * scale);
    shape.conic1 = float(1 + s.conic);
    shape.limbus = float(s.limbus * scale);
    shape.limbusZ = float(s.limbusZ * scale);
    shape.apexZ = float(s.apexZ * scale);
    shape.iris = float(s.iris * scale);
    shape.irisZ = float((s.irisZ - s.concavity) * scale);
    shape.irisBend = float(s.concavity / (s.iris * s.iris) / scale);
    shape.corneaIndex = desc.corneaIndex;
    shape.aqueousIndex = desc.aqueousIndex;
    return shape;
}

AmbientNodes ambientNodes(const PelEye& eye) {
    const PelEyeLutDesc desc = pelEyeLutDescOf(&eye);
    const EyeShape shape(desc, "PelEye");
    AmbientNodes nodes{};
    for (int i = 0; i < PEL_AMBIENT_NODES; ++i)
        nodes[size_t(i)] = float(ambientAt(shape, desc, shape.iris * i / (PEL_AMBIENT_NODES - 1)));
    return nodes;
}

bool sameShape(const PelEye& a, const PelEye& b) {
#define PEL_SAME_(type, name, ...) a.name == b.name&&
    return PEL_EACH_EYE_SHAPE_FIELD(PEL_SAME_) true;
#undef PEL_SAME_
}

PelShadeEye describeEye(const PelEye& eye, const AmbientNodes& ambient, double millimetresPerUnit) {
    const PelEyeLutDesc desc = pelEyeLutDescOf(&eye);
    const EyeShape shape(desc, "PelEye");
    PelShadeEye to{};
    to.shape = describeShape(shape, desc, 1);
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        to.center[i] = eye.center[i];
        to.right[i] = eye.up[j] * eye.gaze[k] - eye.up[k] * eye.gaze[j];
        to.up[i] = eye.up[i];
        to.gaze[i] = eye.gaze[i];
        to.irisColor[i] = eye.irisColor[i];
    }
    to.mmPerUnit = float(millimetresPerUnit);
    to.limbusPerWidth = 1 / std::max(eye.limbusWidth, 1e-6f * eye.limbusRadius);
    to.limbusDepth = float(std::min(-std::log(std::max(1.0 - eye.limbusDarkening, 1e-30)), maxDepth));
    to.pupil = eye.pupilRadius;
    if (eye.pupilRadius > 0)
        to.pupilPerWidth = 1 / std::min(softRim * eye.irisRadius, softPupil * eye.pupilRadius);
    else
        to.pupilBase = 1;
    to.textureScale = (1 - eye.texturePupil) / (eye.irisRadius - eye.pupilRadius);
    to.textureBase = eye.texturePupil - to.textureScale * eye.pupilRadius;
    to.tearRoughness = eye.tearRoughness;
    to.wetLineRoughness = eye.wetLineRoughness;
    to.tearIndex = eye.tearIndex;
    std::copy(ambient.begin(), ambient.end(), to.ambient);
    return to;
}

// Returns false for a vector of length 0.
static bool normalize(Three& v) {
    const double size = length(v);
    v = v / size;
    return size > 0;
}

static void checkFinite(const char* field, const float (&v)[3]) {
    for (int i = 0; i < 3; ++i)
        if (!std::isfinite(v[i]))
            invalidArgument("PelEye.", field, "[", i, "] is ", v[i], "; it must be finite");
}

PelEye resolvedEye(const PelEye& given) {
    const char* structure = "PelEye";
    const PelEye& fields = given;
    PEL_EACH_EYE_FIELD(PEL_CHECK_RANGE)
    PelEye eye = given;
    if (eye.irisRadius == 0) eye.irisRadius = eye.limbusRadius;
    checkEyeLutWork(pelEyeLutDescOf(&eye), structure);
    if (eye.pupilRadius >= eye.irisRadius)
        invalidArgument("PelEye.pupilRadius is ", eye.pupilRadius,
                        "; it must be less than the radius of the iris, ", eye.irisRadius);
    checkFinite("center", eye.center);
    checkFinite("gaze", eye.gaze);
    checkFinite("up", eye.up);
    Three g = threeAt(eye.gaze), u = threeAt(eye.up);
    if (!normalize(g)) invalidArgument("PelEye.gaze is (0, 0, 0); a direction is needed");
    if (!normalize(u)) invalidArgument("PelEye.up is (0, 0, 0); a direction is needed");
    const double along = dot(u, g);
    u = u - along * g;
    if (std::abs(along) > 0.99999 || !normalize(u))
        invalidArgument("PelEye.up is parallel to PelEye.gaze; a direction that is not would be right");
    std::ranges::copy(g, eye.gaze);
    std::ranges::copy(u, eye.up);
    return eye;
}

void checkEyeLutDesc(const PelEyeLutDesc& fields) {
    const char* structure = "PelEyeLutDesc";
    PEL_EACH_EYE_LUT_FIELD(PEL_CHECK_RANGE)
    checkEyeLutWork(fields, structure);
}

}  // namespace pel
