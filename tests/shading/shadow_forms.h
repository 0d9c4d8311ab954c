// Frames lit through shadow maps of every form: wide shadow and thickness per pixel, of the shader and of the
// oracle.
#pragma once
#include "pass_scene.h"

namespace shade_test {

struct Seen {
    std::vector<float> wide, thickness;  // of the first light
    PelShaderStats stats = pelShaderStatsDefaults();
};

// A relief under the first of the lights: `taps` taps within `radius`, filters as wide as material 1 says.
inline Frame formFrame(uint32_t seed = 1, uint32_t width = 120, uint32_t height = 50, float radius = 0.03f) {
    Frame f = reliefFrame(seed, width, height, 0.4f);
    f.materials[2].shadowFilterWidth = 5;
    for (auto& [id, m] : f.materials) {
        for (float& c : m.deepScatterColor) c = 1;
        m.thicknessTaps = id == 1 ? 16 : 8;
        m.thicknessFilterRadius = radius;
    }
    return f;
}

// Adds black lights with tiny maps of all forms, so that every test runs the same program, the one with all
// forms.
inline std::vector<Light> withAllForms(std::vector<Light> lights) {
    const PelLight like = lights[0].params;  // whose place changes as others join
    const float e = like.shadowContent == PEL_SHADOW_CONTENT_EXPONENTIAL ? like.shadowExponent : 0;
    const uint32_t components = lights[0].maps.empty() ? 1 : lights[0].maps[0].components;
    Light cube, cascade;
    cube.params.type = PEL_LIGHT_POINT;
    cube.params.range = 1e-3f;
    cube.params.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
    cube.maps = {{PEL_LIGHT_SHADOW_MAP, 2, 12, components, std::vector<float>(24 * components, 0.5f)}};
    cascade.params.shadowCascades = 1;
    cascade.params.shadowDepthRange = 300;
    cascade.maps = {{PEL_LIGHT_SHADOW_MAP, 2, 2, components, std::vector<float>(4 * components, 0.5f)}};
    for (Light* l : {&cube, &cascade}) {
        std::fill_n(l->params.color, 3, 0.0f);
        l->params.shadowFilterTexels = 4;
        l->params.shadowContent = like.shadowContent;
        l->params.shadowExponent = std::abs(e);
        lights.push_back(*l);
    }
    return lights;
}

// Puts the maps of the first light side by side into one buffer.
inline void setAtlas(Shader& shader, const std::vector<MapImage>& maps) {
    uint32_t row = 0, offset = 0;  // floats
    for (const MapImage& m : maps) row += m.width * m.components;
    std::vector<float> all(size_t(row) * maps[0].height);
    for (const MapImage& m : maps) {
        const size_t length = m.width * m.components;
        for (uint32_t y = 0; y < m.height; ++y)
            std::copy_n(&m.values[y * length], length, &all[size_t(y) * row + offset]);
        offset += uint32_t(length);
    }
    const Buffer shared(device(), all);
    offset = 0;
    for (const MapImage& m : maps) {
        PelImageDesc desc =
            imageDesc(shared, floatFormats[m.components], m.width, m.height, offset * sizeof(float));
        desc.rowStride = row * sizeof(float);
        shader.set(0, m.slot, desc);
        offset += m.width * m.components;
    }
}

inline Seen shadeForms(Frame f, std::vector<Light> lights, bool atlas = false) {
    f.lights = withAllForms(std::move(lights));
    const PelLight& first = f.lights[0].params;
    std::vector<double> strength(f.pixels(), 1);
    for (size_t i = 0; i < f.pixels(); ++i) {
        Vec3 toLight = vectorOf(first.toLight);
        if (first.type != PEL_LIGHT_DIRECTIONAL) {
            const Vec3 away = vectorOf(first.position) - f.slots[PEL_SLOT_POSITION].vec(i);
            strength[i] = 1 / dot(away, away);
            toLight = normalized(away);
        }
        f.slots[PEL_SLOT_NORMAL_SHADING].set(i, toLight);
    }
    Seen seen;
    Buffer diffuse, thickness;
    shade(device(), f, tables(), &seen.stats, [&](Shader& shader) {
        if (atlas) setAtlas(shader, f.lights[0].maps);
        diffuse = setTarget(device(), shader, f, PEL_SLOT_OUT_DIFFUSE);
        thickness = setTarget(device(), shader, f, PEL_SLOT_OUT_THICKNESS);
    });
    seen.thickness = thickness.readAll<float>();
    const auto light = diffuse.readAll<float>();
    for (size_t i = 0; i < f.pixels(); ++i)
        seen.wide.push_back(float(light[3 * i] / (strength[i] * first.color[0])));
    return seen;
}

// A place of a surface, with its geometric normal.
struct SurfacePlace {
    const PelMaterial& material;
    Vec3 position, normal;
    Vec3 inset() const { return position - double(material.deepScatterNormalOffset) * normal; }
};
// Of a pixel that has a material.
inline std::optional<SurfacePlace> placeAt(const Frame& f, size_t i) {
    const auto found = f.materials.find(uint32_t(f.slots[PEL_SLOT_MATERIAL].at(i)));
    if (found == f.materials.end()) return std::nullopt;
    return SurfacePlace{found->second, f.slots[PEL_SLOT_POSITION].vec(i),
                        f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i)};
}

