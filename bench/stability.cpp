// Writes docs/stability.md: for each operation the range of inputs tried and the worst error that a directed
// search found against the double-precision oracle. Run: build/release/bin/stability docs/stability.md
// [seconds per operation]. Simple (1+1) evolution with restarts: a point of the unit cube stands for the
// inputs; steps grow on success and shrink on failure [Rechenberg 1973].
#include <chrono>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "reference/lut.h"
#include "reference/surfaces.h"
#include "shade_scene.h"

using namespace pellucid;

namespace {

using Point = std::vector<double>;  // of the unit cube

struct Operation {
    std::string name, range, unit;
    size_t dimensions;
    std::function<double(const Point&, std::string& where)> error;
};

struct Found {
    double random = 0, worst = 0;  // after the first tenth of the evaluations, drawn blindly; after all
    int evaluations = 0;
    std::string where;
};

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Found search(const Operation& operation, double budget) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    Found found;
    const double start = seconds();
    Point at(operation.dimensions), best;
    double bestError = -1, step = 0.2;
    const auto evaluate = [&](const Point& p) {
        std::string where;
        const double e = operation.error(p, where);
        ++found.evaluations;
        // A NaN is the worst of all.
        if (!(e <= found.worst)) found.worst = e, found.where = where;
        return e;
    };
    while (seconds() - start < 0.3 * budget || found.evaluations < 4) {
        for (double& x : at) x = uniform(random);
        const double e = evaluate(at);
        if (!(e <= bestError)) bestError = e, best = at;
    }
    found.random = found.worst;
    while (seconds() - start < budget) {
        at = best;
        for (double& x : at) x = std::clamp(x + step * normal(random), 0.0, 1.0);
        const double e = evaluate(at);
        if (!(e <= bestError))
            bestError = e, best = at, step = std::min(0.5, 1.5 * step);
        else
            step = std::max(1e-4, 0.9 * step);
    }
    return found;
}

double logBetween(double t, double low, double high) {
    return low * std::pow(high / low, t);
}

std::string text(const char* format, double a, double b = 0, double c = 0, double d = 0) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, format, a, b, c, d);
    return buffer;
}

const Device& device() {
    return shade_test::device();
}

Operation curvatureTable(const char* name, PelCurvatureForm form, reference::Form other) {
    return {name, "radii 0.01 to 10,000 mm, ratio of the two 1.1 to 10,000; diffusion radius 0.1 to 100 mm",
            "absolute", 3, [=](const Point& p, std::string& where) {
                PelCurvatureLutDesc desc = pelCurvatureLutDescDefaults();
                desc.form = form;
                desc.width = 15, desc.height = 6;
                desc.radiusMin = float(logBetween(p[0], 0.01, 1000));
                desc.radiusMax = std::min(1e4f, float(desc.radiusMin * logBetween(p[1], 1.1, 1e4)));
                if (desc.radiusMax < 1.1f * desc.radiusMin) desc.radiusMax = 1.1f * desc.radiusMin;
                desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
                const std::vector<float> texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
                reference::CurvatureLutSpec spec{other, 15, 6, desc.radiusMin, desc.radiusMax};
                const auto skin = reference::profileForRadius(reference::skinProfile(), desc.diffusionRadius);
                double worst = 0;
                for (int i = 0; i < 90; ++i) {
                    const reference::Rgb truth = reference::curvatureTexel(spec, *skin, i % 15, i / 15);
                    for (int c = 0; c < 3; ++c) {
                        const double e = std::abs(texels[size_t(3 * i + c)] - truth[c]);
                        if (!(e <= worst)) worst = e;
                    }
                }
                where = text("radii %.3g to %.3g mm, diffusion radius %.3g mm", desc.radiusMin,
                             desc.radiusMax, desc.diffusionRadius);
                return worst;
            }};
}

Operation shadowTable() {
    return {"shadow table", "widths 0.1 to 10,000 mm; diffusion radius 0.1 to 100 mm; sharpening 1 to 100",
            "absolute", 4, [](const Point& p, std::string& where) {
                PelShadowLutDesc desc = pelShadowLutDescDefaults();
                desc.width = 31, desc.height = 6;
                desc.widthMin = float(logBetween(p[0], 0.1, 1000));
                desc.widthMax = float(desc.widthMin * logBetween(p[1], 1.1, 10));
                desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
                desc.sharpening = float(logBetween(p[3], 1, 100));
                const std::vector<float> texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
                const reference::ShadowLutSpec spec{
                    31, 6, desc.widthMin, desc.widthMax, desc.diffusionRadius, desc.sharpening};
                const auto skin = reference::skinProfile();
                double worst = 0;
                for (int i = 0; i < 186; ++i) {
                    const reference::Rgb truth = reference::shadowTexel(spec, *skin, i % 31, i / 31);
                    for (int c = 0; c < 3; ++c) {
                        const double e = std::abs(texels[size_t(3 * i + c)] - truth[c]);
                        if (!(e <= worst)) worst = e;
                    }
                }
                where = text("widths %.3g to %.3g mm, diffusion radius %.3g mm, sharpening %.3g",
                             desc.widthMin, desc.widthMax, desc.diffusionRadius, desc.sharpening);
                return worst;
            }};
}

