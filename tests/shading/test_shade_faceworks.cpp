// The shading kernel against per-pixel data of FaceWorks (PELLUCID_ORACLE_DIR): from its own 8-bit tables.
#include <gtest/gtest.h>

#include "npy.h"
#include "shade_scene.h"
#include "tolerances.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr uint32_t width = 200, height = 100;

double linear(double s) {
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

// FaceWorks' 20,000 pixels as a frame. Its light has another direction in each; ours has one, +z: `turned`
// gives vectors in a frame of the pixel's own in which that is so.
class ShadeFaceWorks : public testing::Test {
  protected:
    void SetUp() override {
        REQUIRE_ORACLE_DIRECTORY(directory);
        in_ = npy::read<float>(directory / "oracle_inputs_f32.npy");
        out_ = npy::read<float>(directory / "oracle_out_A_f32.npy");
        depth_ = npy::read<float>(directory / "oracle_depth256_f32.npy");
        ASSERT_EQ(in_.shape[0], size_t(width) * height);
        curvature_ = lut(directory / "fw_lut_curv_A_u8.npy", PEL_LUT_CURVATURE);
        shadow_ = lut(directory / "fw_lut_shadow_A_u8.npy", PEL_LUT_SHADOW);
        frame_.width = width;
        frame_.height = height;
        frame_.lights.resize(1);
        frame_.materials[1] = fixture::faceworksMaterial();
        for (float& c : frame_.materials[1].albedo) c = 1;
        frame_.materials[1].shadowFilterWidth = 9;
    }
    static pellucid::Lut lut(const std::filesystem::path& file, PelLutKind kind) {
        const auto bytes = npy::read<uint8_t>(file);
        PelLutInfo info = pelLutInfoDefaults();
        info.kind = kind;
        std::vector<float> texels;
        for (size_t i = 0; i < 512 * 512; ++i)
            for (int c = 0; c < 3; ++c) {
                const double value = bytes.data[4 * i + c] / 255.0, u = (double(i % 512) + 0.5) / 256 - 1;
                texels.push_back(
                    float(kind == PEL_LUT_CURVATURE ? value / 2 - 0.25 + std::max(u, 0.0) : linear(value)));
            }
        return pellucid::Lut(device(), info, texels);
    }
    Vec3 in(size_t i, int first) const {
        const float* p = in_.row(i) + first;
        return {p[0], p[1], p[2]};
    }
    Vec3 turned(size_t i, Vec3 v) const {
        const Vec3 z = reference::normalized(in(i, 9));
        const Vec3 x =
            reference::normalized(reference::cross(std::abs(z.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, z));
        return {reference::dot(v, x), reference::dot(v, reference::cross(z, x)), reference::dot(v, z)};
    }
    template <class F>
    void fill(PelImageSlot slot, uint32_t components, F value) {
        fillImage(frame_.slots[slot], components, value);
    }
    template <class F>
    void fillImage(Image& image, uint32_t components, F value) {
        image.components = components;
        image.values.clear();
        for (size_t i = 0; i < frame_.pixels(); ++i) {
            const Vec3 v = value(i);
            for (uint32_t c = 0; c < components; ++c) image.values.push_back(float(v[int(c)]));
        }
    }
    // Radiance, or the thickness output.
    std::vector<float> run(bool thickness = false) {
        Shader shader(device());
        setFrame(device(), shader, frame_, tables());
        shader.setMaterial(1, frame_.materials[1], frame_.curvatureLut ? curvature_ : pellucid::Lut(),
                           frame_.shadowLut ? shadow_ : pellucid::Lut());
        const Buffer target(device(), frame_.pixels() * 12), lengths(device(), frame_.pixels() * 4);
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, width, height));
        if (thickness) shader.set(PEL_SLOT_OUT_THICKNESS, imageDesc(lengths, PEL_FORMAT_R32F, width, height));
        shader.commit().execute();
        return thickness ? lengths.readAll<float>() : target.readAll<float>();
    }
    // Largest difference of RGB pixels from FaceWorks' outputs first, first + 1, ...
    double worst(const std::vector<float>& ours, int first, int count, int stride = 3) const {
        double largest = 0;
        for (size_t i = 0; i < frame_.pixels(); ++i)
            for (int c = 0; c < count; ++c)
                largest = std::max(
                    largest, std::abs(double(ours[size_t(stride) * i + size_t(c)]) - out_.row(i)[first + c]));
        return largest;
    }
    void normals() {
        fill(PEL_SLOT_NORMAL_GEOMETRIC, 3, [&](size_t i) { return turned(i, in(i, 0)); });
        fill(PEL_SLOT_NORMAL_SHADING, 3, [&](size_t i) { return turned(i, in(i, 3)); });
        fill(PEL_SLOT_NORMAL_BLURRED, 3, [&](size_t i) { return turned(i, in(i, 6)); });
    }

    npy::Array<float> in_, out_, depth_;
    pellucid::Lut curvature_, shadow_;
    Frame frame_;
};

