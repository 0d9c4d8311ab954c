// Curvature from a G-buffer: against the oracle, on surfaces whose curvature is known, and at edges of all
// kinds.
#include "reference/curvature.h"
#include "shade_scene.h"
#include "test.h"

using namespace shade_test;

namespace {

struct GBuffer {
    uint32_t width, height;
    std::vector<float> normals, positions, depth;  // depth, if there, in place of positions
    std::vector<uint8_t> ids;
    GBuffer(uint32_t w, uint32_t h)
        : width(w), height(h), normals(3 * w * h), positions(3 * w * h), ids(w * h, 1) {}
    size_t at(uint32_t x, uint32_t y) const { return size_t(y) * width + x; }
    void set(size_t pixel, Vec3 p, Vec3 n) {
        copyTo(&positions[3 * pixel], p), copyTo(&normals[3 * pixel], n);
    }
};

struct Options {
    bool ids = false, strided = false;
    PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
};

std::vector<float> measure(const GBuffer& g, const Options& options = {}) {
    const auto image = [&](const std::vector<float>& values, uint32_t components) {
        return imageOf(device(), values, components, g.width, g.height, options.strided);
    };
    const bool depth = !g.depth.empty();
    const auto places = depth ? image(g.depth, 1) : image(g.positions, 3),
               ids = imageDesc(Buffer(device(), g.ids), PEL_FORMAT_R8_UINT, g.width, g.height);
    const Buffer out(device(), std::vector<float>(size_t(g.width) * g.height, -7.0f));
    screenCurvature(device(), options.params, image(g.normals, 3), depth ? nullptr : &places,
                    depth ? &places : nullptr, options.ids ? &ids : nullptr,
                    imageDesc(out, PEL_FORMAT_R32F, g.width, g.height));
    return out.readAll<float>();
}

reference::ScreenImage exactOf(const GBuffer& g, bool ids) {
    reference::ScreenImage image{int(g.width), int(g.height), {}, {}, {}};
    for (size_t i = 0; i < g.ids.size(); ++i) {
        image.normals.push_back(vectorOf(&g.normals[3 * i]));
        image.positions.push_back(vectorOf(&g.positions[3 * i]));
        if (ids) image.ids.push_back(g.ids[i]);
    }
    return image;
}

// A sphere of `radius`, seen from above, over a plane; a pixel is `step` wide. Two ids.
GBuffer sphereOverPlane(uint32_t width, uint32_t height, double radius, double step) {
    GBuffer g(width, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const double px = (x + 0.5 - width / 2.0) * step, py = (y + 0.5 - height / 2.0) * step;
            const double z2 = radius * radius - px * px - py * py;
            const Vec3 p{px, py, z2 > 0 ? std::sqrt(z2) : -3 * radius};
            g.set(g.at(x, y), p, z2 > 0 ? p / radius : Vec3{0, 0, 1});
            g.ids[g.at(x, y)] = z2 > 0 ? 1 : 2;
        }
    return g;
}

}  // namespace

TEST(ScreenCurvature, EqualsTheOracleAtEverySize) {
    std::mt19937 random(5);
    std::normal_distribution<float> noise;
    for (auto [w, h] :
         {std::pair(1, 1), {1, 9}, {9, 1}, {2, 2}, {15, 3}, {16, 4}, {17, 5}, {31, 33}, {64, 20}}) {
        GBuffer g(w, h);
        for (size_t i = 0; i < g.ids.size(); ++i) {
            // A bumpy surface with holes, cliffs, several objects and normals that are not of unit length.
            const float x = float(i % w), y = float(i / w), cliff = random() % 9 == 0 ? 30.0f : 0.0f;
            g.set(i, {x, y, std::sin(0.3f * x) + std::cos(0.2f * y) + cliff},
                  {0.3 * noise(random), 0.3 * noise(random), 1.2});
            g.ids[i] = uint8_t(random() % 6);
            if (random() % 23 == 0) g.normals[3 * i + random() % 3] = random() % 2 ? NAN : INFINITY;
            if (random() % 23 == 0) g.positions[3 * i + random() % 3] = random() % 2 ? NAN : -INFINITY;
            if (random() % 23 == 0) std::fill_n(&g.normals[3 * i], 3, 0.0f);
        }
        for (bool ids : {false, true})
            for (bool strided : {false, true}) {
                Options options{.ids = ids, .strided = strided};
                options.params.scale = strided ? 2 : 1;
                const auto expected = reference::screenCurvature(exactOf(g, ids), options.params.edge);
                const auto actual = measure(g, options);
                for (size_t i = 0; i < actual.size(); ++i)
                    ASSERT_NEAR(actual[i], options.params.scale * expected[i], tolerance::screenOracle)
                        << w << " x " << h << ", pixel " << i << ids << strided;
            }
    }
}

