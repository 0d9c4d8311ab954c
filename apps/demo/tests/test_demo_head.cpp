// The demo's heads: what is made of the meshes that come with the project, and how hair is drawn.
#include "demo/demo_hair.h"
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

double pixelsCovered(const Strand& strand, float depthOfAll) {
    sample::GBuffer g;
    g.width = g.height = size;
    g.viewDepth = sample::Image(size, size, 1, depthOfAll);
    const sample::Image cover = demo::coverageOf({strand}, camera, g);
    double sum = 0;
    for (const float share : cover.data) {
        EXPECT_GE(share, 0);
        EXPECT_LE(share, 1);
        sum += share;
    }
    return sum;
}

}  // namespace

// From no side in front can one look between the lips at teeth, tongue or the inside of the cheeks.
TEST_P(DemoHeads, LipsAreClosed) {
    const Vec3 left = head.eyes[0].centre, right = head.eyes[1].centre;
    const double e = length(left - right);
    int seen = 0;
    for (const double azimuth : {-40.0, 0.0, 40.0})
        for (double x = -0.5 * e; x <= 0.5 * e; x += 0.2)
            for (double y = left.y - 1.4 * e; y < left.y - 0.7 * e; y += 0.2) {
                const double a = azimuth * std::numbers::pi / 180;
                const Vec3 back{std::sin(a), 0, std::cos(a)}, at{x, y, head.frame.high.z - 0.4 * e};
                const sample::Hit hit = scene.intersect({at + back * (4 * e), -back});
                if (hit.triangle == sample::Hit::none) continue;
                ++seen;
                const uint32_t id = head.materials[hit.triangle];
                ASSERT_TRUE(id != demo::DEMO_TEETH && id != demo::DEMO_TONGUE) << x << ", " << y;
            }
    EXPECT_GT(seen, 10000);
}

TEST_P(DemoHeads, LipsAreRedderGlossierAndSmootherThanCheeks) {
    const sample::SkinZone& lips = head.zones[0];
    EXPECT_LT(lips.color[1], 0.7 * lips.color[0]);
    EXPECT_GT(lips.specular, 1);
    EXPECT_LT(lips.roughness, 0.7);
    EXPECT_LT(lips.relief, 0.5);
    const auto weightAt = [&](double x, double y) {  // of what is seen from the front
        const sample::Ray ray{{x, y, 500}, {0, 0, -1}};
        return lips.weight(ray.origin + ray.direction * scene.intersect(ray).distance);
    };
    const Vec3 left = head.eyes[0].centre, right = head.eyes[1].centre;
    // Where the lips meet, what faces down ends and what faces up begins.
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

// Brows grow above the eyes out of the skin, lashes from the lids' edges; none starts or ends in the head.
TEST_P(DemoHeads, HairGrowsOutOfTheSkin) {
    const std::vector<Strand> strands = demo::strandsOf(scene, head.eyes);
    int brows[2] = {}, lashes[2] = {};
    for (const Strand& strand : strands) {
        const Vec3 root = strand.points.front(), tip = strand.points.back();
        const bool onLeft = root.x > 0;
        const sample::EyeLook& eye = head.eyes[(head.eyes[0].centre.x > 0) == onLeft ? 0 : 1];
        const bool brow = root.y > eye.centre.y + 0.8 * eye.radius;
        ++(brow ? brows : lashes)[onLeft];
        EXPECT_LT(scene.nearest(root).distance, 0.3) << "mm from the skin";
        EXPECT_GT(length(tip - root), 1);
        // Nothing is before the tip, seen from the front.
        EXPECT_FALSE(scene.occluded({tip + Vec3{0, 0, 0.3}, {0, 0, 1}}, INFINITY))
            << root.x << " " << root.y << " to " << tip.x << " " << tip.y << " " << tip.z << " eye "
            << eye.centre.y;
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
