// Nearly every kernel once, at odd sizes, against the oracle: the quickest check of another device or tool.
#include "lut/lut_cases.h"
#include "mesh/mesh_fixture.h"
#include "mesh/reference_meshes.h"
#include "shading/pass_scene.h"

using namespace pellucid;

namespace {

struct SmallMesh {
    fixture::Pair both = fixture::pairOf(
        reference::tessellate(reference::torusSurface(30, 10), 11, 7, reference::Tessellation::irregular)
            .mesh);
    const reference::Mesh& truth = both.exact;
};

}  // namespace

TEST(Small, Curvature) {
    const SmallMesh m;
    EXPECT_LT(fixture::relativeError(fixture::edgeCurvature(m.both.mesh, 2).values,
                                     reference::smoothed(m.truth, reference::edgeCurvature(m.truth), 2)),
              tolerance::edgeCurvature);
    std::vector<double> principal, normals;
    for (const auto& k : reference::tensorCurvature(m.truth))
        principal.insert(principal.end(), {k.first, k.second});
    EXPECT_LT(fixture::relativeError(
                  fixture::valuesOf(m.both.mesh,
                                    fixture::paramsOf(PEL_CURVATURE_TENSOR, 0, PEL_QUANTITY_PRINCIPAL), 2),
                  principal),
              1e-4);
    // A fit to eleven by seven vertices says little: finite, and of the right order.
    for (const PelCurvatureQuantity quantity :
         {PEL_QUANTITY_ABSOLUTE, PEL_QUANTITY_GAUSSIAN, PEL_QUANTITY_FRAME}) {
        const bool frame = quantity == PEL_QUANTITY_FRAME;
        PelCurvatureParams params = fixture::paramsOf(PEL_CURVATURE_QUADRIC, 0, quantity);
        params.smoothingRadius = frame ? 0.0f : 5.0f;
        params.smoothingCrease = 1;
        for (const float v : fixture::valuesOf(m.both.mesh, params, frame ? 8 : 1))
            EXPECT_LE(std::abs(v), 1.0f + 1e-5f);
    }
    for (const auto& n : reference::estimatedNormals(m.truth)) normals.insert(normals.end(), {n.x, n.y, n.z});
    EXPECT_LT(fixture::relativeError(fixture::normalsOf(m.both.mesh), normals), 1e-5);
    EXPECT_NEAR(fixture::uvScale(m.both.mesh) / reference::uvScale(m.truth), 1, 1e-5);
}

TEST(Small, Tables) {
    for (const fixture::ProfileCase& profile : fixture::profiles()) {
        const bool skin = profile.name == "skin";
        if (!skin && profile.name != "burley" && profile.name != "smooth") continue;
        SCOPED_TRACE(profile.name);
        const auto compare = [&](const Lut& lut, const auto& truth) {
            const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
            for (int i = 0; i < 45; ++i)
                EXPECT_NEAR(texels[size_t(i)], truth(i / 3 % 5, i / 15)[i % 3], 1e-5) << i;
            EXPECT_EQ(lut.read<uint16_t>(PEL_LUT_HALF).size(), 45u);
            EXPECT_EQ(lut.read<uint8_t>(PEL_LUT_FACEWORKS8).size(), 60u);
        };
        for (const auto& [form, trueForm] : fixture::forms) {
            if (!skin && form != PEL_FORM_SPHERE) continue;
            PelCurvatureLutDesc desc = fixture::curvatureTable(profile.ours, form, 5, 3, 0.4, 40);
            desc.axis = PEL_AXIS_LINEAR;
            const reference::CurvatureLutSpec spec{trueForm, 5, 3, desc.radiusMin, desc.radiusMax};
            compare(Lut(device(), desc),
                    [&](int x, int y) { return curvatureTexel(spec, *profile.truth, x, y); });
        }
        const PelShadowLutDesc desc = fixture::shadowTable(profile.ours, 5, 3, 3, 40, 10);
        const reference::ShadowLutSpec spec{5, 3, desc.widthMin, desc.widthMax, profile.truth->radius(), 10};
        compare(Lut(device(), desc), [&](int x, int y) { return shadowTexel(spec, *profile.truth, x, y); });
    }
    PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    specular.width = 5, specular.height = 3;
    const std::vector<float> lobes = Lut(device(), specular).read<float>(PEL_LUT_FLOAT);
    for (int i = 0; i < 15; ++i)
        EXPECT_NEAR(lobes[size_t(3 * i)], reference::beckmannEncoded((i % 5 + 0.5) / 5, (i / 5 + 0.5) / 3),
                    1e-5);
}

