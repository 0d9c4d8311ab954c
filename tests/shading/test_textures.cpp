// The host's textures as images: the same bits as with buffers, read and written at each execution.
#include <CL/cl.h>

#include "cl/cl_spy.h"
#include "diffusion/scatter_scene.h"
#include "shade_scene.h"
#include "test.h"

using namespace shade_test;

namespace {

// A texture of floats, whose texels hold `components` values of an image; three are four with a 7.
class Texture {
  public:
    Texture(const std::vector<float>& values, uint32_t components, uint32_t width, uint32_t height)
        : components_(components), across_(components == 3 ? 4 : components), width_(width), height_(height) {
        void *context = nullptr, *id = nullptr;
        pellucid::check(pelDeviceGetCl(device().get(), &context, &id, &queue_));
        const cl_channel_order order = across_ == 1 ? CL_R : across_ == 2 ? CL_RG : CL_RGBA;
        const cl_image_format format{order, CL_FLOAT};
        cl_image_desc desc{};
        desc.image_type = CL_MEM_OBJECT_IMAGE2D;
        desc.image_width = width, desc.image_height = height;
        cl_int error = CL_SUCCESS;
        image_ = clCreateImage(static_cast<cl_context>(context), CL_MEM_READ_WRITE, &format, &desc, nullptr,
                               &error);
        if (error) throw std::runtime_error("no texture of this format");
        write(values);
        buffer_ = Buffer::fromCl(device(), image_);
    }
    ~Texture() { clReleaseMemObject(image_); }
    Texture(const Texture&) = delete;
    Texture& operator=(const Texture&) = delete;

    PelImageDesc desc() const { return imageDesc(buffer_, floatFormats[across_], width_, height_); }
    void write(const std::vector<float>& values) {
        std::vector<float> texels(size_t(width_) * height_ * across_, 7);
        for (size_t i = 0; i < values.size(); ++i)
            texels[i / components_ * across_ + i % components_] = values[i];
        transfer(clEnqueueWriteImage, texels.data());
    }
    std::vector<float> texels() const {
        std::vector<float> values(size_t(width_) * height_ * across_);
        transfer(clEnqueueReadImage, values.data());
        return values;
    }

  private:
    template <class Call>
    void transfer(const Call& call, float* values) const {
        const size_t origin[3] = {}, size[3] = {width_, height_, 1};
        ASSERT_EQ(call(static_cast<cl_command_queue>(queue_), image_, CL_TRUE, origin, size, 0, 0, values, 0,
                       nullptr, nullptr),
                  CL_SUCCESS);
    }
    uint32_t components_, across_, width_, height_;  // across: floats of a texel
    void* queue_ = nullptr;
    cl_mem image_ = nullptr;
    Buffer buffer_;
};

Vec3 halfLit(double x, double) {
    return x < 30 ? Vec3{1, 1, 1} : Vec3{0.1, 0.1, 0.1};
}

}  // namespace

TEST(Textures, GiveTheBitsOfBuffers) {
    Frame f = randomFrame(3, 70, 40, 2);
    FrameShader made = shaderOf(f);
    Shader& buffers = made.shader;
    const Buffer& target = made.target;
    const std::vector<float> threes(3 * f.pixels(), 3);
    target.write(threes.data(), target.bytes());
    buffers.commit().execute();

    Shader shader(device());
    setFrame(device(), shader, f, tables());
    std::vector<std::unique_ptr<Texture>> textures;
    const auto texture = [&](const std::vector<float>& values, uint32_t components, uint32_t w, uint32_t h) {
        return textures.emplace_back(std::make_unique<Texture>(values, components, w, h))->desc();
    };
    for (int slot = 1; slot < PEL_SLOT_COUNT; ++slot)
        if (const Image& image = f.slots[slot]; !image.values.empty())
            shader.set(PelImageSlot(slot), texture(image.values, image.components, f.width, f.height));
    for (uint32_t i = 0; i < f.lights.size(); ++i) {
        const Light& light = f.lights[i];
        shader.set(i, PEL_LIGHT_WIDE_SHADOW, texture(light.wide.values, 1, f.width, f.height));
        shader.set(i, PEL_LIGHT_SHADOW_MAP, texture(light.map.values, 1, light.mapSize, light.mapSize));
    }
    Texture radiance(threes, 3, f.width, f.height), diffuse(threes, 3, f.width, f.height);
    shader.set(PEL_SLOT_RADIANCE, radiance.desc()).set(PEL_SLOT_OUT_DIFFUSE, diffuse.desc()).commit();
    const spy::Counts before = spy::counts();
    const PelSubmit submit{nullptr, 0, nullptr};
    shader.execute(&submit);
    EXPECT_EQ(spy::counts().waits, before.waits);
    EXPECT_EQ(spy::counts().buffersMade, before.buffersMade);

    const auto expectSame = [&] {
        const std::vector<float> texels = radiance.texels();
        std::vector<float> colors;
        for (size_t i = 0; i < texels.size(); ++i) {
            if (i % 4 < 3) colors.push_back(texels[i]);
            if (i % 4 == 3) {
                EXPECT_EQ(texels[i], texels[3]);
            }
        }
        expectSameBits(device(), colors, target.readAll<float>());
    };
    expectSame();
    EXPECT_NE(diffuse.texels()[4 * 20 * 70 + 4 * 35], 7);

    // What the textures hold at the next execution.
    for (float& a : f.slots[PEL_SLOT_ALBEDO].values) a = 1 - a;
    const Buffer albedo(device(), f.slots[PEL_SLOT_ALBEDO].values);
    buffers.set(PEL_SLOT_ALBEDO, imageDesc(albedo, PEL_FORMAT_RGB32F, f.width, f.height)).commit().execute();
    size_t at = 0;
    for (int slot = 1; slot < PEL_SLOT_ALBEDO; ++slot) at += !f.slots[slot].values.empty();
    textures[at]->write(f.slots[PEL_SLOT_ALBEDO].values);
    shader.execute();
    expectSame();
}

