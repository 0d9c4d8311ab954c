// The demo's heads, made from the meshes that come with the project, and the drawing of hair.
#include "demo/demo_hair.h"
#include "demo/dress_gbuffer.h"
#include "kept_sums.h"
#include "sample/occlusion.h"
#include "sample/scene.h"
#include "test.h"

using namespace pellucid;
using demo::DemoHead, demo::Strand;
using sample::Vec3;

namespace {

class DemoHeads : public testing::TestWithParam<const char*> {
  protected:
    const DemoHead head =
        demo::loadDemoHead(PELLUCID_SOURCE_DIR "/data/heads/" + std::string(GetParam()) + ".obj", 2);
    const sample::Scene scene{sample::MeshView{
        head.mesh.positions, head.mesh.normals, {}, {}, head.mesh.triangles, head.materials}};

    // The surface visible at `at` in the direction -back: its id (0 for nothing) and position.
    std::pair<uint32_t, Vec3> seen(Vec3 at, Vec3 back) const {
        const sample::Ray ray{at + back * 300, -back};
        const sample::Hit hit = scene.intersect(ray);
        if (hit.triangle == sample::Hit::none) return {0, {}};
        return {head.materials[hit.triangle], ray.origin + ray.direction * hit.distance};
    }
    static Vec3 from(double azimuth) {
        const double a = azimuth * std::numbers::pi / 180;
        return {std::sin(a), 0, std::cos(a)};
    }
};

// A camera that looks along -z from 100 mm, with 10 pixels a mm at z = 0.
constexpr int size = 200;
const sample::Camera camera{.eye = {0, 0, 100},
                            .up = {0, 1, 0},
                            .verticalFov = 2 * std::atan(0.1) * 180 / std::numbers::pi,
                            .nearPlane = 1};

double pixelsCovered(const Strand& strand, float depthOfAll) {
    sample::GBuffer g;
    g.width = g.height = size;
    g.viewDepth = sample::Image(size, size, 1, depthOfAll);
    const sample::Image drawn = demo::drawStrands({strand}, {}, camera, g);
    double sum = 0;
    for (size_t i = 0; i < drawn.planeSize(); ++i) {
        const float share = drawn.plane(3)[i];
        EXPECT_GE(share, 0);
        EXPECT_LE(share, 1);
        sum += share;
    }
    return sum;
}

// The red light of a hair that runs to the right, over what it covers.
double lightOn(const demo::StrandLight& light) {
    sample::GBuffer g;
    g.width = g.height = size;
    g.viewDepth = sample::Image(size, size, 1, 1e10f);
    const sample::Image drawn =
        demo::drawStrands({{{{-5, 0, 0}, {0, 0, 0}, {5, 0, 0}}, 0.2}}, light, camera, g);
    return drawn.at(0, 120, 99) / drawn.at(3, 120, 99);
}

}  // namespace

// From no direction in front are teeth, tongue or the inside of the cheeks visible between the lips.
TEST_P(DemoHeads, LipsAreClosed) {
    const Vec3 left = head.eyes[0].centre, right = head.eyes[1].centre;
    const double e = length(left - right);
    int count = 0;
    for (const double azimuth : {-40.0, 0.0, 40.0})
        for (double x = -0.5 * e; x <= 0.5 * e; x += 0.2)
            for (double y = left.y - 1.4 * e; y < left.y - 0.7 * e; y += 0.2) {
                const uint32_t id = seen({x, y, head.frame.high.z - 0.4 * e}, from(azimuth)).first;
                if (id) ++count;
                ASSERT_TRUE(id != demo::DEMO_TEETH && id != demo::DEMO_TONGUE) << x << ", " << y;
            }
    EXPECT_GT(count, 10000);
}

TEST_P(DemoHeads, LipsAreRedderGlossierAndSmootherThanCheeks) {
    const sample::SkinZone& lips = head.zones[0];
    EXPECT_LT(lips.color[1], 0.7 * lips.color[0]);
    EXPECT_GT(lips.specular, 1);
    EXPECT_LT(lips.roughness, 0.7);
    EXPECT_LT(lips.relief, 0.5);
    const auto weightAt = [&](double x, double y) {  // of what is seen from the front
        return lips.weight(seen({x, y, 200}, {0, 0, 1}).second);
    };
    const Vec3 left = head.eyes[0].centre, right = head.eyes[1].centre;
    // Where the lips meet, the surface changes from facing down to facing up.
    const auto upwards = [&](double y) {
        Vec3 normal;
        scene.firstHit({{0.1, y, 500}, {0, 0, -1}}, INFINITY, normal);
        return normal.y;
    };
    double meeting = 0, sharpest = 0;
    for (double y = left.y - 1.4 * length(left - right); y < left.y - 0.7 * length(left - right); y += 0.1)
        if (const double turn = upwards(y) - upwards(y + 0.1); turn > sharpest) sharpest = turn, meeting = y;
    EXPECT_GT(sharpest, 1);
    for (const double side : {-1.0, 1.0}) {
        EXPECT_GT(weightAt(0, meeting + 5 * side), 0.9) << "upper and lower lip";
        EXPECT_GT(weightAt(14 * side, meeting), 0.9);
        EXPECT_EQ(weightAt(0, meeting + 12 * side), 0);
        EXPECT_EQ(weightAt(0.66 * length(left - right) * side, left.y - 40), 0);
    }
}