inline std::vector<reference::Vec2> tapsOf(const Frame& f, const PelMaterial& m, size_t i) {
    const auto taps = diskTaps(m.thicknessTaps);
    return f.options.rotateTaps ? reference::turnedTaps(taps, uint32_t(i % f.width), uint32_t(i / f.width))
                                : taps;
}

// --- cubes ---

struct Turn {
    Vec3 x, y, z;  // rows: world to the space of the cube
    Vec3 operator()(Vec3 v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    Vec3 back(Vec3 v) const { return v.x * x + v.y * y + v.z * z; }
};
// The direction `to` of the world becomes `axis` of the cube.
inline Turn turnTo(Vec3 to, Vec3 axis) {
    const auto frame = [](Vec3 a) {
        a = normalized(a);
        const Vec3 b = normalized(cross(a, Vec3{0.31, 0.83, 0.47}));
        return std::array{a, b, cross(a, b)};
    };
    const auto w = frame(to), c = frame(axis);
    const auto row = [&](int k) { return c[0][k] * w[0] + c[1][k] * w[1] + c[2][k] * w[2]; };
    return {row(0), row(1), row(2)};
}

struct CubeLight {
    Light light;
    reference::CubeShadowMap map;
    Turn turn;
    Vec3 position;
};
// `reach` gives the distance to the first surface along a direction from the light, as a multiple of it.
inline CubeLight cubeLight(uint32_t size, bool radial, Turn turn, Vec3 position,
                           const std::function<double(Vec3, int)>& reach) {
    CubeLight out;
    out.turn = turn;
    out.position = position;
    out.map.size = int(size);
    out.map.radial = radial;
    const double near = 5, far = 1000;
    out.map.decoding = radial ? reference::DepthDecoding{false, far, 0, 1}
                              : reference::DepthDecoding{true, 1, -(far - near) / (near * far), 1 / near};
    PelLight& l = out.light.params;
    l.type = PEL_LIGHT_POINT;
    std::fill_n(l.color, 3, 3600.0f);
    copyTo(l.position, position);
    const Vec3 rows[3] = {turn.x, turn.y, turn.z};
    for (int r = 0; r < 3; ++r) {
        copyTo(l.worldToShadow + 4 * r, rows[r]);
        l.worldToShadow[4 * r + 3] = float(-dot(rows[r], position));
    }
    l.shadowProjection = radial ? PEL_SHADOW_CUBE_RADIAL : PEL_SHADOW_CUBE;
    l.shadowDepthRange = float(far);
    l.shadowDepthA = float(out.map.decoding.a);
    l.shadowDepthB = float(out.map.decoding.b);
    l.shadowFilterTexels = 24;
    MapImage image{PEL_LIGHT_SHADOW_MAP, size, 6 * size, 1, {}};
    for (int face = 0; face < 6; ++face)
        for (uint32_t i = 0; i < size * size; ++i) {
            const Vec3 d = reference::shadowCubeDirection(face, i % size, i / size, int(size));
            const double s = reach(turn.back(d), int(i));
            const double z = radial ? s * length(d) / far : (1 / s - out.map.decoding.b) / out.map.decoding.a;
            image.values.push_back(float(std::clamp(z, 0.0, 1.0)));
            out.map.depth.push_back(image.values.back());
        }
    out.light.maps = {image};
    return out;
}

// --- parallel and perspective maps ---

// The content of a texel for a surface at this distance.
inline double depthOf(const MapLight& from, double distance) {
    const auto& d = from.view.decoding;
    return d.perspective ? (1 / distance - d.b) / d.a : distance / d.range;
}
inline void setDepth(MapLight& from, size_t texel, double distance) {
    from.light.map.values[texel] = float(depthOf(from, distance));
    from.map.depth[texel] = from.light.map.values[texel];
}

// Makes a reversed parallel map go from 1 at the light to 0.
inline void startAtOne(MapLight& from) {
    from.light.params.worldToShadow[11] += 1;
    from.view.origin = from.view.origin + 300.0 * from.view.forward;
    for (float& z : from.light.map.values) z += 1;
    from.map.depth.assign(from.light.map.values.begin(), from.light.map.values.end());
}

// --- cascades ---

// Maps of these extents about one axis, each with its own size, shifted a little against each other.
struct CascadeLight {
    Light light;
    std::vector<MapLight> maps;
};
inline CascadeLight cascadeLight(const std::vector<double>& extents, bool reversed = false,
                                 uint32_t size = 97, bool sameSize = false) {
    CascadeLight out;
    uint32_t i = 0;
    for (const double extent : extents) {
        const uint32_t texels = sameSize ? size : size + 11 * i;
        out.maps.push_back(mapLight(i, false, reversed, {0.3, 0.1, 0.9},
                                    Vec3{24 + 1.5 * i, 10 - double(i), 5}, extent, texels));
        MapLight& map = out.maps.back();
        if (reversed) startAtOne(map);
        const PelLight& l = map.light.params;
        if (i == 0) {
            out.light.params = l;
        } else {
            std::copy_n(l.worldToShadow, 16, out.light.params.cascadeToShadow[i - 1]);
            out.light.params.cascadeDepthRange[i - 1] = l.shadowDepthRange;
        }
        const auto slot = i ? PEL_LIGHT_CASCADE_1 + int(i) - 1 : int(PEL_LIGHT_SHADOW_MAP);
        out.light.maps.push_back({PelLightSlot(slot), texels, texels, 1, map.light.map.values});
        ++i;
    }
    out.light.params.shadowCascades = i;
    return out;
}

// --- moments and exponentials ---

struct ContentLight {
    Light light;
    MapLight from;               // its depths
    reference::ShadowMap first;  // what the texels hold
    std::vector<double> second;
};

// Each texel of the map holds the means over 2 x 2 depths of `from`, whose size is twice that.
inline ContentLight contentLight(PelShadowContent content, bool perspective, bool reversed, uint32_t size) {
    ContentLight out;
    out.from = mapLight(size, perspective, reversed, {0.5, 0.2, 0.9}, {24, 10, 5}, 70, 2 * size);
    auto& depth = out.from.map.depth;
    if (reversed && !perspective) startAtOne(out.from);
    Light& l = out.light;
    l.params = out.from.light.params;
    l.params.shadowContent = content;
    l.params.shadowExponent = reversed ? -80 : 80;
    const uint32_t components = content == PEL_SHADOW_CONTENT_MOMENTS ? 2 : 1;
    l.maps = {{PEL_LIGHT_SHADOW_MAP, size, size, components, {}}};
    out.first.width = out.first.height = int(size);
    for (uint32_t y = 0; y < size; ++y)
        for (uint32_t x = 0; x < size; ++x) {
            double sum[2] = {0, 0};
            for (uint32_t k = 0; k < 4; ++k) {
                const double z = depth[(2 * y + k / 2) * 2 * size + 2 * x + k % 2];
                sum[0] += content == PEL_SHADOW_CONTENT_EXPONENTIAL
                              ? std::exp(l.params.shadowExponent * z) / 4
                              : z / 4;
                sum[1] += z * z / 4;
            }
            for (uint32_t c = 0; c < components; ++c) l.maps[0].values.push_back(float(sum[c]));
            out.first.depth.push_back(float(sum[0]));
            out.second.push_back(float(sum[1]));
        }
    return out;
}

// --- the oracle ---

using Taps = std::vector<reference::Vec2>;

inline reference::WideFilterParams filterOf(const PelLight& l, const PelMaterial& m) {
    return {m.shadowFilterWidth, l.shadowBias, l.shadowSoftness, l.shadowConeSlope,
            int(l.shadowFilterTexels)};
}
inline Vec3 insideMap(const PelLight& l, const SurfacePlace& at) {
    return reference::shadowCoordinates(matrixOf(l.worldToShadow), at.position, at.normal,
                                        at.material.deepScatterNormalOffset);
}

inline double wideOf(const MapLight& from, const SurfacePlace& at) {
    return reference::wideShadow(from.map, from.view, at.position, at.normal,
                                 filterOf(from.light.params, at.material));
}
inline double thicknessOf(const MapLight& from, const SurfacePlace& at, const Taps& taps) {
    return reference::thickness(from.map, insideMap(from.light.params, at), taps,
                                at.material.thicknessFilterRadius, from.view.decoding);
}

inline double wideOf(const CubeLight& from, const SurfacePlace& at) {
    return reference::cubeWideShadow(from.map, from.turn(at.position - from.position), from.turn(at.normal),
                                     filterOf(from.light.params, at.material));
}
inline double thicknessOf(const CubeLight& from, const SurfacePlace& at, const Taps& taps) {
    return reference::cubeThickness(from.map, from.turn(at.inset() - from.position), taps,
                                    at.material.thicknessFilterRadius);
}

inline std::vector<reference::Matrix4> matricesOf(const CascadeLight& from) {
    const PelLight& l = from.light.params;
    std::vector<reference::Matrix4> matrices{matrixOf(l.worldToShadow)};
    for (uint32_t i = 1; i < l.shadowCascades; ++i) matrices.push_back(matrixOf(l.cascadeToShadow[i - 1]));
    return matrices;
}
inline double wideOf(const CascadeLight& from, const SurfacePlace& at) {
    const int k = reference::cascadeOf(matricesOf(from), at.position, at.material.shadowFilterWidth / 2);
    if (k < 0) return 1;
    const MapLight& map = from.maps[size_t(k)];
    return reference::wideShadow(map.map, map.view, at.position, at.normal,
                                 filterOf(from.light.params, at.material));
}
inline double thicknessOf(const CascadeLight& from, const SurfacePlace& at, const Taps& taps) {
    const auto matrices = matricesOf(from);
    const double radius = at.material.thicknessFilterRadius / reference::uvPerLength(matrices[0], 0);
    const int k = reference::cascadeOf(matrices, at.inset(), radius);
    if (k < 0) return 0;
    const auto& matrix = matrices[size_t(k)];
    const MapLight& map = from.maps[size_t(k)];
    return reference::thickness(map.map, reference::shadowCoordinates(matrix, at.inset(), {0, 0, 0}, 0), taps,
                                radius * reference::uvPerLength(matrix, 0), map.view.decoding);
}

inline double wideOf(const ContentLight& from, const SurfacePlace& at) {
    const PelLight& l = from.light.params;
    const auto filter = filterOf(l, at.material);
    return l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS
               ? reference::momentShadow(from.first, from.second, from.from.view, at.position, at.normal,
                                         filter, {l.shadowMinDeviation, l.shadowBleeding})
               : reference::exponentialShadow(from.first, l.shadowExponent, from.from.view, at.position,
                                              at.normal, filter);
}
inline double thicknessOf(const ContentLight& from, const SurfacePlace& at, const Taps& taps) {
    const PelLight& l = from.light.params;
    const double radius = at.material.thicknessFilterRadius;
    const auto& decoding = from.from.view.decoding;
    return l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS
               ? reference::thickness(from.first, insideMap(l, at), taps, radius, decoding)
               : reference::exponentialThickness(from.first, l.shadowExponent, insideMap(l, at), taps, radius,
                                                 decoding);
}

}  // namespace shade_test
