// A material that names its profile: tables, widths, transmission and gain that follow from it, against
// closed forms and the oracle's tables; units; warnings about settings without effect.
#include "diffusion/scatter_scene.h"
#include "io/io_files.h"
#include "shade_scene.h"

using namespace pellucid;

namespace {

constexpr float burleyDistance[3] = {0.9f, 0.35f, 0.2f};  // mm
constexpr uint32_t width = 64, height = 3;

// Spheres of many sizes under a light from above, each pixel with a thickness, a shadow and a position of its
// own; lengths in mm.
struct BodyScene {
    std::vector<float> normals, curvature, meanCurvature, thickness, shadow, position;

    BodyScene() {
        std::mt19937 random(4);
        std::uniform_real_distribution<float> even(0, 1);
        for (uint32_t i = 0; i < width * height; ++i) {
            const float z = 2 * (float(i) + 0.5f) / float(width * height) - 1, angle = 6.28f * even(random),
                        q = std::sqrt(1 - z * z);
            const float n[3] = {q * std::cos(angle), q * std::sin(angle), z};
            normals.insert(normals.end(), n, n + 3);
            curvature.push_back(0.3f * even(random));
            meanCurvature.push_back(0.4f * z);
            thickness.push_back(i % 5 == 0 ? 0 : 4 * even(random));
            shadow.push_back(i % 3 == 0 ? 1 : even(random));
            for (float c : n) position.push_back(20 * c);
        }
    }
};

struct Inputs {
    bool thickness = true, shadow = false, meanCurvature = false, position = false;
    float perMillimetre = 1;  // units of the scene
    PelShaderOptions options = pelShaderOptionsDefaults();
};

// Over `extent` a side about the origin.
struct SquareMap {
    uint32_t side;
    float extent;
    std::vector<float> depth = std::vector<float>(size_t(side) * side, 0.5f);
};

struct Shading : scatter_scene::ShownImages {
    explicit Shading(const PelMaterial& material, const Inputs& in = {})
        : ShownImages(::device(), ::width, ::height) {
        const auto scaled = [](std::vector<float> values, float by) {
            for (float& v : values) v *= by;
            return values;
        };
        shader.set(in.options);
        set(PEL_SLOT_NORMAL_SHADING, scene.normals);
        set(PEL_SLOT_CURVATURE, scaled(scene.curvature, 1 / in.perMillimetre));
        if (in.meanCurvature) set(PEL_SLOT_MEAN_CURVATURE, scaled(scene.meanCurvature, 1 / in.perMillimetre));
        if (in.thickness) set(PEL_SLOT_THICKNESS, scaled(scene.thickness, in.perMillimetre));
        if (in.position) set(PEL_SLOT_POSITION, scene.position);
        shader.set(directionalLight({0, 0, 1}, {1, 1, 1}));
        if (in.shadow) setMap(PEL_LIGHT_WIDE_SHADOW, scene.shadow, width, height);
        shader.setMaterial(1, material).commit();
    }
    // Other points, where the table's dark side is 0.
    void place(const std::vector<float>& positions, const std::vector<float>& normals) {
        set(PEL_SLOT_POSITION, positions);
        set(PEL_SLOT_NORMAL_SHADING, normals);
        set(PEL_SLOT_CURVATURE, std::vector<float>(positions.size() / 3));
    }
    // Of a light that looks down; the finest first. `others`: lights without any.
    void setMaps(const std::vector<SquareMap>& maps, const std::vector<PelLight>& others = {}) {
        PelLight light = pelLightDefaults();
        light.shadowCascades = maps.size() > 1 ? uint32_t(maps.size()) : 0;
        for (size_t k = 0; k < maps.size(); ++k) {
            const float extent = maps[k].extent, per = 1 / extent;
            const float matrix[16] = {per, 0, 0, 0.5f, 0, -per, 0, 0.5f, 0, 0, -per, 0.5f, 0, 0, 0, 1};
            std::copy_n(matrix, 16, k ? light.cascadeToShadow[k - 1] : light.worldToShadow);
            (k ? light.cascadeDepthRange[k - 1] : light.shadowDepthRange) = extent;
        }
        std::vector<PelLight> lights{light};
        lights.insert(lights.end(), others.begin(), others.end());
        shader.set(lights);
        for (size_t k = 0; k < maps.size(); ++k)
            setMap(PelLightSlot(k ? PEL_LIGHT_CASCADE_1 + int(k) - 1 : int(PEL_LIGHT_SHADOW_MAP)),
                   maps[k].depth, maps[k].side, maps[k].side);
        shader.commit();
    }
    BodyScene scene;
};

PelMaterial materialOf(const Profile& profile) {
    PelMaterial m = material(profile, {1, 1, 1});
    m.scattering = PEL_SCATTERING_PREINTEGRATED;
    return m;
}

const Profile& burley() {
    static const Profile profile = Profile::burleyDistance(burleyDistance);
    return profile;
}

bool warned(const Shading& shading, const char* words) {
    return contains(shading.shader.warnings(), words);
}

// Section 11: what a slab of thickness s lets through, of Burley's profile of length d.
double throughSlab(double s, double d) {
    return 0.25 * std::exp(-s / d) + 0.75 * std::exp(-s / (3 * d));
}
void expectSlab(const std::vector<float>& radiance, uint32_t i, double s) {
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(radiance[3 * i + c], throughSlab(s, burleyDistance[c]), tolerance::profileLookUp)
            << "pixel " << i << " s " << s;
}

// The oracle's D of the profile at a pixel of the scene.
reference::ProfilePtr oracleProfile() {
    // burley from mean free paths of s(A) times d: albedo 1 gives s = 1.9 - 1 + 3.5 * 0.04
    const double s = 0.9 + 3.5 * 0.04;
    return reference::burleyProfile({burleyDistance[0] * s, burleyDistance[1] * s, burleyDistance[2] * s},
                                    {1, 1, 1});
}

}  // namespace