// Every length, colour and place.
TEST_P(DemoHeads, AreTheKeptOnes) {
    KeptSums kept(std::string(GetParam()) + ".dat");
    const auto expect = [&](const auto& values, double size, const char* what) {
        kept.expect(values, tolerance::keptHead * size, what);
    };
    std::vector<double> zones, eyes, strands;
    const auto add = [](std::vector<double>& to, Vec3 v) { to.insert(to.end(), {v.x, v.y, v.z}); };
    for (const sample::SkinZone& z : head.zones) {
        add(zones, z.centre), add(zones, z.radii);
        zones.insert(zones.end(), z.color.begin(), z.color.end());
        zones.insert(zones.end(), {z.edge, z.specular, z.roughness, z.relief, z.furrows});
    }
    for (const sample::EyeLook& e : head.eyes) {
        add(eyes, e.centre), add(eyes, e.gaze);
        eyes.insert(eyes.end(), e.sclera.begin(), e.sclera.end());
        eyes.push_back(e.radius);
    }
    for (const io::SceneEye& e : head.eyeModels) {
        const PelEye& eye = e.eye;
        for (const auto* three : {eye.center, eye.gaze, eye.up, eye.irisColor})
            eyes.insert(eyes.end(), three, three + 3);
        eyes.insert(eyes.end(), {eye.scleraRadius, eye.limbusRadius, eye.limbusWidth, eye.chamberDepth,
                                 eye.irisRadius, eye.pupilRadius, double(eye.irisSeed), eye.tearRoughness});
    }
    for (const Strand& s : demo::strandsOf(scene, head)) {
        for (const Vec3 point : s.points) add(strands, point);
        add(strands, s.normal);
        strands.push_back(100 * s.radius);
    }
    expect(head.mesh.positions, 100, "positions");
    expect(head.mesh.normals, 1, "normals");
    expect(head.cornerUvs, 1, "corners in the texture");
    expect(head.materials, 1, "materials");
    expect(zones, 1, "zones");
    expect(eyes, 1, "eyes");
    expect(strands, 10, "strands");  // which begin where rays hit
    const sample::Vec3 frame[] = {head.frame.low, head.frame.high, head.pose.up, head.pose.front};
    std::vector<double> bounds;
    for (const Vec3 v : frame) add(bounds, v);
    expect(bounds, 100, "the frame and the pose");
}

// The face, an eye and the mouth: every image of their G-buffers, what light and hair add included. Means of
// 4 x 4 pixels, since another machine's rays may pass an edge on its other side.
TEST_P(DemoHeads, PixelsAreTheKeptOnes) {
    constexpr int part = 4;
    KeptSums kept(std::string(GetParam()) + "_pixels.dat");
    const std::vector<Strand> strands = demo::strandsOf(scene, head);
    const sample::Scene hair(demo::curvesOf(strands));
    sample::GBufferOptions look;
    look.looks = head.looks, look.zones = head.zones, look.eyes = head.eyes, look.thickness = true;
    const Vec3 toLight = sample::headDirection(head.pose, 54, 22);
    sample::Bounces bounces;
    bounces.lamps.emplace_back().toLight = toLight;
    bounces.sky.up = head.pose.up, bounces.hair = &hair;
    demo::StrandLight onHair{{{toLight, {1, 0.9, 0.8}}}, bounces.sky, &scene};
    const auto around = [](Vec3 centre, double half) {
        const Vec3 to{half, half, half};
        return sample::Bounds{centre - to, centre + to};
    };
    for (const sample::Bounds& shown :
         {head.frame, around(head.eyes[0].centre, 9), around(head.zones[0].centre, 30)}) {
        const sample::Camera view = sample::frameHead(shown, head.pose, {.azimuth = 25}, 1);
        sample::GBuffer g = sample::renderGBuffer(scene, view, size, size, look);
        const sample::Image occlusion = sample::ambientOcclusion(scene, g, 8, &hair);
        const std::vector<float> wetness = demo::dressEyes(g, head.pose.up);
        demo::darkenFolds(g, occlusion, wetness);
        const auto expect = [&](const char* what, const std::vector<float>& planes, double scale = 1) {
            std::vector<double> means(planes.size() / (part * part));
            for (size_t i = 0; i < planes.size(); ++i)
                means[i / size / part * (size / part) + i % size / part] += planes[i] / (scale * part * part);
            kept.expect(means, tolerance::keptPixels, what);
        };
        expect("albedo", g.albedo.data);
        expect("specular", g.specular.data);
        expect("roughness", g.roughness.data);
        expect("shading normal", g.shadingNormal.data);
        expect("blurred normal", g.blurredNormal.data);
        expect("thickness", g.thickness.data, 100);
        expect("wetness", wetness);
        expect("occlusion", occlusion.data);
        expect("shadow", sample::softShadow(scene, g, toLight, 0.1, 8, &hair).data);
        expect("bounced light", sample::bouncedLight(scene, g, bounces).data);
        expect("hair", demo::drawStrands(strands, onHair, view, g).data);
    }
}

