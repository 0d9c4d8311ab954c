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
};

// A camera that looks along -z from 100 mm, with 10 pixels a mm at z = 0.
constexpr int size = 200;
const sample::Camera camera{.eye = {0, 0, 100},
                            .up = {0, 1, 0},
                            .verticalFov = 2 * std::atan(0.1) * 180 / std::numbers::pi,
                            .nearPlane = 1};

sample::Image drawn(const Strand& strand, const demo::StrandLight& light, float depthOfAll) {
    sample::GBuffer g;
    g.width = g.height = size;
    g.viewDepth = sample::Image(size, size, 1, depthOfAll);
    return demo::drawStrands({strand}, light, camera, g);
}

double pixelsCovered(const Strand& strand, float depthOfAll) {
    const sample::Image image = drawn(strand, {}, depthOfAll);
    double sum = 0;
    for (size_t i = 0; i < image.planeSize(); ++i) {
        const float share = image.plane(3)[i];
        EXPECT_GE(share, 0);
        EXPECT_LE(share, 1);
        sum += share;
    }
    return sum;
}

// The red light of a hair that runs to the right, over what it covers.
double lightOn(const demo::StrandLight& light) {
    const sample::Image image = drawn({{{-5, 0, 0}, {0, 0, 0}, {5, 0, 0}}, 0.2}, light, 1e10f);
    return image.at(0, 120, 99) / image.at(3, 120, 99);
}

}  // namespace

// From no direction in front are teeth, tongue or the inside of the cheeks visible between the lips.
TEST_P(DemoHeads, LipsAreClosed) {
    const Vec3 left = head.eyes[0].centre, right = head.eyes[1].centre;
    const double e = length(left - right);
    int count = 0;
    for (const double azimuth : {-0.7, 0.0, 0.7})
        for (double x = -0.5 * e; x <= 0.5 * e; x += 0.2)
            for (double y = left.y - 1.4 * e; y < left.y - 0.7 * e; y += 0.2) {
                const Vec3 back{std::sin(azimuth), 0, std::cos(azimuth)};
                const sample::Hit hit =
                    scene.intersect({Vec3{x, y, head.frame.high.z - 0.4 * e} + back * 300, -back});
                if (hit.triangle == sample::Hit::none) continue;
                ++count;
                const uint32_t id = head.materials[hit.triangle];
                ASSERT_TRUE(id != demo::DEMO_TEETH && id != demo::DEMO_TONGUE) << x << ", " << y;
            }
    EXPECT_GT(count, 10000);
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
