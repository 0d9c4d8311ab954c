// pelSurfaceIntegral against brute force, against the closed form on a sphere, and with input that no mesh
// should hold.
#include "diffusion/scatter_scene.h"
#include "reference/surface_integral.h"
#include "sample/mesh.h"
#include "test.h"

namespace {

using namespace pellucid;
using reference::LitTriangle;
using scatter_scene::infinity;
using scatter_scene::notANumber;
using scatter_scene::Vec3;

struct LitMesh {
    std::vector<float> positions, irradiance;
    std::vector<uint32_t> indices;
    PelIrradianceAt at = PEL_IRRADIANCE_VERTEX;

    PelSurfaceIntegralDesc desc(float unit = 1) const {
        PelSurfaceIntegralDesc d = pelSurfaceIntegralDescDefaults();
        d.millimetresPerUnit = unit;
        d.numVertices = uint32_t(positions.size() / 3);
        d.positions = positions.data();
        d.indices = indices.data();
        d.numIndices = indices.size();
        d.irradiance = irradiance.data();
        d.irradianceAt = at;
        return d;
    }
    std::vector<LitTriangle> triangles() const {
        const auto three = [](const std::vector<float>& v, size_t i) {
            return Vec3{v[3 * i], v[3 * i + 1], v[3 * i + 2]};
        };
        std::vector<LitTriangle> all;
        for (size_t i = 0; i < indices.size() / 3; ++i) {
            LitTriangle t;
            for (int k = 0; k < 3; ++k) {
                const size_t vertex = indices[3 * i + k];
                t.corner[k] = three(positions, vertex);
                t.irradiance[k] = three(irradiance, at == PEL_IRRADIANCE_VERTEX     ? vertex
                                                    : at == PEL_IRRADIANCE_TRIANGLE ? i
                                                                                    : 3 * i + k);
            }
            all.push_back(t);
        }
        return all;
    }
};

std::vector<float> integrate(PelSurfaceIntegralDesc desc, const std::vector<float>& points) {
    const Buffer in(device(), points), out(device(), std::vector<float>(points.size(), -1.0f));
    desc.points = vertexView(in, uint32_t(points.size() / 3));
    desc.result = vertexView(out, uint32_t(points.size() / 3));
    surfaceIntegral(device(), desc);
    return out.readAll<float>();
}

// A crumpled sheet: `cells` squares a side of `size` long, uneven in height, with light of three colours.
LitMesh sheet(int cells, float size, PelIrradianceAt at = PEL_IRRADIANCE_VERTEX) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    LitMesh mesh;
    mesh.at = at;
    for (int y = 0; y <= cells; ++y)
        for (int x = 0; x <= cells; ++x)
            for (float v : {(x + 0.4f * unit(random)) * size, (y + 0.4f * unit(random)) * size,
                            0.5f * size * unit(random)})
                mesh.positions.push_back(v);
    const auto vertex = [&](int x, int y) { return uint32_t(y * (cells + 1) + x); };
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x)
            for (uint32_t v : {vertex(x, y), vertex(x + 1, y), vertex(x, y + 1), vertex(x, y + 1),
                               vertex(x + 1, y), vertex(x + 1, y + 1)})
                mesh.indices.push_back(v);
    const size_t lights = at == PEL_IRRADIANCE_VERTEX
                              ? mesh.positions.size() / 3
                              : mesh.indices.size() / (at == PEL_IRRADIANCE_TRIANGLE ? 3 : 1);
    for (size_t i = 0; i < 3 * lights; ++i) mesh.irradiance.push_back(unit(random) < 0.2f ? 0 : unit(random));
    return mesh;
}

// Inside of triangles, at corners, on edges.
std::vector<float> pointsOn(const LitMesh& mesh, int count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<float> points;
    for (int i = 0; i < count; ++i) {
        const size_t triangle = random() % (mesh.indices.size() / 3);
        float b = unit(random), c = unit(random) * (1 - b);
        if (i % 5 == 0) b = c = 0;
        if (i % 5 == 1) c = 0;
        for (int k = 0; k < 3; ++k) {
            const auto corner = [&](int j) {
                return mesh.positions[3 * size_t(mesh.indices[3 * triangle + j]) + k];
            };
            points.push_back(corner(0) * (1 - b - c) + corner(1) * b + corner(2) * c);
        }
    }
    return points;
}