TEST(ShadeProfile, TheProfileAloneGivesItsTablesAndWidths) {
    const Profile profile = burley();
    const PelProfileInfo info = profile.info();
    Shading shading(materialOf(profile), {.thickness = false});
    const auto radiance = shading.execute();
    const auto truth = oracleProfile();
    for (size_t i = 0; i < width * height; ++i) {
        const auto d =
            reference::curvatureD(reference::Form::sphere, *truth, shading.scene.normals[3 * i + 2],
                                  1 / std::max(double(shading.scene.curvature[i]), 1e-3 / info.radius));
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(radiance[3 * i + c], d[int(c)], tolerance::profileLookUp)
                << "pixel " << i << " channel " << c;
    }
    const PelMaterial resolved = shading.shader.material(1);
    EXPECT_EQ(resolved.diffusionRadius, info.radius);
    EXPECT_FLOAT_EQ(resolved.shadowFilterWidth, 1.3f * info.width[0]);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(resolved.normalBlend[c], info.normalBlend[c]);
}

// A table of another profile than skin, read by a material that does not specify a radius, is not stretched.
TEST(ShadeProfile, ARadiusOfZeroIsTheTablesOwn) {
    const Profile marble = Profile::named("marble");
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = 32;
    desc.profile = marble.get();
    const Lut lut(device(), desc);
    EXPECT_EQ(lut.info().curvature.diffusionRadius, marble.info().radius);
    PelMaterial silent = pelMaterialDefaults(), spoken = silent;
    spoken.diffusionRadius = marble.info().radius;
    Shading a(silent), b(spoken);
    EXPECT_EQ(a.shader.material(1).diffusionRadius, 2.7f);
    a.shader.setMaterial(1, silent, lut).commit();
    b.shader.setMaterial(1, spoken, lut).commit();
    EXPECT_EQ(a.shader.material(1).diffusionRadius, marble.info().radius);
    EXPECT_EQ(a.execute(), b.execute());
    // Profiles are in mm, whatever the scene's unit is; a radius that the table is given is in the scene's.
    Inputs cm;
    cm.options.millimetresPerUnit = 10;
    Shading c(silent, cm);
    c.shader.setMaterial(1, silent, lut).commit();
    EXPECT_FLOAT_EQ(c.shader.material(1).diffusionRadius, marble.info().radius / 10);
    desc.diffusionRadius = 0.3f;
    c.shader.setMaterial(1, silent, Lut(device(), desc)).commit();
    EXPECT_FLOAT_EQ(c.shader.material(1).diffusionRadius, 0.3f);
}

