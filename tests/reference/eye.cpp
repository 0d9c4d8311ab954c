#include "reference/eye.h"

#include <random>

#include "reference/shade.h"

namespace reference {
namespace {

bool onCornea(const Eye& eye, Vec3 p) {
    return std::hypot(p.x, p.y) <= eye.limbus && p.z >= eye.limbusZ() - 1e-9;
}

// Above 0 outside of the cornea's surface, which goes on beyond the limbus.
double aboveCornea(const Eye& eye, Vec3 p) {
    const double r = std::hypot(p.x, p.y), w = eye.apexZ() - p.z;
    return r * r - 2 * eye.cornea * w + (1 + eye.conic) * w * w;
}

// First root of f on [a, b] by steps and bisection; false without one.
bool firstRoot(const std::function<double(double)>& f, double a, double b, int steps, double* root) {
    double left = a, value = f(a);
    for (int i = 1; i <= steps; ++i) {
        const double right = a + (b - a) * i / steps, next = f(right);
        if ((value > 0) != (next > 0)) {
            *root = bisected(left, right, [&](double t) { return (f(t) > 0) == (value > 0); });
            return true;
        }
        left = right, value = next;
    }
    return false;
}

// The nearest point of a ray on the sclera's sphere; false if it misses.
bool meetSclera(const Eye& eye, Vec3 o, Vec3 d, double* t) {
    const double b = dot(o, d), c = dot(o, o) - eye.sclera * eye.sclera, disc = b * b - c;
    if (disc < 0) return false;
    *t = -b - std::sqrt(disc);
    return *t > 0;
}

// Where a ray from inside the chamber meets the iris' surface.
double meetIris(const Eye& eye, Vec3 o, Vec3 d) {
    if (eye.concavity == 0) return d.z < 0 ? (eye.irisZ() - o.z) / d.z : 1e30;
    // irisHeight(r) - z = 0 along the ray: a quadratic.
    const double g = eye.concavity / (eye.iris * eye.iris), a = g * (d.x * d.x + d.y * d.y);
    const double b = 2 * g * (o.x * d.x + o.y * d.y) - d.z;
    // below 0 above the iris
    const double c = g * (o.x * o.x + o.y * o.y) + eye.irisZ() - eye.concavity - o.z;
    if (a < 1e-14) return b > 0 ? -c / b : 1e30;
    return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

}  // namespace

double Eye::limbusZ() const {
    return std::sqrt(sclera * sclera - limbus * limbus);
}
// Below the apex, at a distance from the axis.
double Eye::sag(double r) const {
    const double q = 1 + conic;
    return std::abs(q) < 1e-9 ? r * r / (2 * cornea) : (cornea - std::sqrt(cornea * cornea - q * r * r)) / q;
}
double Eye::apexZ() const {
    return limbusZ() + sag(limbus);
}
double Eye::irisZ() const {
    return apexZ() - chamber;
}
double Eye::corneaZ(double r) const {
    return apexZ() - sag(r);
}
Vec3 Eye::corneaNormal(double x, double y) const {
    const double w = apexZ() - corneaZ(std::hypot(x, y));
    return normalized({x, y, cornea - (1 + conic) * w});
}
double Eye::irisHeight(double r) const {
    return irisZ() - concavity * (1 - r * r / (iris * iris));
}

double largestAngle(const Eye& eye) {
    double largest = 0;
    for (int i = 1; i <= 256; ++i) {
        const double r = eye.limbus * i / 256, z = eye.corneaZ(r);
        const Vec3 n = eye.corneaNormal(r, 0);
        const double past = std::atan2(r, z) + std::acos(std::min(1.0, eye.sclera / std::hypot(r, z)));
        largest = std::max(largest, std::acos(0.0) + std::min(std::atan2(n.x, n.z), past));
    }
    return largest;
}

double fresnel(double cosine, double from, double to) {
    const double sine = std::sqrt(max0(1 - cosine * cosine)) * from / to;
    if (sine >= 1) return 1;
    const double inside = std::sqrt(1 - sine * sine);
    const double s = (from * cosine - to * inside) / (from * cosine + to * inside);
    const double p = (from * inside - to * cosine) / (from * inside + to * cosine);
    return 0.5 * (s * s + p * p);
}

namespace {

// Through the cornea, from air to the aqueous: both of its sides, without reflections between them.
double corneaTransmittance(const Eye& eye, double cosine) {
    const double inside = std::sqrt(max0(1 - (1 - cosine * cosine) / (eye.nCornea * eye.nCornea)));
    return (1 - fresnel(cosine, 1, eye.nCornea)) * (1 - fresnel(inside, eye.nCornea, eye.nAqueous));
}

// The direction behind an interface; n against d. False: totally reflected.
bool refract(Vec3 d, Vec3 n, double from, double to, Vec3* out) {
    const double cosine = -dot(d, n), ratio = from / to, sine2 = ratio * ratio * (1 - cosine * cosine);
    if (sine2 > 1) return false;
    *out = ratio * d + (ratio * cosine - std::sqrt(1 - sine2)) * n;
    return true;
}

}  // namespace

EyeHit traceEye(const Eye& eye, Vec3 origin, Vec3 d) {
    EyeHit hit;
    // Marches near the eye, in steps smaller than any part of the surface.
    const double middle = -dot(origin, d), reach = 2 * eye.sclera + eye.chamber;
    const Vec3 start = origin + (middle - reach) * d;
    double tCornea = 0, tSclera = 0;
    const bool ball = meetSclera(eye, start, d, &tSclera);
    const auto above = [&](double t) {
        const Vec3 p = start + t * d;
        return onCornea(eye, p) || p.z > eye.limbusZ() ? aboveCornea(eye, p) : 1.0;
    };
    bool dome = firstRoot(above, 0, 2 * reach, 4000, &tCornea) && onCornea(eye, start + tCornea * d) &&
                (!ball || tCornea <= tSclera + 1e-6 ||
                 std::hypot((start + tSclera * d).x, (start + tSclera * d).y) < eye.limbus);
    if (dome) {
        const Vec3 p = start + tCornea * d;
        hit.point = p;
        hit.normal = eye.corneaNormal(p.x, p.y);
        if (dot(hit.normal, d) >= 0) dome = false;
    }
    if (!dome) {
        hit.point = start + tSclera * d;
        hit.normal = normalized(hit.point);
        return hit;
    }
    hit.cornea = true;
    const double r = std::hypot(hit.point.x, hit.point.y);
    hit.share = 1 - smoothstep01(saturate((r - eye.limbus + eye.limbusWidth) /
                                          std::max(eye.limbusWidth, 1e-6 * eye.limbus)));
    Vec3 inside = d;
    refract(d, hit.normal, 1, eye.nAqueous, &inside);
    hit.transmittance = corneaTransmittance(eye, -dot(d, hit.normal));
    const double s = meetIris(eye, hit.point, inside);
    hit.px = hit.point.x + s * inside.x, hit.py = hit.point.y + s * inside.y;
    hit.radius = std::hypot(hit.px, hit.py);
    if (hit.radius > eye.iris) {
        hit.px *= eye.iris / hit.radius, hit.py *= eye.iris / hit.radius;
        hit.radius = eye.iris;
    }
    hit.cosine = -inside.z;
    return hit;
}

double irisVisible(const Eye& eye, const EyeHit& hit) {
    double visible = 1;
    if (eye.pupil > 0)
        visible = saturate((hit.radius - eye.pupil) / std::min(0.02 * eye.iris, 0.1 * eye.pupil));
    const double width = std::max(eye.limbusWidth, 1e-6 * eye.limbus);
    const double border = eye.limbus - width, from = std::hypot(hit.point.x, hit.point.y);
    const double rim = std::max(smoothstep01(saturate((hit.radius - (eye.iris - width)) / width)),
                                smoothstep01(saturate((from - (border - width)) / width)));
    const double depth = std::min(-std::log(std::max(1 - eye.limbusDarkening, 1e-30)), 7.0);
    return visible * std::exp(-depth * rim / std::max(hit.cosine, 0.1));
}

Vec2 irisTexture(const Eye& eye, const EyeHit& hit) {
    const double t = saturate((hit.radius - eye.pupil) / (eye.iris - eye.pupil));
    const double place = eye.texturePupil + t * (1 - eye.texturePupil), r = std::max(hit.radius, 1e-12);
    return {0.5 + 0.5 * place * hit.px / r, 0.5 - 0.5 * place * hit.py / r};
}

namespace {

// Carries one photon from the cornea to the iris; calls land(x, y, weight, bounces) each time a part of it
// gets there.
template <class Land>
void carry(const Eye& eye, Vec3 p, Vec3 d, double weight, const Land& land) {
    for (int bounce = 0; bounce < 12 && weight > 1e-7; ++bounce) {
        const double toIris = meetIris(eye, p, d);
        // The cornea from inside, beyond the point where the photon is.
        const double most = std::min(toIris, 4 * eye.limbus);
        double t = 0;
        bool meets = false;
        if (eye.corneaZ(std::min(std::hypot(p.x + most * d.x, p.y + most * d.y), eye.limbus)) <
                p.z + most * d.z ||
            std::hypot(p.x + most * d.x, p.y + most * d.y) > eye.limbus)
            meets = firstRoot([&](double s) { return -aboveCornea(eye, p + s * d); }, 1e-6, most, 400, &t) &&
                    onCornea(eye, p + t * d);
        if (!meets) {
            const Vec3 q = p + toIris * d;
            if (toIris < 1e29 && std::hypot(q.x, q.y, q.z) < eye.sclera) land(q.x, q.y, weight, bounce);
            return;
        }
        p = p + t * d;
        const Vec3 n = -1 * eye.corneaNormal(p.x, p.y);
        const double cosine = -dot(d, n);
        const double between = std::sqrt(
            max0(1 - (1 - cosine * cosine) * eye.nAqueous * eye.nAqueous / (eye.nCornea * eye.nCornea)));
        const double inner = fresnel(cosine, eye.nAqueous, eye.nCornea),
                     outer = fresnel(between, eye.nCornea, 1);
        weight *= 1 - (1 - inner) * (1 - outer);
        d = d + 2 * cosine * n;
    }
}

// Light that enters at a point of the cornea per area of the limbus' plane, and its direction; 0 in shadow.
double enter(const Eye& eye, Vec3 toLight, double x, double y, Vec3* p, Vec3* d) {
    *p = {x, y, eye.corneaZ(std::hypot(x, y))};
    const Vec3 n = eye.corneaNormal(x, y);
    const double cosine = dot(n, toLight);
    double t = 0;
    if (cosine <= 0 || meetSclera(eye, *p + 1e-9 * toLight, toLight, &t)) return 0;
    refract(-1 * toLight, n, 1, eye.nAqueous, d);
    return cosine / n.z * corneaTransmittance(eye, cosine);
}

}  // namespace

double Caustic::at(double x, double y, double iris) const {
    const double c = std::clamp((x / iris + 1) * 0.5 * width - 0.5, 0.0, width - 1.0);
    const double r = std::clamp(std::abs(y) / iris * height - 0.5, 0.0, height - 1.0);
    return bilinearAt(c, r, [&](int i, int j) {
        return texels[size_t(std::min(j, height - 1)) * width + std::min(i, width - 1)];
    });
}

Caustic tracePhotons(const Eye& eye, double angle, int width, int height, uint64_t photons, uint64_t seed) {
    Caustic caustic{width, height, std::vector<double>(size_t(width) * height), 0, 0};
    const Vec3 toLight{std::sin(angle), 0, std::cos(angle)};
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> u(0, 1);
    // One half of the cornea; the other is its mirror image.
    const auto side = int(std::sqrt(double(photons) * 8 / pi / 2));
    const double cell = 2 * eye.limbus / side, texel = 2 * eye.iris / width * eye.iris / height;
    for (int j = 0; j < (side + 1) / 2; ++j)
        for (int i = 0; i < side; ++i) {
            const double x = (i + u(random)) * cell - eye.limbus, y = (j + u(random)) * cell;
            if (x * x + y * y >= eye.limbus * eye.limbus) continue;
            Vec3 p, d;
            const double flux = enter(eye, toLight, x, y, &p, &d) * cell * cell;
            if (flux <= 0) continue;
            carry(eye, p, d, 1, [&](double px, double py, double weight, int bounces) {
                const double c = (px / eye.iris + 1) * 0.5 * width, r = std::abs(py) / eye.iris * height;
                if (c < 0 || c >= width || r >= height) return;
                caustic.texels[size_t(r) * width + size_t(c)] += flux * weight / texel;
                caustic.flux += flux * weight;
                if (bounces) caustic.bounced += flux * weight;
            });
        }
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double x = ((i + 0.5) / width * 2 - 1) * eye.iris, y = (j + 0.5) / height * eye.iris;
            const double slope = 2 * eye.concavity * std::hypot(x, y) / (eye.iris * eye.iris);
            caustic.texels[size_t(j) * width + i] /= std::sqrt(1 + slope * slope);
        }
    return caustic;
}

double fluxOnIris(const Eye& eye, double angle, int steps) {
    const Vec3 toLight{std::sin(angle), 0, std::cos(angle)};
    double sum = 0;
    // Equal areas in polar coordinates, upper half.
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < steps; ++i) {
            const double r = eye.limbus * std::sqrt((j + 0.5) / steps), phi = pi * (i + 0.5) / steps;
            Vec3 p, d;
            const double flux = enter(eye, toLight, r * std::cos(phi), r * std::sin(phi), &p, &d);
            if (flux <= 0) continue;
            carry(eye, p, d, 1, [&](double x, double y, double weight, int) {
                if (std::hypot(x, y) <= eye.iris) sum += flux * weight;
            });
        }
    return sum * pi * eye.limbus * eye.limbus / (double(steps) * steps);
}

