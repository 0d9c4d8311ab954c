// What the oracle says of shadow maps of every form: wide shadow and thickness at a place.
#pragma once
#include "shadow_form_scene.h"

namespace shade_test {

// At a place with its geometric normal. Refers to the light that it was made of.
struct FormTruth {
    std::function<double(const PelMaterial&, Vec3, Vec3)> wide;
    std::function<double(const PelMaterial&, Vec3, Vec3, const std::vector<reference::Vec2>& taps)> thickness;
};

inline reference::WideFilterParams filterOf(const PelLight& l, const PelMaterial& m) {
    return {m.shadowFilterWidth, l.shadowBias, l.shadowSoftness, l.shadowConeSlope,
            int(l.shadowFilterTexels)};
}
inline Vec3 insetOf(const PelMaterial& m, Vec3 p, Vec3 n) {
    return p - double(m.deepScatterNormalOffset) * n;
}

inline FormTruth truthOf(const MapLight& from) {
    const PelLight& l = from.light.params;
    return {[&](const PelMaterial& m, Vec3 p, Vec3 n) {
                return reference::wideShadow(from.map, from.view, p, n, filterOf(l, m));
            },
            [&](const PelMaterial& m, Vec3 p, Vec3 n, const auto& taps) {
                return reference::thickness(
                    from.map,
                    reference::shadowCoordinates(matrixOf(l.worldToShadow), p, n, m.deepScatterNormalOffset),
                    taps, m.thicknessFilterRadius, from.view.decoding, reference::MapFilter::bilinear);
            }};
}

inline FormTruth truthOf(const CubeLight& from) {
    return {[&](const PelMaterial& m, Vec3 p, Vec3 n) {
                return reference::cubeWideShadow(from.map, from.turn(p - from.position), from.turn(n),
                                                 filterOf(from.light.params, m));
            },
            [&](const PelMaterial& m, Vec3 p, Vec3 n, const auto& taps) {
                return reference::cubeThickness(from.map, from.turn(insetOf(m, p, n) - from.position), taps,
                                                m.thicknessFilterRadius);
            }};
}

inline std::vector<reference::Matrix4> matricesOf(const CascadeLight& from) {
    const PelLight& l = from.light.params;
    std::vector<reference::Matrix4> matrices{matrixOf(l.worldToShadow)};
    for (uint32_t i = 1; i < l.shadowCascades; ++i) matrices.push_back(matrixOf(l.cascadeToShadow[i - 1]));
    return matrices;
}

inline FormTruth truthOf(const CascadeLight& from) {
    const std::vector<reference::Matrix4> matrices = matricesOf(from);
    return {[&from, matrices](const PelMaterial& m, Vec3 p, Vec3 n) {
                const int k = reference::cascadeOf(matrices, p, m.shadowFilterWidth / 2);
                return k < 0 ? 1
                             : reference::wideShadow(from.maps[size_t(k)].map, from.maps[size_t(k)].view, p,
                                                     n, filterOf(from.light.params, m));
            },
            [&from, matrices](const PelMaterial& m, Vec3 p, Vec3 n, const auto& taps) {
                const Vec3 inside = insetOf(m, p, n);
                const double radius = m.thicknessFilterRadius / reference::uvPerLength(matrices[0], 0);
                const int k = reference::cascadeOf(matrices, inside, radius);
                if (k < 0) return 0.0;
                const auto& matrix = matrices[size_t(k)];
                return reference::thickness(
                    from.maps[size_t(k)].map, reference::shadowCoordinates(matrix, inside, {0, 0, 0}, 0),
                    taps, radius * reference::uvPerLength(matrix, 0), from.maps[size_t(k)].view.decoding,
                    reference::MapFilter::bilinear);
            }};
}

inline FormTruth truthOf(const ContentLight& from) {
    const PelLight& l = from.light.params;
    const bool moments = l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS;
    return {[&from, &l, moments](const PelMaterial& m, Vec3 p, Vec3 n) {
                return moments
                           ? reference::momentShadow(from.first, from.second, from.from.view, p, n,
                                                     filterOf(l, m), {l.shadowMinDeviation, l.shadowBleeding})
                           : reference::exponentialShadow(from.first, l.shadowExponent, from.from.view, p, n,
                                                          filterOf(l, m));
            },
            [&from, &l, moments](const PelMaterial& m, Vec3 p, Vec3 n, const auto& taps) {
                const Vec3 uvz =
                    reference::shadowCoordinates(matrixOf(l.worldToShadow), p, n, m.deepScatterNormalOffset);
                return moments ? reference::thickness(from.first, uvz, taps, m.thicknessFilterRadius,
                                                      from.from.view.decoding, reference::MapFilter::bilinear)
                               : reference::exponentialThickness(from.first, l.shadowExponent, uvz, taps,
                                                                 m.thicknessFilterRadius,
                                                                 from.from.view.decoding);
            }};
}

struct Worst {
    double wide = 0, thickness = 0;
    size_t penumbra = 0, thick = 0;  // pixels: there is something to see
};
// Leaves out pixels for which `counts`, if given, is false.
inline Worst worstOf(const Frame& f, const Seen& seen, const FormTruth& truth,
                     const std::function<bool(const PelMaterial&, Vec3, Vec3)>& counts = {}) {
    Worst worst;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const PelMaterial* m = materialAt(f, i);
        const Vec3 p = f.slots[PEL_SLOT_POSITION].vec(i), n = f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i);
        if (!m || (counts && !counts(*m, p, n))) continue;
        const double wide = truth.wide(*m, p, n), thickness = truth.thickness(*m, p, n, tapsOf(f, *m, i));
        worst.wide = std::max(worst.wide, std::abs(wide - seen.wide[i]));
        worst.thickness = std::max(worst.thickness, std::abs(thickness - seen.thickness[i]));
        worst.penumbra += wide > 0.1 && wide < 0.9;
        worst.thick += thickness > 1;
    }
    return worst;
}

}  // namespace shade_test