// Except for the caruncles, which are at the corners of the eyes.
TEST_P(DemoHeads, ZonesAreTheSameOnBothSides) {
    for (size_t i = 0; i + 2 < head.zones.size(); ++i) {
        const sample::SkinZone& a = head.zones[i];
        EXPECT_TRUE(std::ranges::any_of(head.zones,
                                        [&](const sample::SkinZone& b) {
                                            const Vec3 mirrored{-b.centre.x, b.centre.y, b.centre.z};
                                            return length(a.centre - mirrored) < 0.5 &&
                                                   length(a.radii - b.radii) < 1e-9 && a.color == b.color &&
                                                   a.specular == b.specular && a.relief == b.relief;
                                        }))
            << "zone " << i << " round " << a.centre.x << ", " << a.centre.y;
    }
}

// Seen from the front, a pink hillock of skin lies between the lids, on the eye's side next to the nose.
TEST_P(DemoHeads, EachEyeHasACaruncle) {
    for (size_t i = 0; i < 2; ++i) {
        const sample::EyeLook& eye = head.eyes[i];
        const sample::SkinZone& zone = head.zones[head.zones.size() - 2 + i];
        EXPECT_LT(zone.color[1], 0.85 * zone.color[0]);
        const double toNose = (eye.centre.x > 0 ? -1 : 1) * (zone.centre.x - eye.centre.x) / eye.radius;
        EXPECT_NEAR(toNose, 0.7, 0.2);
        double area = 0;  // mm^2 of the ellipsoid
        for (double x = -4; x < 4; x += 0.1)
            for (double y = -4; y < 4; y += 0.1) {
                const Vec3 p = seen(zone.centre + Vec3{x, y, 0}, {0, 0, 1}).second - zone.centre,
                           r = zone.radii * (1 / 1.3);
                if (std::abs(std::hypot(p.x / r.x, p.y / r.y, p.z / r.z) - 1) < 0.03) area += 0.01;
            }
        EXPECT_GT(area, 2);
        EXPECT_LT(area, 20);
    }
}

// The filling of the eyes' outer corners lies behind the lids, and is visible between them.
TEST_P(DemoHeads, WhitesReachTheCornersOfTheLids) {
    for (const sample::EyeLook& eye : head.eyes)
        for (const double azimuth : {-25.0, 0.0, 25.0}) {
            const double outwards = eye.centre.x > 0 ? 1 : -1, r = eye.radius;
            double furthest = 0;
            for (double x = 0; x < 2 * r; x += 0.2)
                for (double y = -0.5 * r; y < 0.5 * r; y += 0.2) {
                    const auto [id, p] = seen(eye.centre + Vec3{outwards * x, y, r}, from(azimuth));
                    if (id == demo::DEMO_EYES || id == demo::DEMO_RIGHT_EYE)
                        furthest = std::max(furthest, outwards * (p.x - eye.centre.x) / r);
                }
            EXPECT_GT(furthest, 0.8) << azimuth;
            EXPECT_LT(furthest, 1.08) << azimuth;
        }
}