// A torus stretched, scaled and moved away from the origin: float positions lose what the distance takes.
struct MovedMesh {
    reference::Mesh mesh;
    std::vector<float> positions, normals;
    MeshTopology topology;
    std::string where;

    explicit MovedMesh(const Point& p) {
        const double scale = logBetween(p[0], 1e-6, 1e6), away = p[1] < 0.1 ? 0 : logBetween(p[1], 1e-3, 1e3),
                     flat = logBetween(p[2], 0.02, 1);
        mesh = reference::tessellate(reference::torusSurface(3, 1), 24, 14,
                                     reference::Tessellation::irregular, uint32_t(1 + p[3] * 8))
                   .mesh;
        for (auto& v : mesh.positions) v = {scale * (v.x + 4 * away), scale * v.y, scale * flat * v.z};
        for (auto& v : mesh.positions)
            for (int i = 0; i < 3; ++i) positions.push_back(float(v[i])), v[i] = positions.back();
        mesh.normals = reference::estimatedNormals(mesh);
        for (auto& n : mesh.normals)
            for (int i = 0; i < 3; ++i) normals.push_back(float(n[i])), n[i] = normals.back();
        std::vector<uint32_t> indices;
        for (const auto& t : mesh.triangles)
            indices.insert(indices.end(), {uint32_t(t[0]), uint32_t(t[1]), uint32_t(t[2])});
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = uint32_t(mesh.positions.size());
        desc.indices = indices.data();
        desc.numIndices = indices.size();
        topology = MeshTopology(device(), desc);
        where = text("size %.2g, distance from the origin %.2g sizes, flattened to %.2g", 8 * scale, away / 2,
                     flat);
    }
    uint32_t count() const { return uint32_t(mesh.positions.size()); }
};

double relative(const std::vector<float>& values, const std::vector<double>& truth) {
    double difference = 0, largest = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const double e = std::abs(values[i] - truth[i]);
        if (!(e <= difference)) difference = e;
        largest = std::max(largest, std::abs(truth[i]));
    }
    return difference / largest;
}

constexpr const char* meshRange =
    "size 1e-5 to 1e7 units, up to 500 sizes away from the origin, flattened down to 0.02";

Operation meshCurvature(const char* name, PelCurvatureEstimator estimator) {
    return {name, meshRange, "of the largest", 4, [=](const Point& p, std::string& where) {
                const MovedMesh m(p);
                where = m.where;
                PelCurvatureParams params = pelCurvatureParamsDefaults();
                params.estimator = estimator;
                params.smoothingPasses = 0;
                const Buffer positions(device(), m.positions), normals(device(), m.normals),
                    out(device(), m.count() * 4);
                m.topology.curvature(params, vertexView(positions, m.count()), vertexView(normals, m.count()),
                                     vertexView(out, m.count()));
                std::vector<double> truth;
                if (estimator == PEL_CURVATURE_EDGE)
                    truth = reference::edgeCurvature(m.mesh);
                else
                    for (const auto& k : reference::tensorCurvature(m.mesh))
                        truth.push_back(std::abs(k.mean()));
                return relative(out.readAll<float>(), truth);
            }};
}

Operation meshNormals() {
    return {"normals", meshRange, "absolute", 4, [](const Point& p, std::string& where) {
                const MovedMesh m(p);
                where = m.where;
                const Buffer positions(device(), m.positions), out(device(), m.count() * 12);
                m.topology.normals(vertexView(positions, m.count()), vertexView(out, m.count()));
                std::vector<double> truth;
                for (const auto& n : reference::estimatedNormals(m.mesh))
                    truth.insert(truth.end(), {n.x, n.y, n.z});
                return relative(out.readAll<float>(), truth);
            }};
}

// A frame of pixels that all lie in one neighbourhood of the inputs; the search moves and narrows it.
Operation shading(const char* name, bool specularOnly) {
    return {name,
            "albedo, curvature -0.1 to 1.2 /mm, wide shadow, normals up to 25 degrees apart, roughness 0.05 "
            "to 0.45, N.L and V.H at all "
            "angles; three kinds of light; all terms",
            "absolute, relative above 1", 6, [=](const Point& p, std::string& where) {
                shade_test::Frame f = shade_test::randomFrame(uint32_t(1 + p[0] * 40), 61, 31, 3);
                for (auto& [id, m] : f.materials) {
                    m.roughness = float(logBetween(p[1], 0.05, 0.3));
                    m.specular = specularOnly ? 1.0f : float(p[2]);
                    m.deepScatterRadius = float(logBetween(p[3], 1, 40));
                    m.diffusionRadius = float(logBetween(p[4], 0.5, 20));
                    m.thicknessTaps = 32;
                }
                for (float& v : f.slots[PEL_SLOT_CURVATURE].values) v = float(p[5]) + 0.1f * v;
                const std::vector<float> out = shade_test::shade(device(), f, shade_test::tables());
                where = text(
                    "roughness %.3g, specular %.3g, deep scatter radius %.3g mm, diffusion radius %.3g mm",
                    f.materials[1].roughness, f.materials[1].specular, f.materials[1].deepScatterRadius,
                    f.materials[1].diffusionRadius);
                // Relative to the brightest radiance where that is above 1: a sharp lobe reaches hundreds.
                double worst = 0;
                for (size_t i = 0; i < f.pixels(); ++i) {
                    const reference::Rgb sum = shade_test::truth(f, shade_test::tables(), i).sum();
                    for (int c = 0; c < 3; ++c) {
                        const double e = std::abs(sum[c] - out[3 * i + size_t(c)]) / std::max(1.0, sum[c]);
                        if (!(e <= worst)) worst = e;
                    }
                }
                return worst;
            }};
}

