#include "diffusion/light_maps.h"

#include "shading/features.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

using Matrix = std::array<double, 16>;

constexpr uint32_t mostTexels = 4;  // along a side, taken together

// Gauss-Jordan with pivots. Returns false for singular matrices.
bool invert(const Matrix& m, Matrix& inverse) {
    std::array<std::array<double, 8>, 4> a{};
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) a[r][c] = m[4 * r + c], a[r][4 + c] = r == c;
    for (int k = 0; k < 4; ++k) {
        int pivot = k;
        for (int r = k + 1; r < 4; ++r)
            if (std::abs(a[r][k]) > std::abs(a[pivot][k])) pivot = r;
        std::swap(a[k], a[pivot]);
        const double by = a[k][k];
        if (!(std::abs(by) > 0) || !std::isfinite(by)) return false;
        for (double& v : a[k]) v /= by;
        for (int r = 0; r < 4; ++r) {
            const double factor = a[r][k];
            for (int c = 0; r != k && c < 8; ++c) a[r][c] -= factor * a[k][c];
        }
    }
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c) inverse[4 * r + c] = a[r][4 + c];
    return std::all_of(inverse.begin(), inverse.end(), [](double v) { return std::isfinite(v); });
}

Three rowOf(const Matrix& m, int r) {
    return threeAt(&m[4 * r]);
}

// Change of u or v, times the homogeneous coordinate, per length of a step across the light.
double perLength(const Matrix& m, int r) {
    const Three row = rowOf(m, r), forward = rowOf(m, 3);
    const double along = dot(forward, forward) > 0 ? dot(row, forward) / dot(forward, forward) : 0;
    return length(row - along * forward);
}

// A face of a cube as a perspective map: rows of components along u, v and the axis
// (kernels/lib/image/cube_map.clh).
Matrix faceMatrix(const float (&toCube)[16], int face, const PelLight& light) {
    const auto row = [&](int r, double sign) {
        std::array<double, 4> v;
        for (int k = 0; k < 4; ++k) v[k] = sign * double(toCube[4 * r + k]);
        return v;
    };
    const double side = face & 1 ? -1 : 1;
    const auto u = face < 2 ? row(2, -side) : face < 4 ? row(0, 1) : row(0, side);
    const auto v = face < 2 || face >= 4 ? row(1, -1) : row(2, side);
    const auto w = face < 2 ? row(0, side) : face < 4 ? row(1, side) : row(2, side);
    Matrix m{};
    for (int k = 0; k < 4; ++k) {
        m[k] = (u[k] + w[k]) / 2;
        m[4 + k] = (v[k] + w[k]) / 2;
        // 1 / distance along the axis is A z + B; of radial maps it is the depth itself.
        if (light.shadowProjection == PEL_SHADOW_CUBE)
            m[8 + k] = -double(light.shadowDepthB) * w[k] / light.shadowDepthA;
        m[12 + k] = w[k];
    }
    m[11] += light.shadowProjection == PEL_SHADOW_CUBE ? 1 / double(light.shadowDepthA) : 1;
    return m;
}

PelLightMap describe(const ShaderLight& light, uint32_t number, Matrix m, const ImageView& image,
                     uint32_t width, uint32_t height, const float origin[3], double coarsest) {
    const PelLight& l = light.params;
    PelLightMap to{};
    for (int r = 0; r < 4; ++r)
        for (int k = 0; k < 3; ++k) m[4 * r + 3] += m[4 * r + k] * origin[k];
    if (length(rowOf(m, 3)) == 0 && m[15] != 0)
        for (const double w = m[15]; double& v : m) v /= w;
    Matrix inverse{};
    if (!invert(m, inverse))
        invalidArgument(
            "the shadow matrix of light ", number,
            " is singular: PelLight.worldToShadow must be invertible, because scattered light is summed over "
            "its shadow map");
    std::copy(m.begin(), m.end(), to.toMap);
    std::copy(inverse.begin(), inverse.end(), to.toWorld);
    describeLamp(l, to);
    for (int k = 0; k < 3; ++k) to.position[k] = float(double(l.position[k]) - origin[k]);
    if (l.shadowProjection == PEL_SHADOW_CUBE_RADIAL) to.radialRange = l.shadowDepthRange;
    const double texel = std::max(1 / (perLength(m, 0) * width), 1 / (perLength(m, 1) * height));
    to.step = 1;  // the width of a texel of a perspective map depends on the distance of the surface
    if (length(rowOf(m, 3)) == 0)
        while (to.step < mostTexels && 2 * to.step * texel <= coarsest) to.step *= 2;
    to.texel = float(texel * to.step);
    to.size[0] = float(double(width) / to.step), to.size[1] = float(double(height) / to.step);
    to.middle = float((to.step / 2 + 0.5) / to.step);
    to.width = width, to.height = height;
    to.light = number;
    to.map = describeImage(image);
    to.level[0].width = (width + to.step - 1) / to.step;
    to.level[0].height = (height + to.step - 1) / to.step;
    return to;
}

}  // namespace

std::vector<LightMap> lightMaps(const std::vector<ShaderLight>& lights, const float origin[3],
                                double coarsest) {
    std::vector<LightMap> all;
    for (uint32_t i = 0; i < lights.size(); ++i) {
        const ShaderLight& light = lights[i];
        const PelLight& l = light.params;
        const ImageView& first = light.images[PEL_LIGHT_SHADOW_MAP];
        if (!shines(light)) continue;
        const uint32_t count = mapsOf(light);
        if (all.size() + count > PEL_LIGHT_MAPS) continue;
        for (uint32_t k = 0; k < count; ++k) {
            if (isCube(l)) {
                LightMap map{describe(light, i, faceMatrix(l.worldToShadow, int(k), l), first, first.width,
                                      first.width, origin, coarsest),
                             first};
                map.constants.firstRow = k * first.width;
                all.push_back(map);
                continue;
            }
            const ShadowCascade cascade = shadowCascade(light, k);
            if (!*cascade.map) continue;
            Matrix m;
            std::copy_n(*cascade.worldToShadow, 16, m.begin());
            LightMap map{describe(light, i, m, *cascade.map, cascade.map->width, cascade.map->height, origin,
                                  coarsest),
                         *cascade.map};
            map.constants.finer = k;
            all.push_back(map);
        }
    }
    return all;
}

}  // namespace pel