// From below one looks into the nostrils; from above, no part of the nose is dark.
TEST_P(DemoHeads, NostrilsAreDarkInside) {
    int nostrils = 0;
    for (const sample::SkinZone& zone : head.zones) {
        if (zone.color[0] > 0.2) continue;
        ++nostrils;
        const auto darkest = [&](Vec3 back) {
            double weight = 0;
            for (double x = -8; x < 8; x += 0.4)
                for (double y = -8; y < 8; y += 0.4)
                    weight = std::max(weight, zone.weight(seen(zone.centre + Vec3{x, y, 0}, back).second));
            return weight;
        };
        const double side = std::copysign(1, zone.centre.x);
        EXPECT_GT(darkest(normalize(Vec3{0.2 * side, -0.8, 0.6})), 0.8);
        EXPECT_LT(darkest(normalize(Vec3{0.4 * side, 0.9, 0.6})), 0.2);
    }
    EXPECT_EQ(nostrils, 2);
}

// Brows grow above the eyes out of the skin, lashes from the lids' edges, short hair on the scalp; none
// starts or ends in the head.
TEST_P(DemoHeads, HairGrowsOutOfTheSkin) {
    const std::vector<Strand> strands = demo::strandsOf(scene, head);
    int brows[2] = {}, lashes[2] = {}, cap = 0;
    for (const Strand& strand : strands) {
        const Vec3 root = strand.points.front(), tip = strand.points.back();
        const bool onLeft = root.x > 0;
        if (head.scalp.above(root) > 0) {
            if (cap++ % 97) continue;  // there are many
            EXPECT_LT(scene.nearest(root).distance, 0.01);
            EXPECT_GT(dot(strand.normal, tip - root), 0);
            EXPECT_LT(scene.nearest(tip).distance, 6.5);
            continue;
        }
        const sample::EyeLook& eye = head.eyes[(head.eyes[0].centre.x > 0) == onLeft ? 0 : 1];
        const bool brow = root.y > eye.centre.y + 0.8 * eye.radius;
        ++(brow ? brows : lashes)[onLeft];
        EXPECT_LT(scene.nearest(root).distance, 0.3) << "mm from the skin";
        EXPECT_GT(length(tip - root), 1);
        // Seen from the front, nothing hides the tip.
        EXPECT_FALSE(scene.occluded({tip + Vec3{0, 0, 0.3}, {0, 0, 1}}, INFINITY)) << root.x << " " << root.y;
        if (brow) {
            EXPECT_LT(scene.nearest(tip).distance, 1.5);
        } else {
            EXPECT_LT(std::abs(root.x - eye.centre.x), 1.1 * eye.radius);
            EXPECT_GT(tip.z, root.z) << "lashes point forward";
        }
    }
    for (const int side : {0, 1}) {
        EXPECT_GT(brows[side], 200);
        EXPECT_GT(lashes[side], 90);
    }
    EXPECT_GT(cap, 30000);
    EXPECT_TRUE(demo::strandsOf(scene, {}).empty());
}

TEST_P(DemoHeads, HairLeavesTheFaceAndTheEarsFree) {
    const Vec3 middle = head.scalp.betweenEyes, crown{0, head.frame.high.y, head.frame.centre().z};
    const double e = head.scalp.eyeDistance;
    EXPECT_EQ(head.scalp.cover(crown), 1);
    EXPECT_EQ(head.scalp.cover({0, middle.y, head.frame.low.z}), 1) << "the back";
    EXPECT_EQ(head.scalp.cover({0, middle.y + 1.2 * e, head.frame.high.z - 0.5 * e}), 0) << "the forehead";
    for (const double side : {-1.0, 1.0})
        EXPECT_EQ(head.scalp.cover({side * head.frame.high.x, middle.y, crown.z}), 0) << "an ear";
}

INSTANTIATE_TEST_SUITE_P(Both, DemoHeads, testing::Values("head_female", "head_male"),
                         [](const auto& info) { return std::string(info.param); });

// A strand covers its length times its mean width, whatever its direction and however thin it is.
TEST(Hair, CoversAsManyPixelsAsItIsLarge) {
    for (const double radius : {0.3, 0.05, 0.01})
        for (const Vec3 tip : {Vec3{6, 0, 0}, Vec3{0, 6, 0}, Vec3{4, -3, 0}}) {
            const Strand strand{{{-1, 0.5, 0}, Vec3{-1, 0.5, 0} + tip * 0.5, Vec3{-1, 0.5, 0} + tip}, radius};
            // From the radius to 0.15 of it; 10 pixels a mm. Two segments of one line.
            const double expected = 10 * length(tip) * 10 * 2 * radius * 0.575;
            EXPECT_NEAR(pixelsCovered(strand, 1e10f), expected, 0.06 * expected) << radius << " " << tip.x;
        }
}