constexpr const char* before = R"(# Numerical stability

Written by `bench/stability.cpp` (`build/release/bin/stability docs/stability.md`). The worst error that a directed search found against the
double-precision oracle of the tests: points of the range are drawn blindly for three tenths of the time, then the worst one is
moved about by an evolution strategy as long as the time lasts.

)";
constexpr const char* after = R"(
"Drawn" is the worst of the blind part: where the search gains much over it, random tests would have missed the place.

## What float32 allows

- **Meshes.** Edges are differences of positions. A mesh that lies D sizes away from the origin has positions with D times the rounding
  error, 6e-8 D of its size, and edges of 1/n of its size have lost n D of their digits before Pellucid sees them; the oracle above
  gets the same rounded positions, so that the figures are the library's own error, not that loss. Scale by itself costs nothing
  between 1e-6 and 1e6.
- **Tables.** A texel is a sum of at most a few hundred terms of one sign each; errors stay within some units in the last place of 1, thirty for rings.
  What limits a look-up is the table's resolution, not its values.
- **Shading.** Sums of a few terms of order one: 1e-6. Sharp speculars multiply the error of the half vector by 1/m^2, so that relative
  error grows as roughness falls; thickness subtracts two depths, and inherits the shadow map's own steps.

## NaN and Inf

| operation | input | result |
|---|---|---|
| curvature, normals | position NaN or Inf | 0 at that vertex; edges and triangles to it are skipped, neighbours use what is left; counted in the report |
| curvature | normal NaN, Inf or zero | likewise |
| curvature, normals | zero-length edges, repeated indices, unreferenced vertices | skipped, 0 where nothing is left; counted |
| UV scale | triangles too small to measure | skipped; an error when none is left |
| tables, profiles | NaN, Inf or out of range in a description | refused with PEL_ERROR_INVALID_ARGUMENT, which names the field |
| shading | NaN or Inf in any image of a pixel | that pixel is `invalidColor` (0 by default) and counted; no neighbour changes |
| shading | shadow map texel NaN | no thickness from that tap |
| shading | NaN or Inf in a light, material, matrix or camera | refused, with the name of the field |
)";

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: stability OUT.md [SECONDS]\n"), 2;
    const double budget = argc > 2 ? std::atof(argv[2]) : 20;
    const Operation operations[] = {
        curvatureTable("curvature table, arc", PEL_FORM_ARC, reference::Form::arc),
        curvatureTable("curvature table, ring", PEL_FORM_RING, reference::Form::ring),
        curvatureTable("curvature table, half-ring", PEL_FORM_HALF_RING, reference::Form::halfRing),
        curvatureTable("curvature table, sphere", PEL_FORM_SPHERE, reference::Form::sphere),
        shadowTable(),
        meshCurvature("curvature, edge", PEL_CURVATURE_EDGE),
        meshCurvature("curvature, tensor", PEL_CURVATURE_TENSOR),
        meshNormals(),
        shading("shading", false),
        shading("shading, full specular", true)};
    const PelDeviceInfo info = device().info();
    std::string out = before;
    out += std::string("Device: ") + info.name + ", " + info.platform + " " + info.driver + "; " +
           text("%.0f", budget) +
           " seconds an operation.\n\n| operation | inputs tried | evaluations | drawn | found | error is | "
           "where |\n|---|---|---|---|---|---|---|\n";
    for (const Operation& operation : operations) {
        const Found found = search(operation, budget);
        std::fprintf(stderr, "%s: %.2g, drawn %.2g, %d evaluations\n", operation.name.c_str(), found.worst,
                     found.random, found.evaluations);
        out += "| " + operation.name + " | " + operation.range + " | " + std::to_string(found.evaluations) +
               " | " + text("%.1e", found.random) + " | " + text("%.1e", found.worst) + " | " +
               operation.unit + " | " + found.where + " |\n";
    }
    out += after;
    FILE* file = std::fopen(argv[1], "w");
    if (!file || std::fputs(out.c_str(), file) < 0 || std::fclose(file) != 0) return std::perror(argv[1]), 1;
}