TEST_F(ShadeFaceWorks, Direct) {
    normals();
    fill(PEL_SLOT_CURVATURE, 1, [&](size_t i) { return Vec3{in_.row(i)[12], 0, 0}; });
    EXPECT_LE(worst(run(), 0, 3), tolerance::faceWorksDirect);
}

TEST_F(ShadeFaceWorks, Shadow) {
    normals();
    frame_.curvatureLut = false;
    fill(PEL_SLOT_NORMAL_SHADING, 3, [](size_t) { return Vec3{0, 0, 1}; });  // a direct term of 1
    fillImage(frame_.lights[0].wide, 1, [&](size_t i) { return Vec3{in_.row(i)[13], 0, 0}; });
    EXPECT_LE(worst(run(), 3, 3), tolerance::faceWorksPass);
}

TEST_F(ShadeFaceWorks, AmbientNormals) {
    fill(PEL_SLOT_NORMAL_SHADING, 3, [&](size_t i) { return in(i, 3); });
    fill(PEL_SLOT_NORMAL_BLURRED, 3, [&](size_t i) { return in(i, 6); });
    frame_.lights.clear();
    const double band = std::sqrt(3 / (4 * 3.14159265358979323846));
    const int basis[3] = {3, 1, 2};
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis) {  // E = 1 + n[axis] / 2, where each channel has a normal of its own
        frame_.ambient = pelAmbientDefaults();
        for (int c = 0; c < 3; ++c)
            frame_.ambient.constant[c] = 1, frame_.ambient.sh[basis[axis]][c] = float(0.5 / band);
        const auto shown = run();
        for (size_t i = 0; i < frame_.pixels(); ++i)
            for (int c = 0; c < 3; ++c)
                largest = std::max(largest, std::abs(2.0 * (shown[3 * i + size_t(c)] - 1.0) -
                                                     out_.row(i)[7 + 3 * c + axis]));
    }
    EXPECT_LE(largest, tolerance::faceWorksPass);
}

TEST_F(ShadeFaceWorks, DeepScatterOfAGivenThickness) {
    normals();
    fill(PEL_SLOT_NORMAL_SHADING, 3, [](size_t) { return Vec3{0, 0, -1}; });  // no direct light
    frame_.curvatureLut = frame_.shadowLut = false;
    fill(PEL_SLOT_THICKNESS, 1, [&](size_t i) { return Vec3{in_.row(i)[15], 0, 0}; });
    for (float& c : frame_.materials[1].deepScatterColor) c = 1;
    EXPECT_LE(worst(run(), 23, 1), tolerance::faceWorksPass + 0x1p-16);
}

// The taps lie elsewhere in the same disk.
TEST_F(ShadeFaceWorks, ThicknessOnAverage) {
    fill(PEL_SLOT_NORMAL_SHADING, 3, [](size_t) { return Vec3{0, 0, 1}; });
    fill(PEL_SLOT_POSITION, 3, [&](size_t i) { return in(i, 16); });
    frame_.curvatureLut = frame_.shadowLut = false;
    frame_.lights[0].map.components = 1;
    frame_.lights[0].mapSize = 256;
    frame_.lights[0].map.values = depth_.data;
    PelMaterial& m = frame_.materials[1];
    m.deepScatterColor[0] = 1;
    m.deepScatterNormalOffset = 0;
    for (const bool perspective : {false, true}) {
        PelLight& l = frame_.lights[0].params;
        l.shadowProjection = perspective ? PEL_SHADOW_PERSPECTIVE : PEL_SHADOW_PARALLEL;
        l.shadowDepthRange = 300;
        l.shadowDepthA = -0.0075f;
        l.shadowDepthB = 0.01f;
        for (const int taps : {8, 32}) {
            m.thicknessTaps = uint32_t(taps);
            const auto ours = run(true);
            const int column = 19 + 2 * perspective + (taps == 32);
            double sum = 0, theirs = 0, apart = 0;
            for (size_t i = 0; i < frame_.pixels(); ++i) {
                sum += ours[i];
                theirs += out_.row(i)[column];
                apart += std::pow(ours[i] - out_.row(i)[column], 2);
            }
            EXPECT_NEAR(sum / theirs, 1, tolerance::faceWorksTapsMean) << taps;
            EXPECT_LT(std::sqrt(apart / double(frame_.pixels())),
                      tolerance::faceWorksTapsRms * theirs / double(frame_.pixels()));
            std::printf("%d taps, %s: mean %.5f of FaceWorks', RMS difference %.4f of it\n", taps,
                        perspective ? "perspective" : "parallel", sum / theirs,
                        std::sqrt(apart / double(frame_.pixels())) / (theirs / double(frame_.pixels())));
        }
    }
}

}  // namespace