TEST(Hair, IsHiddenBehindWhatIsBeforeIt) {
    const Strand strand{{{-3, 0, 0}, {3, 0, 0}}, 0.1};
    EXPECT_GT(pixelsCovered(strand, 101), 0) << "skin behind";
    EXPECT_GT(pixelsCovered(strand, 99.9f), 0) << "a root in the skin";
    EXPECT_EQ(pixelsCovered(strand, 99), 0) << "skin before it";
    EXPECT_EQ(pixelsCovered({{{-3, 0, 200}, {3, 0, 200}}, 0.1}, 1e10f), 0) << "behind the camera";
}

TEST(Hair, IsLitByWhatReachesIt) {
    demo::StrandLight light;
    const double sky = lightOn(light);
    EXPECT_GT(sky, 0);
    light.lamps = {{{0, 0, 1}, {1, 1, 1}}};
    const double lit = lightOn(light);
    EXPECT_GT(lit, 2 * sky);
    light.lamps[0].color[0] = 2;
    EXPECT_NEAR(lightOn(light) - sky, 2 * (lit - sky), 1e-6);
    const sample::Scene roof(sample::makeRectangle(-20, 20, -20, 20, 5).view());
    light.occluders = &roof;
    EXPECT_EQ(lightOn(light), sky) << "in the shadow";
    light.occluders = nullptr;
    light.lamps[0].toLight = {0, 0, -1};
    EXPECT_EQ(lightOn(light), sky) << "light from behind the skin";
}

// Pixels 0.5 mm apart, one of them in a fold; to its right an eye, and skin 5 mm deeper.
TEST(Folds, AreDarkWithSoftEdges) {
    sample::GBuffer g;
    g.width = 6, g.height = 1;
    g.material = {1, 1, 1, 1, demo::DEMO_EYES, 1};
    g.position = sample::Image(6, 1, 3);
    g.albedo = sample::Image(6, 1, 3, 0.5f);
    g.specular = sample::Image(6, 1, 1, 1);
    sample::Image occlusion(6, 1, 1, 1);
    occlusion.at(0, 3, 0) = 0.1f;
    for (int x = 0; x < 6; ++x) g.position.at(0, x, 0) = 0.5f * float(x);
    g.position.at(2, 5, 0) = -5;
    sample::GBuffer lids = g;
    demo::darkenFolds(lids, occlusion, std::vector(6, 1.0f));
    demo::darkenFolds(g, occlusion, std::vector(6, 0.0f));
    const float* green = g.albedo.plane(1);
    EXPECT_GT(lids.albedo.at(1, 3, 0), 2 * green[3]) << "the edge of a lid";
    EXPECT_LT(green[3], 0.1f);
    EXPECT_LT(g.specular.data[3], 0.2f);
    EXPECT_LT(green[3], green[2]);
    EXPECT_LT(green[2], green[1]);
    for (const int x : {0, 4, 5}) EXPECT_EQ(green[x], 0.5f) << x;
}

// An eye above y = 0 and skin below, or the other way round, five pixels a mm.
TEST(Eyes, LidsAreMoist) {
    for (const bool lower : {true, false}) {
        sample::GBuffer g;
        g.width = 2, g.height = 40;
        g.material.assign(80, demo::DEMO_SKIN);
        g.position = g.albedo = sample::Image(2, 40, 3);
        g.specular = g.roughness = sample::Image(2, 40, 1, 1);
        std::ranges::fill(g.albedo.data, 0.5f);
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < 2; ++x) {
                g.position.at(0, x, y) = 0.2f * float(x), g.position.at(1, x, y) = 0.2f * (19.5f - float(y));
                if ((y < 20) == lower) g.material[size_t(2 * y + x)] = demo::DEMO_EYES;
            }
        const std::vector<float> wet = demo::dressEyes(g, {0, 1, 0});
        const int eye = lower ? 19 : 20, skin = lower ? 20 : 19, away = lower ? -1 : 1;
        EXPECT_GT(wet[size_t(2 * eye)], wet[size_t(2 * (eye + 2 * away))]);
        EXPECT_EQ(wet[size_t(2 * (eye + 5 * away))], 0);
        EXPECT_LT(g.albedo.at(1, 0, skin), g.albedo.at(0, 0, skin)) << "pink";
        EXPECT_EQ(g.albedo.at(0, 0, skin) < 0.35f, !lower) << "roots of lashes";
        EXPECT_GT(g.specular.at(0, 0, skin), 1);
        EXPECT_LT(g.roughness.at(0, 0, skin), 1);
        EXPECT_EQ(g.albedo.at(1, 0, skin - 8 * away), 0.5f);
    }
}
