#include "sample/lit_mesh.h"

#include <algorithm>
#include <locale>
#include <sstream>

namespace pellucid::sample {
namespace {

constexpr double liftPart = 3e-6;  // of the scene's extent: more than float leaves of a place

struct Place {
    Vec3 origin, normal;
};

Place placeOf(const Mesh& mesh, const SurfacePoint& point, double lift) {
    const auto corners = mesh.corners(point.triangle);
    Vec3 p, normal, lifted;
    for (int k = 0; k < 3; ++k) p = p + corners[k] * point.weights[k];
    const Vec3 flat = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
    if (mesh.normals.empty()) return {p + flat * lift, flat};
    const auto normals = mesh.atCorners(mesh.normals, point.triangle);
    for (int k = 0; k < 3; ++k) {
        const Vec3 n = normals[k];
        normal = normal + n * point.weights[k];
        // Onto the plane across the corner's normal, where p lies below it.
        lifted = lifted + (p - n * std::min(0.0, dot(p - corners[k], n))) * point.weights[k];
    }
    normal = normalize(normal, flat);
    return {lifted + normal * lift, normal};
}

struct Sample {
    Vec3 direction;
    double distance = INFINITY, strength = 0;  // strength: cosine included
};

Sample sampleLight(const SurfaceLight& light, const Place& place) {
    Sample s;
    if (light.type == SurfaceLight::Type::Directional) {
        s.direction = light.toLight;
        s.strength = 1;
    } else {
        const Vec3 delta = light.position - place.origin;
        s.distance = length(delta);
        s.direction = normalize(delta);
        if (light.range > 0 && s.distance > light.range) return s;
        s.strength = 1 / std::max(s.distance * s.distance, 1e-12);
        if (light.type == SurfaceLight::Type::SpotLight) {
            const double t = std::clamp((-dot(s.direction, light.spotDirection) - light.spotCosOuter) /
                                            (light.spotCosInner - light.spotCosOuter),
                                        0.0, 1.0);
            s.strength *= t * t * (3 - 2 * t);
        }
    }
    s.strength *= std::max(0.0, dot(place.normal, s.direction));
    return s;
}

// A part of a triangle of the mesh.
struct Piece {
    uint32_t triangle;
    std::array<std::array<double, 3>, 3> weights;  // of its corners
    std::array<std::array<float, 3>, 3> light;
};

std::array<double, 3> middle(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

[[noreturn]] void tooMany(const LitMeshOptions& options, double triangles) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "the lit mesh would have " << triangles << " triangles or more, with edges of at most "
         << options.coarsest << "; " << options.mostTriangles
         << " are the most. Is the unit of lengths right, or the profile too narrow for the mesh?";
    throw std::length_error(text.str());
}

class Refiner {
  public:
    Refiner(const Scene& scene, const Lighting& lighting, const LitMeshOptions& options)
        : scene_(scene), lighting_(lighting), options_(options) {}