void expectBruteForce(const PelSurfaceIntegralDesc& desc, const LitMesh& mesh,
                      const std::vector<float>& points, const reference::Profile& profile, reference::Rgb cut,
                      double within, const char* what) {
    const std::vector<float> found = integrate(desc, points);
    const std::vector<LitTriangle> triangles = mesh.triangles();
    for (size_t i = 0; i < points.size() / 3; ++i) {
        const reference::Rgb truth = reference::surfaceIntegral(
            profile, triangles, {points[3 * i], points[3 * i + 1], points[3 * i + 2]}, cut);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found[3 * i + c], truth[c], within) << what << ", point " << i << ", channel " << c;
    }
}

const float path[3] = {1.2f, 0.5f, 0.2f}, albedo[3] = {0.8f, 0.7f, 0.6f};

}  // namespace

TEST(SurfaceIntegral, EqualsBruteForceForEveryProfile) {
    const std::vector<float> distances{0, 0.5f, 1, 2}, values{1, 2, 0, .5f, 1, 1, .25f, .5f, .5f, 0, 0, .25f};
    const float absorption[3] = {0.05f, 0.1f, 0.2f}, scattering[3] = {1.5f, 2, 3};
    const struct {
        const char* name;
        Profile profile;
        reference::ProfilePtr truth;
        double within;
    } cases[] = {
        {"skin", Profile::skin(), reference::skinProfile(), tolerance::surfaceNear},
        {"burley", Profile::burley(path, albedo),
         reference::burleyProfile({path[0], path[1], path[2]}, {albedo[0], albedo[1], albedo[2]}),
         tolerance::surfaceNear},
        {"dipole", Profile::dipole(absorption, scattering, 1.3f),
         reference::dipoleProfile({absorption[0], absorption[1], absorption[2]}, {1.5, 2, 3}, 1.3f),
         tolerance::surfaceNear},
        {"table", Profile::table(distances, values),
         reference::tableProfile({0, 0.5, 1, 2}, {{1, 2, 0}, {.5, 1, 1}, {.25, .5, .5}, {0, 0, .25}}),
         tolerance::surfaceStep},
    };
    const LitMesh mesh = sheet(6, 1.3f);
    const std::vector<float> points = pointsOn(mesh, sized(8, 3));
    for (const auto& c : cases) {
        PelSurfaceIntegralDesc desc = mesh.desc();
        desc.profile = c.profile.get();
        desc.tolerance = 1e-7f;
        expectBruteForce(desc, mesh, points, *c.truth, {}, c.within, c.name);
        desc.tolerance = 1e-4f;
        expectBruteForce(desc, mesh, points, *c.truth, {}, tolerance::surfaceFar + c.within, c.name);
    }
}

TEST(SurfaceIntegral, UnitRadiusCutAndPlaceOfTheLight) {
    const Profile burley = Profile::burley(path, albedo);
    const auto truth =
        reference::burleyProfile({path[0], path[1], path[2]}, {albedo[0], albedo[1], albedo[2]});
    for (PelIrradianceAt at : {PEL_IRRADIANCE_VERTEX, PEL_IRRADIANCE_TRIANGLE, PEL_IRRADIANCE_CORNER}) {
        const LitMesh mesh = sheet(4, 0.2f, at);
        const std::vector<float> points = pointsOn(mesh, sized(4, 2));
        PelSurfaceIntegralDesc desc = mesh.desc();
        desc.profile = burley.get();
        desc.millimetresPerUnit = 10;
        desc.diffusionRadius = 2 * burley.info().radius;
        const float cut[3] = {2.5f, 1.2f, 0};
        std::copy(cut, cut + 3, desc.cut);
        expectBruteForce(desc, mesh, points, *reference::profileForRadius(truth, 0.2 * truth->radius()),
                         {0.25f, 0.12f, 0}, tolerance::surfaceFar + tolerance::surfaceNear, "cut");
    }
}