double ambientOnIris(const Eye& eye, double r, int steps) {
    const Vec3 p{r, 0, eye.irisHeight(r)};
    const Vec3 n = normalized({-2 * eye.concavity * r / (eye.iris * eye.iris), 0, 1});
    const Vec3 a = normalized(cross({0, 1, 0}, n)), b = cross(n, a);
    double sum = 0;
    for (int j = 0; j < steps; ++j)
        for (int i = 0; i < steps; ++i) {
            // Cosine-weighted.
            const double s = std::sqrt((j + 0.5) / steps), phi = 2 * pi * (i + 0.5) / steps;
            const Vec3 d = s * std::cos(phi) * a + s * std::sin(phi) * b + std::sqrt(1 - s * s) * n;
            double t = 0;
            if (!firstRoot([&](double x) { return -aboveCornea(eye, p + x * d); }, 1e-9, 4 * eye.limbus, 400,
                           &t))
                continue;
            const Vec3 q = p + t * d;
            if (!onCornea(eye, q)) continue;
            const Vec3 inward = -1 * eye.corneaNormal(q.x, q.y);
            Vec3 out;
            if (!refract(d, inward, eye.nAqueous, 1, &out)) continue;
            if (meetSclera(eye, q + 1e-9 * out, out, &t)) continue;
            sum += eye.nAqueous * eye.nAqueous * corneaTransmittance(eye, -dot(out, inward));
        }
    return sum / (double(steps) * steps);
}

double tearGloss(Vec3 n, Vec3 l, Vec3 v, double roughness, double index) {
    if (!(dot(n, l) > 0) || !(dot(n, l + v) > 0)) return 0;
    return pi * dot(n, l) * ggxLobe(n, l, v, roughness) * fresnel(max0(dot(v, normalized(l + v))), 1, index);
}

}  // namespace reference
