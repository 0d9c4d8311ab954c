#include "reference/shade.h"

#include "reference/lut.h"

namespace reference {

Rgb bilinear(const Table& table, double s, double t) {
    const auto place = [](double c, int count) { return std::clamp(c * count - 0.5, 0.0, count - 1.0); };
    return bilinearAt(place(s, table.width), place(t, table.height), [&](int i, int j) {
        const int x = std::min(i, table.width - 1), y = std::min(j, table.height - 1);
        return table.texels[size_t(y) * table.width + x];
    });
}

const CubeFace cubeFaces[6] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                               {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                               {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};

namespace {

Rgb texel(const CubeMap& cube, int face, int x, int y) {
    const Rgb& c = cube.at(face, x, y);
    return {max0(c.x), max0(c.y), max0(c.z)};
}

// Bilinear on one face alone, clamped to the outermost centres.
Rgb onFace(const CubeMap& cube, int face, double s, double t) {
    const int last = cube.size - 1;
    const auto at = [&](double v) { return std::clamp((v + 1) / 2 * cube.size - 0.5, 0.0, double(last)); };
    return bilinearAt(at(s), at(t),
                      [&](int x, int y) { return texel(cube, face, std::min(x, last), std::min(y, last)); });
}

// Light at a point of the cube's surface on an edge or corner: the mean of all faces that have it. On an
// edge, texels half a texel inside stand for a point that lies further out by 1 / (1 - 1/2n) once they are
// averaged.
Rgb onEdge(const CubeMap& cube, Vec3 point) {
    int meeting = 0;
    for (int c = 0; c < 3; ++c) meeting += std::abs(std::abs(point[c]) - 1) < 1e-12;
    Rgb sum;
    for (const CubeFace& f : cubeFaces) {
        if (dot(f.out, point) < 1 - 1e-12) continue;
        const double inward = meeting == 2 ? 1 - 0.5 / cube.size : 1;
        double s = dot(f.right, point), t = dot(f.down, point);
        if (std::abs(std::abs(s) - 1) > 1e-12) s *= inward;
        if (std::abs(std::abs(t) - 1) > 1e-12) t *= inward;
        sum = sum + onFace(cube, int(&f - cubeFaces), s, t);
    }
    return sum / meeting;
}

}  // namespace

Vec3 cubeDirection(int face, double s, double t) {
    return cubeFaces[face].out + s * cubeFaces[face].right + t * cubeFaces[face].down;
}

Rgb sampleCube(const CubeMap& cube, Vec3 d) {
    if (dot(d, d) == 0) return {};
    int face = 0;
    for (int f = 1; f < 6; ++f)
        if (dot(cubeFaces[f].out, d) > dot(cubeFaces[face].out, d)) face = f;
    const Vec3 p = d / dot(cubeFaces[face].out, d);
    const double s = dot(cubeFaces[face].right, p), t = dot(cubeFaces[face].down, p);
    // Knots of the interpolation along each side: -1, the centres, 1.
    std::vector<double> knots{-1};
    for (int i = 0; i < cube.size; ++i) knots.push_back((2 * i + 1.0) / cube.size - 1);
    knots.push_back(1);
    const auto before = [&](double v) {
        int k = 0;
        while (k + 2 < int(knots.size()) && knots[k + 1] <= v) ++k;
        return k;
    };
    const int i = before(s), j = before(t);
    const auto knot = [&](int x, int y) {
        const bool inside = x > 0 && x <= cube.size && y > 0 && y <= cube.size;
        return inside ? texel(cube, face, x - 1, y - 1)
                      : onEdge(cube, cubeDirection(face, knots[x], knots[y]));
    };
    const double fs = (s - knots[i]) / (knots[i + 1] - knots[i]),
                 ft = (t - knots[j]) / (knots[j + 1] - knots[j]);
    return mix(mix(knot(i, j), knot(i + 1, j), fs), mix(knot(i, j + 1), knot(i + 1, j + 1), fs), ft);
}

double radiusRatio(double lutRadius, double materialRadius) {
    return lutRadius / materialRadius;
}

double curvatureRow(double curvature, double radiusMin, double radiusMax, double f) {
    const double least = f / radiusMax, most = f / radiusMin;
    return most > least ? (curvature - least) / (most - least) : 0;
}

double shadowRow(double cosine, double filterWidth, double widthMin, double widthMax, double f) {
    const double least = f / widthMax, most = f / widthMin;
    return most > least ? (saturate(cosine) / filterWidth - least) / (most - least) : 0;
}

double blurredNormalMip(double mapSize, double diffusionRadius, double uvScale) {
    return std::log2(std::max(mapSize * diffusionRadius, uvScale) / uvScale);
}

Rgb direct(Rgb delta, Vec3 shading, Vec3 blurred, Vec3 toLight, Rgb blend) {
    const double away = saturate(1 - dot(blurred, toLight)), s = away * away;
    Rgb lit;
    for (int c = 0; c < 3; ++c) {
        const Vec3 normal = normalized(mix(shading, blurred, blend[c] + (1 - blend[c]) * s));
        lit[c] = saturate(delta[c] + saturate(dot(toLight, normal)));
    }
    return lit;
}

double sharpenedShadow(double wide, double sharpening) {
    const double k = 0.9 * sharpening;
    return smoothstep01(saturate(wide * k + 0.5 * (1 - k)));
}

Rgb irradiance(const Ambient& ambient, Vec3 n) {
    // Real orthonormal harmonics: the constants make each one's square integrate to 1 over the sphere.
    const double band0 = std::sqrt(1 / (4 * pi)), band1 = std::sqrt(3 / (4 * pi));
    const double band2 = std::sqrt(15 / (4 * pi)), zonal = std::sqrt(5 / (16 * pi));
    const double xy = n.x * n.y, yz = n.y * n.z, xz = n.x * n.z, zz = 3 * n.z * n.z - 1,
                 across = 0.5 * (n.x * n.x - n.y * n.y);
    const double basis[9] = {band0,      band1 * n.y, band1 * n.z, band1 * n.x,   band2 * xy,
                             band2 * yz, zonal * zz,  band2 * xz,  band2 * across};
    Rgb sum = ambient.constant;
    for (int i = 0; i < 9; ++i) sum = sum + basis[i] * ambient.harmonics[i];
    sum = {max0(sum.x), max0(sum.y), max0(sum.z)};
    return ambient.cube ? sum + sampleCube(*ambient.cube, n) : sum;
}

std::array<Vec3, 3> ambientNormals(Vec3 shading, Vec3 blurred, Rgb blend) {
    return {normalized(mix(shading, blurred, blend.x)), normalized(mix(shading, blurred, blend.y)),
            normalized(mix(shading, blurred, blend.z))};
}

Rgb ambientTerm(const Ambient& ambient, Vec3 shading, Vec3 blurred, Rgb blend) {
    const auto normals = ambientNormals(shading, blurred, blend);
    Rgb light;
    for (int c = 0; c < 3; ++c) light[c] = irradiance(ambient, normals[c])[c];
    return light;
}

double sampleMap(const ShadowMap& map, double u, double v) {
    const auto depth = [&](double x, double y) {
        const int i = std::clamp(int(std::floor(x)), 0, map.width - 1),
                  j = std::clamp(int(std::floor(y)), 0, map.height - 1);
        return map.depth[size_t(j) * map.width + i];
    };
    const double x = std::clamp(u * map.width - 0.5, 0.0, map.width - 1.0), fx = x - std::floor(x),
                 y = std::clamp(v * map.height - 0.5, 0.0, map.height - 1.0), fy = y - std::floor(y);
    // With a NaN texel of weight 0, std::lerp gives the other texel: fewer pixels are NaN than with mix().
    return std::lerp(std::lerp(depth(x, y), depth(x + 1, y), fx),
                     std::lerp(depth(x, y + 1), depth(x + 1, y + 1), fx), fy);
}

Vec3 shadowCoordinates(const Matrix4& m, Vec3 position, Vec3 normal, double offset) {
    const Vec3 inside = position - offset * normal;
    double h[4];
    for (int i = 0; i < 4; ++i) h[i] = m[i][0] * inside.x + m[i][1] * inside.y + m[i][2] * inside.z + m[i][3];
    return {h[0] / h[3], h[1] / h[3], h[2] / h[3]};
}

double thickness(const ShadowMap& map, Vec3 uvDepth, const std::vector<Vec2>& taps, double filterRadius,
                 const DepthDecoding& decoding) {
    const double receiver = decoding.distance(uvDepth.z);
    double sum = 0;
    for (const Vec2& tap : taps)
        sum += max0(receiver - decoding.distance(sampleMap(map, uvDepth.x + filterRadius * tap.x,
                                                           uvDepth.y + filterRadius * tap.y)));
    return sum / double(taps.size());
}

std::vector<Vec2> turnedTaps(std::vector<Vec2> taps, uint32_t column, uint32_t row) {
    const double plastic = 1.32471795724474602596;  // p³ = p + 1
    const auto turns = [](double fraction) { return std::floor(fraction * 0x1p32) * 0x1p-32; };
    const double turn = std::fmod(column * turns(1 / plastic) + row * turns(1 / (plastic * plastic)), 1.0);
    const double angle = 2 * pi * turn;
    for (Vec2& tap : taps)
        tap = {tap.x * std::cos(angle) - tap.y * std::sin(angle),
               tap.x * std::sin(angle) + tap.y * std::cos(angle)};
    return taps;
}

double deepScatter(double t, double radius, Vec3 blurred, Vec3 toLight) {
    return std::exp(-t * t / (2 * radius * radius)) * saturate(0.3 - dot(blurred, toLight));
}

double schlick(double cosine, double f0) {
    return f0 + (1 - f0) * std::pow(1 - cosine, 5);
}

double specular(Vec3 shading, Vec3 toLight, Vec3 toViewer, double roughness, double intensity, double f0) {
    const Vec3 sum = toLight + toViewer;
    const double cosine = dot(shading, toLight), squared = dot(sum, sum);
    if (!(cosine > 0) || !(squared > 0)) return 0;
    const Vec3 half = normalized(sum);
    const double lobe = beckmann(dot(shading, half), roughness);
    return intensity * cosine * max0(lobe * schlick(dot(toViewer, half), f0) / squared);
}

double ggxLobe(Vec3 n, Vec3 l, Vec3 v, double a) {
    const double nh = dot(n, normalized(l + v)), nl = dot(n, l), nv = std::max(dot(n, v), 1e-3);
    const double d = a * a / (pi * std::pow(nh * nh * (a * a - 1) + 1, 2));
    const auto hidden = [&](double c) { return (std::sqrt(1 + a * a * (1 / (c * c) - 1)) - 1) / 2; };
    return d / (1 + hidden(nl) + hidden(nv)) / (4 * nl * nv);
}

double specularGgx(Vec3 n, Vec3 l, Vec3 v, double roughness, double roughness2, double lobeMix,
                   double intensity, double f0) {
    const double nl = dot(n, l);
    if (!(nl > 0) || !(dot(n, l + v) > 0)) return 0;
    const double lobes = mix(ggxLobe(n, l, v, roughness), ggxLobe(n, l, v, roughness2), lobeMix);
    return intensity * nl * pi * schlick(dot(v, normalized(l + v)), f0) * lobes;
}

namespace {

Rgb deltaAt(const Material& material, const Pixel& pixel, Vec3 toLight) {
    if (!material.curvatureLut) return {};
    const ScatterTable& lut = *material.curvatureLut;
    const double u = dot(pixel.blurred, toLight);
    const double row = curvatureRow(pixel.curvature, lut.least, lut.most,
                                    radiusRatio(lut.diffusionRadius, material.diffusionRadius));
    return bilinear(lut.table, 0.5 * u + 0.5, row) - max0(u) * Rgb{1, 1, 1};
}

Rgb shadowAt(const Material& material, const Pixel& pixel, const PixelLight& light) {
    if (!material.shadowLut) return light.wideShadow * Rgb{1, 1, 1};
    const ScatterTable& lut = *material.shadowLut;
    const double row = shadowRow(dot(pixel.geometric, light.toLight), material.shadowFilterWidth, lut.least,
                                 lut.most, radiusRatio(lut.diffusionRadius, material.diffusionRadius));
    return bilinear(lut.table, light.wideShadow, row);
}

}  // namespace

Shaded shadeLight(const Material& material, const Pixel& pixel, const PixelLight& light) {
    Shaded out;
    const Rgb delta = deltaAt(material, pixel, light.toLight);
    const Rgb lit = direct(delta, pixel.shading, pixel.blurred, light.toLight, material.normalBlend);
    out.scattered = material.albedo * light.color * lit * shadowAt(material, pixel, light);
    if (light.hasThickness && magnitude(material.deepScatterColor) > 0)
        out.deepScatter =
            deepScatter(light.thickness, material.deepScatterRadius, pixel.blurred, light.toLight) *
            (material.deepScatterColor * material.albedo * light.color);
    if (material.specular > 0) {
        const double shadow = material.shadowLut
                                  ? sharpenedShadow(light.wideShadow, material.shadowLut->sharpening)
                                  : light.wideShadow;
        const double lobe =
            material.ggx ? specularGgx(pixel.shading, light.toLight, pixel.toViewer, material.roughness,
                                       material.roughness2, material.lobeMix, material.specular, material.f0)
                         : specular(pixel.shading, light.toLight, pixel.toViewer, material.roughness,
                                    material.specular, material.f0);
        out.specular = shadow * lobe * light.color;
    }
    return out;
}

Shaded shadePixel(const Material& material, const Pixel& pixel, const std::vector<PixelLight>& lights,
                  const Ambient& ambient) {
    Shaded total;
    for (const PixelLight& light : lights) {
        const Shaded one = shadeLight(material, pixel, light);
        total.scattered = total.scattered + one.scattered;
        total.deepScatter = total.deepScatter + one.deepScatter;
        total.specular = total.specular + one.specular;
    }
    total.ambient =
        material.albedo *
        (pixel.ambientOcclusion * ambientTerm(ambient, pixel.shading, pixel.blurred, material.normalBlend) +
         pixel.indirect);
    if (pixel.hasThickness && material.deepScatterAmbient > 0) {
        const double t = pixel.thickness / material.deepScatterRadius;
        total.deepScatter = total.deepScatter + material.deepScatterAmbient * std::exp(-t * t / 2) *
                                                    (material.deepScatterColor * material.albedo *
                                                     irradiance(ambient, -1 * pixel.blurred));
    }
    return total;
}

PixelLight lampAt(const Lamp& lamp, Vec3 position) {
    const Vec3 offset = lamp.position - position;
    const double distance = length(offset);
    PixelLight light;
    light.toLight = offset / distance;
    double strength = 1 / (distance * distance);
    if (lamp.range > 0 && distance > lamp.range) strength = 0;
    if (lamp.spot) {
        const double cosine = -dot(light.toLight, lamp.axis);
        strength *= smoothstep01(saturate((cosine - lamp.cosOuter) / (lamp.cosInner - lamp.cosOuter)));
    }
    light.color = strength * lamp.color;
    return light;
}

}  // namespace reference