TEST(ScreenCurvature, OfASphereIsOneOverItsRadiusUpToTheSilhouette) {
    for (double radius : {0.01, 8.0, 1e5}) {
        const GBuffer g = sphereOverPlane(120, 90, radius, radius / 30);
        for (bool ids : {false, true}) {
            const std::vector<float> c = measure(g, {.ids = ids});
            size_t measured = 0;
            for (size_t i = 0; i < c.size(); ++i) {
                if (c[i] == 0) continue;
                ASSERT_EQ(g.ids[i], 1) << "the plane has none, and nothing of the sphere's";
                ASSERT_NEAR(c[i] * radius, 1, tolerance::screenSphere) << "pixel " << i;
                ++measured;
            }
            EXPECT_GT(measured, 2700u) << "of 2827 pixels";
        }
    }
}

TEST(ScreenCurvature, FromDepthAsFromPositions) {
    // A sphere before a camera at the origin that looks along -z, planes at 1 and 9: positions come back from
    // depth.
    const uint32_t w = 96, h = 64;
    const double near = 1, far = 9, radius = 1, centre = -4, tangent = 0.3;
    GBuffer g(w, h);
    g.depth.assign(w * h, 1);
    for (uint32_t y = 0; y < h; ++y)
        for (uint32_t x = 0; x < w; ++x) {
            const double dx = tangent * w / h * ((x + 0.5) / w * 2 - 1),
                         dy = tangent * (1 - (y + 0.5) / h * 2);
            const double a = dx * dx + dy * dy + 1, b = -centre,
                         disc = b * b - a * (centre * centre - radius * radius);
            if (disc <= 0) continue;  // normal 0: nothing there
            const double t = (b - std::sqrt(disc)) / a;
            g.set(g.at(x, y), {}, {t * dx / radius, t * dy / radius, (-t - centre) / radius});
            g.depth[g.at(x, y)] = float(far / (far - near) * (1 - near / t));
        }
    Options options;
    // clip = (x / (tan aspect), y / tan, far / (far - near) (t - near), t), t = -z.
    const double k = far / (far - near);
    const float inverse[16] = {
        float(tangent * w / h), 0, 0, 0, 0, float(tangent), 0, 0, 0, 0, 0, -1, 0, 0, float(-1 / (k * near)),
        float(1 / near)};
    std::copy_n(inverse, 16, options.params.inverseViewProjection);
    size_t measured = 0;
    for (float c : measure(g, options)) {
        if (c == 0) continue;
        ++measured;
        ASSERT_NEAR(c * radius, 1, tolerance::screenFromDepth);
    }
    EXPECT_GT(measured, 1500u);
}

TEST(ScreenCurvature, NamesWhatIsWrong) {
    const Buffer b(device(), 4096), out(device(), 4096);
    const PelImageDesc three = imageDesc(b, PEL_FORMAT_RGB32F, 8, 8),
                       one = imageDesc(out, PEL_FORMAT_R32F, 8, 8);
    PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
    using Desc = const PelImageDesc*;
    const auto measured = [&](Desc n, Desc p, Desc d, Desc c) {
        return pelScreenCurvature(device().get(), &params, n, p, d, nullptr, c, nullptr);
    };
    const auto refused = [&](const char* word, Desc n, Desc p, Desc d, Desc c) {
        expectRefused(word, [&] { return measured(n, p, d, c); });
    };
    EXPECT_EQ(pelScreenCurvature(device().get(), nullptr, &three, &three, nullptr, nullptr, &one, nullptr),
              PEL_SUCCESS);
    const PelImageDesc other = imageDesc(b, PEL_FORMAT_RGB32F, 8, 7),
                       over = imageDesc(b, PEL_FORMAT_R32F, 8, 8);
    refused("normals", nullptr, &three, nullptr, &one);
    refused("either", &three, nullptr, nullptr, &one);
    refused("not both", &three, &three, &one, &one);
    refused("R32F", &three, &three, nullptr, &three);
    refused("one size", &three, &other, nullptr, &one);
    refused("overlaps", &three, &three, nullptr, &over);
    // An output that is a component of its own between others does not overlap. One that is a component of
    // the normal does, and so does the same memory through another buffer.
    const Buffer both(device(), 8 * 8 * 16);
    PelImageDesc four = imageDesc(both, PEL_FORMAT_RGB32F, 8, 8),
                 part = imageDesc(both, PEL_FORMAT_R32F, 8, 8);
    four.pixelStride = part.pixelStride = 16;
    for (part.byteOffset = 0; part.byteOffset < 12; part.byteOffset += 4)
        refused("overlaps", &four, &three, nullptr, &part);
    EXPECT_EQ(measured(&four, &three, nullptr, &part), PEL_SUCCESS);
    std::vector<float> host(3 * 64);
    const Buffer first = Buffer::fromHost(device(), host.data(), host.size() * 4),
                 second = Buffer::fromHost(device(), host.data(), 64 * 4);
    const PelImageDesc n = imageDesc(first, PEL_FORMAT_RGB32F, 8, 8),
                       c = imageDesc(second, PEL_FORMAT_R32F, 8, 8);
    refused("overlaps", &n, &three, nullptr, &c);
    params.edge = 0;
    refused("edge", &three, &three, nullptr, &one);
    params = pelScreenCurvatureParamsDefaults();
    params.scale = NAN;
    refused("scale", &three, &three, nullptr, &one);
}