    // Before any work: triangles whose edges are at most `coarsest` long have an area of at most an
    // equilateral one's.
    void refuseTooMany() const {
        const double mostArea = std::sqrt(3.0) / 4 * options_.coarsest * options_.coarsest;
        double least = 0;
        for (uint32_t t = 0; t < scene_.mesh().triangles.size() / 3; ++t) {
            if (!takes(t)) continue;
            const auto [a, b, c] = scene_.mesh().corners(t);
            least += std::max(1.0, length(cross(b - a, c - a)) / 2 / mostArea);
        }
        if (least > double(options_.mostTriangles)) tooMany(options_, least);
    }
    // `poll`: called again and again, and may throw.
    void take(uint32_t first, uint32_t end, const std::function<void()>& poll) {
        std::vector<Piece> pieces;
        for (uint32_t t = first; t < end; ++t)
            if (takes(t)) pieces.push_back({t, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}});
        lightPoints(
            pieces, [](const Piece& p, int k) { return p.weights[k]; },
            [](Piece & p, int k) -> auto& { return p.light[k]; });
        // The last ones first, so that pieces of pieces take bounded memory.
        constexpr size_t atOnce = size_t{1} << 20;
        while (!pieces.empty()) {
            poll();
            const auto from = pieces.end() - std::ptrdiff_t(std::min(pieces.size(), atOnce));
            std::vector<Halves> halves;
            for (auto p = from; p != pieces.end(); ++p) halves.push_back({*p, {}});
            pieces.erase(from, pieces.end());
            lightPoints(
                halves,
                [](const Halves& h, int k) {
                    return middle(h.piece.weights[k], h.piece.weights[(k + 1) % 3]);
                },
                [](Halves & h, int k) -> auto& { return h.light[k]; });
            for (const Halves& h : halves) split(h, pieces);
            if (pieces.size() + result.triangles.size() / 3 > options_.mostTriangles)
                tooMany(options_, double(pieces.size() + result.triangles.size() / 3));
        }
    }
    LitMesh result;
    float brightest = 0;

  private:
    struct Halves {
        Piece piece;
        std::array<std::array<float, 3>, 3> light;  // in the middle of each side
    };
    bool takes(uint32_t t) const {
        const std::vector<uint32_t>& of = scene_.mesh().materials;
        return options_.material == 0 || options_.material == (of.empty() ? 1 : of[t]);
    }

    template <class Item, class Where, class Light>
    void lightPoints(std::vector<Item>& items, const Where& where, const Light& light) {
        std::vector<SurfacePoint> points;
        for (const Item& item : items)
            for (int k = 0; k < 3; ++k) points.push_back({pieceOf(item).triangle, where(item, k)});
        const std::vector<float> values = irradianceAt(scene_, lighting_, points);
        for (size_t i = 0; i < values.size(); ++i) {
            light(items[i / 9], int(i / 3 % 3))[i % 3] = values[i];
            brightest = std::max(brightest, values[i]);
        }
    }
    static const Piece& pieceOf(const Piece& p) { return p; }
    static const Piece& pieceOf(const Halves& h) { return h.piece; }

    void split(const Halves& h, std::vector<Piece>& pieces) {
        const Piece& p = h.piece;
        double longest = 0, deviation = 0;
        const auto whole = scene_.mesh().corners(p.triangle);
        Vec3 corners[3];
        for (int k = 0; k < 3; ++k)
            for (int i = 0; i < 3; ++i) corners[k] = corners[k] + whole[i] * p.weights[k][i];
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3;
            longest = std::max(longest, length(corners[next] - corners[k]));
            for (int c = 0; c < 3; ++c)
                deviation = std::max(
                    deviation, std::abs(double(h.light[k][c]) - (p.light[k][c] + p.light[next][c]) / 2));
        }
        if (longest <= options_.coarsest &&
            (longest <= options_.finest || deviation <= options_.deviation * brightest)) {
            for (int k = 0; k < 3; ++k) {
                result.triangles.push_back(uint32_t(result.triangles.size()));
                for (double x : {corners[k].x, corners[k].y, corners[k].z})
                    result.positions.push_back(float(x));
                result.irradiance.insert(result.irradiance.end(), p.light[k].begin(), p.light[k].end());
            }
            return;
        }
        std::array<std::array<double, 3>, 3> m;
        for (int k = 0; k < 3; ++k) m[k] = middle(p.weights[k], p.weights[(k + 1) % 3]);
        const auto& E = h.light;
        pieces.push_back({p.triangle, {p.weights[0], m[0], m[2]}, {p.light[0], E[0], E[2]}});
        pieces.push_back({p.triangle, {m[0], p.weights[1], m[1]}, {E[0], p.light[1], E[1]}});
        pieces.push_back({p.triangle, {m[2], m[1], p.weights[2]}, {E[2], E[1], p.light[2]}});
        pieces.push_back({p.triangle, {m[0], m[1], m[2]}, {E[0], E[1], E[2]}});
    }