TEST(SurfaceIntegral, SphereHasTheClosedForm) {
    const int rings = sized(320, 16);
    const double radius = 10;
    const sample::Mesh sphere = sample::makeSphere(radius, rings, 2 * rings);
    LitMesh mesh{sphere.positions, {}, sphere.triangles};
    for (size_t i = 2; i < mesh.positions.size(); i += 3)
        mesh.irradiance.insert(mesh.irradiance.end(), 3, std::max(0.0f, mesh.positions[i] / float(radius)));
    std::vector<float> points;
    std::vector<double> angles;
    for (int i = 0; i <= rings; i += rings / 16) {
        const float* p = &mesh.positions[size_t(i) * 3 * size_t(2 * rings + 1)];
        points.insert(points.end(), p, p + 3);
        angles.push_back(std::numbers::pi * i / rings);
    }
    for (float scale : {1.0f, 4.0f}) {
        const float lengths[3] = {0.29205f * scale, 0.10902f * scale, 0.05411f * scale}, one[3] = {1, 1, 1};
        const Profile profile = Profile::burley(lengths, one, PEL_BURLEY_SEARCHLIGHT);
        const auto truth = reference::burleyProfile({lengths[0], lengths[1], lengths[2]}, {1, 1, 1},
                                                    reference::BurleyFit::searchlight);
        PelSurfaceIntegralDesc desc = mesh.desc();
        desc.profile = profile.get();
        const std::vector<float> found = integrate(desc, points);
        for (size_t i = 0; i < angles.size(); ++i) {
            const reference::Rgb S = reference::overSphere(*truth, angles[i], radius, {1, 1, 1});
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(found[3 * i + c], S[c], testsAreSmall() ? 0.1 : tolerance::surfaceSphere)
                    << "scale " << scale << ", angle " << angles[i] << ", channel " << c;
        }
    }
}

// The error bound holds where the mesh is much finer than the profile is wide, and every far set counts as a
// point.
TEST(SurfaceIntegral, HierarchyKeepsItsBound) {
    for (float unit : {1.0f, 20.0f, 0.05f}) {
        const LitMesh mesh = sheet(sized(50, 8), 0.25f / unit);
        const std::vector<float> points = pointsOn(mesh, 200);
        PelSurfaceIntegralDesc desc = mesh.desc(unit);
        desc.tolerance = 1e-7f;
        const std::vector<float> exact = integrate(desc, points);
        double worst = 0;
        for (float tolerance : {1e-3f, 1e-2f, 1e-1f}) {
            desc.tolerance = tolerance;
            const std::vector<float> found = integrate(desc, points);
            for (size_t i = 0; i < found.size(); ++i)
                worst = std::max(worst, double(std::abs(found[i] - exact[i])));
            EXPECT_LE(worst, tolerance) << "unit " << unit;
        }
        // Errors mostly cancel, far below the bound; but the hierarchy must have approximated something.
        EXPECT_GT(worst, 0) << "unit " << unit;
    }
}

TEST(SurfaceIntegral, NothingLitNoPointsAndPointsThatAreNoNumbers) {
    LitMesh mesh = sheet(3, 1);
    const PelSurfaceIntegralDesc pointless = mesh.desc();
    EXPECT_EQ(pelSurfaceIntegral(device().get(), &pointless, nullptr), PEL_SUCCESS);
    const std::vector<float> found = integrate(mesh.desc(), {notANumber, 0, 0, 1, 1, 0, 0, infinity, 0});
    for (int i : {0, 1, 2, 6, 7, 8}) EXPECT_EQ(found[i], 0) << i;
    EXPECT_GT(found[3], 0);
    std::fill(mesh.irradiance.begin(), mesh.irradiance.end(), 0.0f);
    EXPECT_EQ(integrate(mesh.desc(), {1, 1, 0}), std::vector<float>(3, 0.0f));
    EXPECT_EQ(integrate(pelSurfaceIntegralDescDefaults(), {1, 1, 0}), std::vector<float>(3, 0.0f));
    // Triangles without an area add nothing.
    mesh = sheet(3, 1);
    const std::vector<float> before = integrate(mesh.desc(), {1, 1, 0.1f});
    mesh.indices.insert(mesh.indices.end(), {0, 0, 1, 2, 2, 2});
    EXPECT_EQ(integrate(mesh.desc(), {1, 1, 0.1f}), before);
}