// Section 11: the slab's transmission takes the place of the table's dark side where it is the larger, and is
// never added.
TEST(ShadeProfile, TransmissionIsTheSlabsAndNeverAdded) {
    PelMaterial material = materialOf(burley());
    Shading shading(material);
    const auto radiance = shading.execute();
    material.transmission = 0;
    const auto without = Shading(material).execute();
    int through = 0;
    for (size_t i = 0; i < width * height; ++i)
        for (size_t c = 0; c < 3; ++c) {
            const double s = shading.scene.thickness[i], d = burleyDistance[c],
                         back = std::max(0.0f, -shading.scene.normals[3 * i + 2]);
            const double slab = back * throughSlab(s, d);
            EXPECT_NEAR(radiance[3 * i + c], std::max(double(without[3 * i + c]), slab),
                        tolerance::profileLookUp)
                << "pixel " << i << " channel " << c << " thickness " << s;
            through += slab > without[3 * i + c] + tolerance::profileLookUp;
        }
    EXPECT_GT(through, 100);
    material.transmission = 0.5f;
    const auto less = Shading(material).execute();
    for (size_t i = 0; i < less.size(); ++i) EXPECT_LE(less[i], radiance[i]);
}

// A radius that differs from the profile's stretches all of it.
TEST(ShadeProfile, ARadiusOfTwiceIsAProfileOfTwiceTheSize) {
    const auto sized = [](float k) {
        return Profile::gaussians({{0.1f * k * k, {0.2f, 0.5f, 0.7f}}, {k * k, {0.8f, 0.5f, 0.3f}}});
    };
    const Profile one = sized(1), two = sized(2);
    PelMaterial material = materialOf(two);
    material.shadowFilterWidth = 3;
    const auto expected = Shading(material, Inputs{}).execute();
    material.profile = one.get();
    material.diffusionRadius = 2 * one.info().radius;
    const auto stretched = Shading(material, Inputs{}).execute();
    for (size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(stretched[i], expected[i], tolerance::unitRoundTrip);
}

TEST(ShadeProfile, NothingIsKnownToComeThroughFromALightWithoutAMap) {
    Shading shading(materialOf(burley()), {.thickness = false, .position = true});
    const PelLight below = directionalLight({0, 0, -1}, {1, 1, 1});
    shading.shader.set(below).commit();
    const auto alone = shading.execute();
    const std::vector<SquareMap> map{{2, 60, std::vector<float>(4, 0.2f)}};
    shading.setMaps(map);
    const auto mapped = shading.execute();
    shading.setMaps(map, {below});
    const auto both = shading.execute();
    for (size_t i = 0; i < both.size(); ++i)
        EXPECT_NEAR(both[i], alone[i] + mapped[i], tolerance::profileLookUp) << i;
}

TEST(ShadeProfile, TransmissionOfEveryKindIsWhatLiesBeyond) {
    const std::vector<Profile> all{Profile::skin(), Profile::named("marble"), burley(),
                                   Profile::table({0, 1, 2.5f}, {3, 2, 1, 1, 1, 2, 0, 0.5f, 0})};
    for (const Profile& profile : all) {
        const double radius = profile.info().radius;
        for (double s : {0.0, 0.2, 1.0, 2.0}) {
            // 1 less the integral of R 2 pi d dd up to s, by midpoints in the root of d: R may grow like 1/d.
            constexpr int steps = 20000;
            std::vector<double> at;
            for (int i = 0; i < steps; ++i)
                at.push_back(std::max(1e-12, s * radius * std::pow((i + 0.5) / steps, 2)));
            const auto R = profile.radial(at);
            const auto through = profile.transmission({s * radius});
            for (size_t c = 0; c < 3; ++c) {
                double within = 0;
                for (size_t i = 0; i < steps; ++i)
                    within +=
                        R[3 * i + c] * 2 * M_PI * at[i] * s * radius * 2 * (double(i) + 0.5) / steps / steps;
                EXPECT_NEAR(through[c], 1 - within, tolerance::transmissionSum)
                    << profile.info().name << " s " << s << " channel " << c;
            }
        }
        EXPECT_LE(profile.transmission({profile.info().reach})[0], 1.001e-3);
    }
}

// Closed ends: where the filter is lit to its end the shadow takes nothing, and leaves nothing at the other
// end.
TEST(ShadeProfile, LitSkinLosesNothingToTheShadow) {
    const PelMaterial material = materialOf(burley());
    const auto lit = Shading(material, {.thickness = false}).execute();
    Shading shading(material, {.thickness = false, .shadow = true});
    const auto shadowed = shading.execute();
    for (size_t i = 0; i < width * height; ++i)
        for (size_t c = 0; c < 3; ++c) {
            if (shading.scene.shadow[i] == 1) {
                EXPECT_NEAR(shadowed[3 * i + c], lit[3 * i + c], tolerance::unitRoundTrip);
            }
            EXPECT_LE(shadowed[3 * i + c], lit[3 * i + c] + tolerance::unitRoundTrip);
        }
}

// The same scene in millimetres, centimetres and metres.
TEST(ShadeProfile, UnitsOfTheSceneDoNotMatter) {
    const Profile profile = Profile::named("skin-burley");
    Inputs in;
    in.shadow = in.meanCurvature = true;
    PelMaterial material = materialOf(profile);
    const auto expected = Shading(material, in).execute();
    for (float unit : {10.0f, 1000.0f, 0.001f}) {
        in.perMillimetre = 1 / unit;
        in.options.millimetresPerUnit = unit;
        Shading shading(material, in);
        const auto radiance = shading.execute();
        for (size_t i = 0; i < radiance.size(); ++i)
            EXPECT_NEAR(radiance[i], expected[i], tolerance::unitRoundTrip) << "unit " << unit;
        EXPECT_NEAR(shading.shader.material(1).diffusionRadius * unit / profile.info().radius, 1,
                    tolerance::unitRoundTrip);
    }
}

TEST(ShadeProfile, GainFollowsTheMeanFreePath) {
    const float path[3] = {1, 0.5f, 0.25f}, albedo[3] = {0.9f, 0.8f, 0.3f};
    const Profile profile = Profile::burley(path, albedo);
    PelMaterial material = materialOf(profile);
    const auto plain = Shading(material, {.thickness = false}).execute();
    const Inputs in{.thickness = false, .meanCurvature = true};
    const auto expectGain = [&](const Profile& of, double strength, const auto& pathOf,
                                const auto& lengthOf) {
        material.profile = of.get();
        material.curvatureGain = float(strength);
        Shading shading(material, in);
        PelMaterial flat = material;
        flat.curvatureGain = 0;
        const auto gained = shading.execute(), without = Shading(flat, in).execute();
        for (size_t i = 0; i < width * height; ++i)
            for (size_t c = 0; c < 3; ++c) {
                const double x = strength * pathOf(c) * shading.scene.meanCurvature[i],
                             gain = reference::curvatureGain(x, pathOf(c) / lengthOf(c));
                EXPECT_NEAR(gained[3 * i + c], without[3 * i + c] * gain, tolerance::unitRoundTrip);
            }
        return without;
    };
    const auto lengthOf = [&](size_t c) {
        return path[c] / reference::burleyScale(reference::BurleyFit::diffuseTransmission, albedo[c]);
    };
    const auto ofBurley = [&](size_t c) { return reference::mediumPath(lengthOf(c), albedo[c]); };
    EXPECT_EQ(expectGain(profile, 1, ofBurley, lengthOf), plain);
    expectGain(profile, 0.5, ofBurley, lengthOf);
    // Of Burley's distance d the path is 1.087 d. Sums of Gaussians say nothing of it.
    expectGain(
        burley(), 1, [&](size_t c) { return 1.087 * burleyDistance[c]; },
        [&](size_t c) { return burleyDistance[c]; });
    expectGain(
        Profile::skin(), 1, [](size_t) { return 0.0; }, [](size_t) { return 1.0; });
}

TEST(ShadeProfile, WhatHasNoEffectIsSaid) {
    PelMaterial m = pelMaterialDefaults();
    EXPECT_EQ(Shading(m, {.thickness = false}).shader.warnings(), "");
    m.deepScatterColor[0] = 1;
    EXPECT_TRUE(warned(Shading(m, {.thickness = false}), "deepScatterColor without effect"));
    EXPECT_EQ(Shading(m).shader.warnings(), "");
    // Taps without the camera's matrix.
    const Profile profile = Profile::named("skin-burley");
    m = materialOf(profile);
    m.scattering = PEL_SCATTERING_SEPARABLE;
    Shading shading(m, {.position = true});
    EXPECT_TRUE(warned(shading, "placed by PelCamera.inverseViewProjection"));
    PelCamera camera = pelCameraDefaults();
    camera.inverseViewProjection[0] = 2;
    EXPECT_EQ(std::string(shading.shader.set(camera).commit().warnings()), "");
}

// PEL_SCATTERING_AUTO scatters on the screen where that fits; it says how much there must be.
TEST(ShadeProfile, AutoKeepsToTheScratchBudget) {
    const Profile profile = Profile::named("skin-burley");
    PelMaterial material = materialOf(profile);
    material.scattering = PEL_SCATTERING_AUTO;
    Shading shading(material, {.thickness = false, .position = true});
    const auto said = [&](uint64_t budget) {
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.scratchBudget = budget;
        shading.shader.set(options).commit();
        return std::string(shading.shader.warnings());
    };
    const std::string all = "needs memory for the whole frame, ";
    const std::string small = said(4096);
    const size_t at = small.find(all);
    ASSERT_NE(at, std::string::npos) << small;
    EXPECT_EQ(shading.shader.material(1).scattering, PEL_SCATTERING_PREINTEGRATED);
    const uint64_t needed = std::stoull(small.substr(at + all.size()));
    EXPECT_NE(said(needed - 1).find(all), std::string::npos);
    EXPECT_EQ(said(needed).find(all), std::string::npos);
    EXPECT_EQ(shading.shader.material(1).scattering, PEL_SCATTERING_SCREEN);
    EXPECT_GT(needed, uint64_t(width) * height * 4 * sizeof(float));
    shading.shader.execute();
    EXPECT_LE(shading.shader.stats().scratchBytes, needed + needed / 4) << "the budget is for images alone";
    EXPECT_GE(shading.shader.stats().scratchBytes, needed / 2);
    // Beside it, what has no profile takes light as it comes.
    shading.shader.setMaterial(2, pelMaterialDefaults()).commit();
    EXPECT_EQ(shading.shader.material(2).scattering, PEL_SCATTERING_NONE);
    said(4096);
    EXPECT_EQ(shading.shader.material(2).scattering, PEL_SCATTERING_PREINTEGRATED);
    // An explicitly chosen method is not replaced, and cannot work in bands.
    material.scattering = PEL_SCATTERING_SCREEN;
    shading.shader.setMaterial(1, material);
    expectRefused(PEL_ERROR_OUT_OF_MEMORY, {"needs at least"}, [&] { said(needed - 1); });
}

// Texels that are longer than light reaches; and a map that is smaller, which holds no body of that profile:
// the unit is wrong.
TEST(ShadeProfile, MapsThatDoNotFitTheProfileAreSaid) {
    const Profile profile = burley(), skin = Profile::skin();
    const struct {
        const Profile& profile;
        uint32_t side;
        float extent, unit;
        const char* word;
        bool said;
    } cases[] = {{profile, 4, 4, 1, "texel", false},
                 {profile, 4, 400, 1, "texel", true},
                 {skin, 512, 300, 1, "millimetresPerUnit", false},
                 {skin, 512, 300, 3, "millimetresPerUnit", false},
                 {skin, 512, 300, 0.01f, "millimetresPerUnit", true}};
    for (const auto& c : cases) {
        Inputs in{.thickness = c.side > 4, .position = true};
        in.options.millimetresPerUnit = c.unit;
        Shading shading(materialOf(c.profile), in);
        shading.setMaps({{c.side, c.extent}});
        EXPECT_EQ(warned(shading, c.word), c.said)
            << c.extent << ' ' << c.unit << ": " << shading.shader.warnings();
    }
    // The largest cascade is what the object must fit in.
    Shading shading(materialOf(skin), {.thickness = false, .position = true});
    shading.setMaps({{64, 4}, {64, 300}});
    EXPECT_FALSE(warned(shading, "millimetresPerUnit"));
}

// The thickness is the greatest of eight taps within two texels: over a map of random heights, each tap is
// the greatest somewhere. Of cascades it is that of the finest map that holds the taps.
TEST(ShadeProfile, ThicknessFromAMapIsTheGreatestNearby) {
    Shading shading(materialOf(burley()), {.thickness = false});
    std::mt19937 random(5);
    std::uniform_real_distribution<float> even(-1, 1);
    std::vector<float> position, normals;
    std::vector<SquareMap> maps{{16, 32, {}}, {32, 64, {}}};  // 2 mm a texel
    for (SquareMap& map : maps)
        for (uint32_t i = 0; i < map.side * map.side; ++i)  // z = -1 to 4
            map.depth.push_back(0.5f - (1.5f + 2.5f * even(random)) / map.extent);
    for (uint32_t i = 0; i < width * height; ++i) {
        position.insert(position.end(), {28 * even(random), 28 * even(random), -1});
        normals.insert(normals.end(), {0, 0, -1});
    }
    shading.place(position, normals);
    for (const bool cascades : {true, false}) {
        if (!cascades) maps.erase(maps.begin());
        shading.setMaps(maps);
        const auto radiance = shading.execute();
        for (uint32_t i = 0; i < width * height; ++i) {
            const float aside = std::max(std::abs(position[3 * i]), std::abs(position[3 * i + 1]));
            const SquareMap& map = aside < 12 ? maps.front() : maps.back();
            const double x = (position[3 * i] / map.extent + 0.5) * map.side - 0.5,
                         y = (0.5 - position[3 * i + 1] / map.extent) * map.side - 0.5;
            double s = 0;
            for (const reference::Vec2& tap : shade_test::diskTaps(8)) {
                const double nearest =
                    reference::bilinearAt(x + 2 * tap.x, y + 2 * tap.y, [&](int column, int row) {
                        return double(map.depth[size_t(row) * map.side + size_t(column)]);
                    });
                s = std::max(s, (0.5 - nearest) * map.extent + 1);
            }
            expectSlab(radiance, i, s);
        }
    }
}

// Also in a cube: beside a step of the map, the thicker side does not become thin.
TEST(ShadeProfile, ThicknessFromACubeIsTheGreatestNearby) {
    Shading shading(materialOf(burley()), {.thickness = false});
    constexpr uint32_t side = 256;
    constexpr float far = 30;                                  // mm, as the thickness
    constexpr double texel = 2.0 / side, thick = 6, thin = 1;  // texel: radians
    const reference::Vec3 axis = normalized(reference::Vec3{0.5, -0.7, 0.4}),
                          right = normalized(cross(axis, reference::Vec3{0, 0, 1})), up = cross(right, axis);
    std::vector<float> depth, position, normals;
    for (uint32_t i = 0; i < 6 * side * side; ++i) {
        const reference::Vec3 d = reference::cubeDirection(
            int(i / (side * side)), texel * (i % side + 0.5) - 1, texel * (i / side % side + 0.5) - 1);
        depth.push_back(float((far - (dot(d, axis) < 0 ? thick : thin)) / far));
    }
    std::mt19937 random(6);
    std::uniform_real_distribution<double> even(0, 1);
    std::vector<double> above;  // radians from the step
    for (uint32_t i = 0; i < width * height; ++i) {
        const double angle = (13 * even(random) - 5) * texel, turn = 2 * M_PI * even(random);
        const reference::Vec3 d =
            std::sin(angle) * axis + std::cos(angle) * (std::cos(turn) * right + std::sin(turn) * up);
        above.push_back(angle);
        for (int k = 0; k < 3; ++k) position.push_back(float(far * d[k])), normals.push_back(float(d[k]));
    }
    shading.place(position, normals);
    PelLight light = pointLight({0, 0, 0}, {far * far, far * far, far * far});
    light.shadowProjection = PEL_SHADOW_CUBE_RADIAL;
    light.shadowDepthRange = far;
    for (int k = 0; k < 4; ++k) light.worldToShadow[5 * k] = 1;
    shading.shader.set(light);
    shading.setMap(PEL_LIGHT_SHADOW_MAP, depth, side, 6 * side);
    shading.shader.commit();
    const auto radiance = shading.execute();
    for (uint32_t i = 0; i < width * height; ++i) {
        if (above[i] > -texel && above[i] < 4 * texel) continue;  // one or the other
        expectSlab(radiance, i, above[i] < 0 ? thick : thin);
    }
}