TEST(Small, Shading) {
    shade_test::Frame frame = shade_test::randomFrame(3, 19, 9, 2);
    frame.materials.at(7).thicknessTaps = 8;
    const auto tables = shade_test::makeTables(device(), 12, 7);
    const std::vector<float> out = shade_test::shade(device(), frame, tables);
    double difference = 0;
    for (size_t i = 0; i < frame.pixels(); ++i) {
        const reference::Rgb sum = shade_test::truth(frame, tables, i).sum();
        for (int c = 0; c < 3; ++c)
            difference = std::max(difference, std::abs(sum[c] - out[3 * i + size_t(c)]));
    }
    EXPECT_LT(difference, tolerance::shadeSum);
}

TEST(Small, PassesOverPixels) {
    const auto tables = shade_test::makeTables(device(), 12, 7);
    const shade_test::MapLight from =
        shade_test::mapLight(61, true, false, {0.5, 0.2, 0.9}, {4, 2, 5}, 40, 61);
    shade_test::Frame f = shade_test::reliefFrame(1, 19, 9, 0.4f);
    f.lights = {from.light};
    shade_test::showWideShadow(f);
    const std::vector<float> shadow = shade_test::shade(device(), f, tables);
    const PelLight& l = from.light.params;
    for (size_t i = 0; i < f.pixels(); ++i) {
        if (f.slots[PEL_SLOT_MATERIAL].at(i) == 0) continue;
        const reference::WideFilterParams params{f.materials[1].shadowFilterWidth, l.shadowBias,
                                                 l.shadowSoftness, l.shadowConeSlope,
                                                 int(l.shadowFilterTexels)};
        EXPECT_NEAR(shadow[3 * i],
                    reference::wideShadow(from.map, from.view, f.slots[PEL_SLOT_POSITION].vec(i),
                                          f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i), params),
                    tolerance::wideShadow);
    }
    shade_test::Frame g = shade_test::reliefFrame(1, 19, 9, 0.9f);
    shade_test::showBlurredNormal(g);
    g.options.blurNormals = 1;
    const std::vector<float> blurred = shade_test::shade(device(), g, tables);
    std::vector<bool> doubtful;
    const auto normals = reference::blurredNormals(shade_test::surfaceOf(g), &doubtful);
    for (size_t i = 0; i < g.pixels(); ++i)
        if (normals[i] && !doubtful[i]) {
            EXPECT_LT(reference::magnitude(shade_test::shownNormal(blurred, i) - *normals[i]),
                      tolerance::shadeTerm);
        }
}

TEST(Small, ScreenCurvature) {
    constexpr uint32_t width = 19, height = 5;
    reference::ScreenImage image{width, height, {}, {}, {}};
    std::vector<float> normals, positions;
    std::vector<uint32_t> ids;
    for (uint32_t i = 0; i < width * height; ++i) {
        const double x = 0.04 * (i % width) - 0.36, y = 0.04 * (i / width) - 0.08,
                     z = std::sqrt(1 - x * x - y * y);
        const float n[3] = {float(x), float(y), float(z)};
        normals.insert(normals.end(), n, n + 3), positions.insert(positions.end(), n, n + 3);
        image.normals.push_back({n[0], n[1], n[2]}), image.positions.push_back({n[0], n[1], n[2]});
        ids.push_back(i % width < 10 ? 70000 : 3);
    }
    image.ids = ids;
    const Buffer n(device(), normals), p(device(), positions), d(device(), ids),
        out(device(), width * height * 4);
    const PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
    const PelImageDesc places = imageDesc(p, PEL_FORMAT_RGB32F, width, height),
                       objects = imageDesc(d, PEL_FORMAT_R32_UINT, width, height);
    screenCurvature(device(), params, imageDesc(n, PEL_FORMAT_RGB32F, width, height), &places, nullptr,
                    &objects, imageDesc(out, PEL_FORMAT_R32F, width, height));
    EXPECT_LT(fixture::relativeError(out.readAll<float>(), reference::screenCurvature(image, params.edge)),
              tolerance::screenSphere);
}

TEST(Small, APartOfALiveMesh) {
    fixture::Mesh mesh = SmallMesh().both.mesh;
    const uint32_t n = mesh.vertices();
    const PelCurvatureParams params = fixture::paramsOf(PEL_CURVATURE_QUADRIC, 1);
    const MeshTopology topology(device(), fixture::topologyDesc(mesh));
    const LiveMesh live(topology, params);
    const Buffer out(device(), n * sizeof(float)), whole(device(), n * sizeof(float));
    live.update(vertexView(Buffer(device(), mesh.positions), n), nullptr, vertexView(out, n));
    for (int i = 30; i < 36; ++i) mesh.positions[size_t(i)] *= 1.01f;
    const Buffer moved(device(), mesh.positions);
    live.update(vertexView(moved, n), nullptr, vertexView(out, n), {{10, 2}});
    topology.curvature(params, vertexView(moved, n), vertexView(whole, n));
    EXPECT_EQ(out.readAll<float>(), whole.readAll<float>());
}