TEST(SurfaceIntegral, BadInputIsRefusedByName) {
    const auto refused = [](const char* message, const auto& corrupt) {
        LitMesh mesh = sheet(2, 1);
        PelSurfaceIntegralDesc desc = mesh.desc();
        corrupt(mesh, desc);
        expectRefused(message, [&] { integrate(desc, {0, 0, 0}); });
    };
    constexpr float nan = notANumber;
    refused("triangle 1 has vertex 9; the mesh has 9", [](LitMesh& m, auto&) { m.indices[4] = 9; });
    refused("position of vertex 4", [&](LitMesh& m, auto&) { m.positions[13] = nan; });
    refused("irradiance 2 holds -1", [](LitMesh& m, auto&) { m.irradiance[6] = -1; });
    refused("irradiance 0 holds", [&](LitMesh& m, auto&) { m.irradiance[0] = nan; });
    refused("numIndices is 23", [](LitMesh&, auto& d) { d.numIndices = 23; });
    refused("indices is NULL", [](LitMesh&, auto& d) { d.indices = nullptr; });
    refused("positions is NULL", [](LitMesh&, auto& d) { d.positions = nullptr; });
    refused("irradiance is NULL", [](LitMesh&, auto& d) { d.irradiance = nullptr; });
    refused("irradianceAt is 3", [](LitMesh&, auto& d) { d.irradianceAt = PelIrradianceAt(3); });
    refused("tolerance is 0", [](LitMesh&, auto& d) { d.tolerance = 0; });
    refused("diffusionRadius is -1", [](LitMesh&, auto& d) { d.diffusionRadius = -1; });
    refused("millimetresPerUnit is 0", [](LitMesh&, auto& d) { d.millimetresPerUnit = 0; });
    refused("cut is", [&](LitMesh&, auto& d) { d.cut[1] = nan; });
    refused("no red energy within 1e-30", [](LitMesh&, auto& d) { d.cut[0] = 1e-30f; });
    LitMesh mesh = sheet(2, 1);
    PelSurfaceIntegralDesc desc = mesh.desc();
    const Buffer buffer(device(), std::vector<float>(6));
    desc.points = vertexView(buffer, 2);
    desc.result = vertexView(buffer, 1);
    expectRefused("`result` has 1 vertices, `points` has 2", [&] { surfaceIntegral(device(), desc); });
}

TEST(SurfaceIntegral, TellsHowFarItIsAndCanBeCancelled) {
    const LitMesh mesh = sheet(4, 1);
    std::vector<float> points;
    for (int i = 0; i < 40000; ++i) points.insert(points.end(), {0.0001f * float(i), 1, 0});
    struct Told {
        std::vector<double> fractions;
        size_t cancelAt = SIZE_MAX;
    } told;
    device().setProgress(
        [](void* user, double fraction, const char*) {
            auto& t = *static_cast<Told*>(user);
            t.fractions.push_back(fraction);
            return int(t.fractions.size() < t.cancelAt);
        },
        &told);
    integrate(mesh.desc(), points);
    EXPECT_GE(told.fractions.size(), 4u);
    EXPECT_TRUE(std::is_sorted(told.fractions.begin(), told.fractions.end()));
    EXPECT_EQ(told.fractions.back(), 1);
    told = {{}, 2};
    expectRefused(PEL_ERROR_CANCELLED, {}, [&] { integrate(mesh.desc(), points); });
    device().setProgress(nullptr, nullptr);
}