// A map is copied when the number of its content changes, or in each frame where it has none.
TEST(Textures, OfMapsThatRestAreKept) {
    Frame f = randomFrame(3, 40, 24, 1);
    Light& light = f.lights[0];
    FrameShader made = shaderOf(f);
    Shader& shader = made.shader;
    Texture map(light.map.values, 1, light.mapSize, light.mapSize);
    const std::vector<float> lit(light.map.values.size(), 1);
    shader.set(0, PEL_LIGHT_WIDE_SHADOW, nullptr).set(0, PEL_LIGHT_SHADOW_MAP, map.desc());
    const auto shaded = [&](uint32_t version, const std::vector<float>& texels) {
        map.write(texels);
        light.params.shadowMapVersion = version;
        shader.set(std::vector<PelLight>{light.params}).commit().execute();
        return made.target.readAll<float>();
    };
    const std::vector<float> first = shaded(0, light.map.values), other = shaded(0, lit);
    EXPECT_NE(first, other);
    EXPECT_EQ(shaded(1, light.map.values), first);
    EXPECT_EQ(shaded(1, lit), first);
    EXPECT_EQ(shaded(2, lit), other);
    EXPECT_EQ(shaded(0, light.map.values), first);
}

// Irradiance that a pass replaces by what it scatters is still read from its texture.
TEST(Textures, AreReadWhereAPassPutsAnotherImage) {
    const scatter_scene::Frame f(scatter_scene::plane(64, 32, 1, halfLit), PEL_SCATTERING_SCREEN);
    scatter_scene::Frame dark = f;
    std::ranges::fill(dark.picture.irradiance, 0.0f);
    scatter_scene::ShownImages shown(device(), 1, 1);
    dark.shade(shown);
    Texture texture(f.picture.irradiance, 3, 64, 32);
    shown.shader.set(PEL_SLOT_IRRADIANCE, texture.desc());
    EXPECT_EQ(shown.execute(), f.shade().light);
}

TEST(Textures, OfOtherKindsAreRefused) {
    void *context = nullptr, *id = nullptr, *queue = nullptr;
    pellucid::check(pelDeviceGetCl(device().get(), &context, &id, &queue));
    const cl_image_format format{CL_RGBA, CL_FLOAT};
    cl_image_desc desc{};
    desc.image_type = CL_MEM_OBJECT_IMAGE3D;
    desc.image_width = desc.image_height = desc.image_depth = 4;
    cl_int error = CL_SUCCESS;
    const cl_mem image =
        clCreateImage(static_cast<cl_context>(context), CL_MEM_READ_ONLY, &format, &desc, nullptr, &error);
    if (error) GTEST_SKIP() << "the device has no 3D images";
    expectRefused("another kind than image2d", [&] { Buffer::fromCl(device(), image); });
    clReleaseMemObject(image);
    // As large as the image that is described.
    Texture texture(std::vector<float>(16, 1), 1, 4, 4);
    PelImageDesc larger = texture.desc();
    larger.height = 5;
    Shader shader(device());
    expectRefused("of a buffer of 64", [&] { shader.set(PEL_SLOT_CURVATURE, larger); });
}

TEST(Textures, OfAPelScatter) {
    const scatter_scene::Picture p = scatter_scene::plane(60, 32, 1, halfLit);
    const std::vector<float> expected = scatter_scene::run(p, pellucid::Profile::skin()).scattered;
    EXPECT_NE(expected, p.irradiance);
    const Texture irradiance(p.irradiance, 3, p.width, p.height),
        positions(p.positions, 3, p.width, p.height),
        result(std::vector<float>(p.irradiance.size(), 5), 3, p.width, p.height);
    pellucid::Scatter scatter(device());
    scatter.setMaterial(1, pellucid::Profile::skin(), 1);
    const PelImageDesc places = positions.desc();
    scatter.execute(p.params, irradiance.desc(), &places, nullptr, nullptr, result.desc());
    device().finish();
    const std::vector<float> texels = result.texels();
    for (size_t i = 0; i < p.pixels(); ++i)
        for (size_t c = 0; c < 3; ++c) ASSERT_EQ(texels[4 * i + c], expected[3 * i + c]) << i;
}