    const Scene& scene_;
    const Lighting& lighting_;
    const LitMeshOptions& options_;
};

}  // namespace

Surface surfaceAt(const Mesh& mesh, const SurfacePoint& point) {
    const auto [a, b, c] = mesh.corners(point.triangle);
    return {a * point.weights[0] + b * point.weights[1] + c * point.weights[2],
            normalize(cross(b - a, c - a))};
}

std::vector<SurfacePoint> nearestPoints(const Scene& scene, std::span<const float> positions,
                                        std::vector<double>& distances) {
    std::vector<SurfacePoint> places(positions.size() / 3);
    distances.resize(places.size());
#pragma omp parallel for schedule(dynamic, 1024)
    for (size_t i = 0; i < places.size(); ++i) {
        const Hit hit = scene.nearest({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
        distances[i] = hit.distance;
        places[i] = {hit.triangle, hit.weights};
    }
    return places;
}

std::array<double, 3> irradianceAt(const Scene& scene, const Lighting& lighting, const SurfacePoint& point) {
    const Vec3 extent = scene.bounds().high - scene.bounds().low;
    const Place place = placeOf(scene.mesh(), point, liftPart * std::max({extent.x, extent.y, extent.z}));
    std::array<double, 3> sum{};
    if (lighting.ambient) sum = lighting.ambient(place.normal);
    for (const SurfaceLight& light : lighting.lights) {
        const Sample sample = sampleLight(light, place);
        if (!(sample.strength > 0) || scene.occluded({place.origin, sample.direction}, sample.distance))
            continue;
        for (int c = 0; c < 3; ++c) sum[c] += sample.strength * light.color[c];
    }
    return sum;
}

std::vector<float> irradianceAt(const Scene& scene, const Lighting& lighting,
                                std::span<const SurfacePoint> points) {
    std::vector<float> result(3 * points.size());
#pragma omp parallel for schedule(dynamic, 1024)
    for (size_t i = 0; i < points.size(); ++i)
        std::ranges::copy(irradianceAt(scene, lighting, points[i]), &result[3 * i]);
    return result;
}

LitMesh lightMesh(const Scene& scene, const Lighting& lighting, const LitMeshOptions& options,
                  const std::function<void(double)>& progress) {
    Refiner refiner(scene, lighting, options);
    refiner.refuseTooMany();
    // The largest irradiance is known before, so that the order of triangles does not matter.
    std::vector<SurfacePoint> corners;
    const auto count = uint32_t(scene.mesh().triangles.size() / 3);
    for (uint32_t t = 0; t < count; ++t) corners.push_back({t, {1 / 3., 1 / 3., 1 / 3.}});
    for (float E : irradianceAt(scene, lighting, corners)) refiner.brightest = std::max(refiner.brightest, E);
    constexpr uint32_t batch = 16384;
    for (uint32_t first = 0; first < count; first += batch) {
        refiner.take(first, std::min(count, first + batch), [&] {
            if (progress) progress(double(first) / count);
        });
    }
    return std::move(refiner.result);
}

std::vector<float> scatteredAt(const Device& device, const LitMesh& lit, const std::vector<float>& points,
                               PelSurfaceIntegralDesc desc) {
    const auto count = uint32_t(points.size() / 3);
    if (count == 0) return {};
    const Buffer in(device, points), out(device, points.size() * sizeof(float));
    desc.numVertices = uint32_t(lit.positions.size() / 3);
    desc.positions = lit.positions.data();
    desc.indices = lit.triangles.data();
    desc.numIndices = lit.triangles.size();
    desc.irradiance = lit.irradiance.data();
    desc.points = vertexView(in, count);
    desc.result = vertexView(out, count);
    surfaceIntegral(device, desc);
    return out.readAll<float>();
}

}  // namespace pellucid::sample
