// What the controls of scattering accept, and what is wrong with the others.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <pellucid/pellucid.hpp>
#include <string>

namespace {

using namespace pellucid;

const Device& device() {
    static const Device device("");
    return device;
}

// The message of what `call` throws; "" if it throws nothing.
std::string errorOf(const std::function<void()>& call, PelError code = PEL_ERROR_INVALID_ARGUMENT) {
    try {
        call();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        return e.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

using Change = std::function<void(PelMaterial&)>;
std::string materialError(const Change& change) {
    PelMaterial material = pelMaterialDefaults();
    change(material);
    return errorOf([&] { Shader(device()).setMaterial(1, material); });
}

PelImageDesc image(PelFormat format, size_t pixelBytes) {
    PelImageDesc desc = pelImageDescDefaults();
    static const Buffer buffer(device(), 256);
    desc.buffer = buffer.get();
    desc.format = format;
    desc.width = desc.height = 4;
    desc.pixelStride = pixelBytes;
    return desc;
}

}  // namespace

TEST(ScatterControls, OfMaterialsAreChecked) {
    EXPECT_EQ(materialError([](PelMaterial& m) { m.scatterTaps = 8; }), "");
    EXPECT_EQ(materialError([](PelMaterial& m) { m.scatterTaps = 256; }), "");
    EXPECT_TRUE(contains(materialError([](PelMaterial& m) { m.scatterTaps = 7; }), "scatterTaps is 7"));
    EXPECT_TRUE(contains(materialError([](PelMaterial& m) { m.scatterTaps = 257; }), "scatterTaps is 257"));
    for (float bad : {-0.1f, 1.5f, NAN, INFINITY}) {
        EXPECT_TRUE(contains(materialError([&](PelMaterial& m) { m.albedoBefore = bad; }), "albedoBefore"));
        EXPECT_TRUE(contains(materialError([&](PelMaterial& m) { m.borderColor[2] = bad; }), "borderColor"));
    }
    for (float bad : {-1.0f, NAN, INFINITY})
        EXPECT_TRUE(contains(materialError([&](PelMaterial& m) { m.thinThickness = bad; }), "thinThickness"));
}

TEST(ScatterControls, OfAPelScatterAreChecked) {
    Scatter scatter(device());
    PelScatterControls controls = pelScatterControlsDefaults();
    EXPECT_TRUE(contains(errorOf([&] { scatter.setControls(1, controls); }), "material 1 is not set"));
    scatter.setMaterial(1, Profile::skin());
    scatter.setControls(1, controls);
    controls.scattering = PEL_SCATTERING_LIGHT;
    EXPECT_TRUE(contains(errorOf([&] { scatter.setControls(1, controls); }), "PEL_SCATTERING_SEPARABLE"));
    controls = pelScatterControlsDefaults();
    controls.scatterTaps = 300;
    EXPECT_TRUE(contains(errorOf([&] { scatter.setControls(1, controls); }), "scatterTaps is 300"));
    controls = pelScatterControlsDefaults();
    controls.thinThickness = NAN;
    EXPECT_TRUE(contains(errorOf([&] { scatter.setControls(1, controls); }), "thinThickness"));
    EXPECT_TRUE(contains(errorOf([&] { scatter.set(PEL_SLOT_CURVATURE, image(PEL_FORMAT_R32F, 4)); }),
                         "none that a PelScatter keeps"));
    EXPECT_TRUE(
        contains(errorOf([&] { scatter.set(PEL_SLOT_ALBEDO, image(PEL_FORMAT_R32F, 4)); }), "albedo"));
    scatter.clear(PEL_SLOT_ALBEDO);
}

TEST(ScatterControls, ScatteredTexturesAreOfMaterialsAndColours) {
    Shader shader(device());
    EXPECT_TRUE(contains(errorOf([&] { shader.setScatteredTexture(3, image(PEL_FORMAT_RGB32F, 12)); }),
                         "material 3 is not set"));
    shader.setMaterial(3, pelMaterialDefaults());
    shader.setScatteredTexture(3, image(PEL_FORMAT_RGB32F, 12));
    shader.clearScatteredTexture(3);
    EXPECT_TRUE(contains(errorOf([&] { shader.setScatteredTexture(3, image(PEL_FORMAT_R32F, 4)); }),
                         "scattered texture"));
}

TEST(ScatterControls, TextureScattersMeshIsChecked) {
    const float uvs[] = {0, 0, 1, 0, 0, 1};
    const uint32_t triangle[] = {0, 1, 2}, beyond[] = {0, 1, 3};
    PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
    const auto error = [&] { return errorOf([&] { TextureScatter(device(), desc); }); };
    EXPECT_TRUE(contains(error(), "0 x 0 texels"));
    desc.width = 8, desc.height = 4;
    EXPECT_EQ(error(), "");
    desc.numVertices = 3, desc.numIndices = 3;
    EXPECT_TRUE(contains(error(), "indices is NULL"));
    desc.indices = triangle;
    EXPECT_TRUE(contains(error(), "uvs is NULL"));
    desc.uvs = uvs;
    EXPECT_EQ(error(), "");
    EXPECT_EQ(TextureScatter(device(), desc).stats().texelsTotal, 32u);
    desc.uvStride = 4;
    EXPECT_TRUE(contains(error(), "uvStride is 4"));
    desc.uvStride = 0;
    desc.numIndices = 2;
    EXPECT_TRUE(contains(error(), "no multiple of 3"));
    desc.numIndices = 3, desc.indices = beyond;
    EXPECT_TRUE(contains(error(), "triangle 0 has the vertex 3 of 3"));
    const float far[] = {0, 0, 1, 0, 0, NAN};
    desc.indices = triangle, desc.uvs = far;
    EXPECT_TRUE(contains(error(), "vertex 2 has the texture coordinates"));
}
