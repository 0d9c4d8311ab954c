// PelShaderOptions.regionX to regionHeight: the bits of cropped images, no effect outside, and neither memory
// nor programs for another size.
#include "cl/cl_spy.h"
#include "device_lanes.h"
#include "scattering_frame.h"

using namespace shade_test;
using pellucid::Profile;

namespace {

constexpr uint32_t width = 160, height = 96;

struct Region {
    uint32_t x, y, width, height;
};
constexpr Region regions[] = {{33, 17, 96, 64}, {0, 0, width, height}, {63, 0, 97, 41}, {0, 55, 71, 41},
                              {80, 13, 1, 70},  {21, 60, 120, 1},      {50, 50, 1, 1}};

void setRegion(PelShaderOptions& options, Region r) {
    options.regionX = r.x, options.regionY = r.y, options.regionWidth = r.width,
    options.regionHeight = r.height;
}

Image cropped(const Image& image, Region r) {
    Image part{image.components, {}};
    for (uint32_t y = r.y; !image.values.empty() && y < r.y + r.height; ++y) {
        const float* row = &image.values[(size_t(y) * width + r.x) * image.components];
        part.values.insert(part.values.end(), row, row + size_t(r.width) * image.components);
    }
    return part;
}
Frame cropped(const Frame& f, Region r) {
    Frame part = f;
    part.width = r.width, part.height = r.height;
    for (Image& image : part.slots) image = cropped(image, r);
    for (Light& light : part.lights) light.wide = cropped(light.wide, r);
    return part;
}

// A device and its tables.
struct Place {
    Device device;
    Tables tables = makeTables(device, 12, 7);
};
const Place& usual() {
    static const Place place{device()};
    return place;
}
using Change = std::function<void(const Place&, Shader&)>;

// A shader of a frame, with outputs over threes.
struct ShadedImages {
    ShadedImages(const Place& on, const Frame& f, const Change& change, bool padded = false)
        : frame(f), shader(on.device) {
        setFrame(on.device, shader, f, on.tables, padded);
        for (const auto slot : slots) {
            const uint32_t components = slot == PEL_SLOT_OUT_THICKNESS ? 1 : 3;
            targets.emplace_back(on.device, std::vector<float>(f.pixels() * components, 3));
            shader.set(slot, imageDesc(targets.back(), floatFormats[components], f.width, f.height));
        }
        change(on, shader);
    }
    void fill() const {
        for (const Buffer& target : targets) {
            const std::vector<float> threes(target.bytes() / sizeof(float), 3);
            target.write(threes.data(), target.bytes());
        }
    }
    static constexpr PelImageSlot slots[] = {PEL_SLOT_RADIANCE, PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_SPECULAR,
                                             PEL_SLOT_OUT_THICKNESS};
    const Frame& frame;
    Shader shader;
    std::vector<Buffer> targets;
};

// Each region in turn by one shader. `padded`: the cropped frame has room between pixels and rows.
void expectCropped(
    const Place& on, const Frame& f, const Change& change = [](const Place&, Shader&) {},
    bool padded = true) {
    const ShadedImages whole(on, f, change);
    for (const Region& r : regions) {
        SCOPED_TRACE(testing::Message() << r.width << " x " << r.height << " from " << r.x << ", " << r.y
                                        << ", method " << f.materials.at(1).scattering);
        PelShaderOptions options = f.options;
        setRegion(options, r);
        whole.fill();
        Shader shader = whole.shader;
        shader.set(options).commit().execute();
        const Frame part = cropped(f, r);
        const ShadedImages alone(on, part, change, padded);
        Shader other = alone.shader;
        other.commit().execute();
        for (size_t k = 0; k < whole.targets.size(); ++k) {
            Image all{uint32_t(k == 3 ? 1 : 3), whole.targets[k].readAll<float>()};
            EXPECT_EQ(cropped(all, r).values, alone.targets[k].readAll<float>()) << ShadedImages::slots[k];
            // Nothing outside.
            for (uint32_t y = r.y; y < r.y + r.height; ++y)
                std::fill_n(&all.values[(size_t(y) * width + r.x) * all.components],
                            size_t(r.width) * all.components, 3.0f);
            EXPECT_EQ(std::ranges::count(all.values, 3.0f), std::ptrdiff_t(all.values.size()))
                << ShadedImages::slots[k];
        }
    }
}

const Profile& skin() {
    static const Profile profile = Profile::skin();
    return profile;
}
Frame frameOf(PelScattering scattering) {
    Frame f = scatteringFrame(scattering, width, height);
    for (auto& [id, m] : f.materials) m.profile = skin().get(), m.specular = 0.3f;
    return f;
}
void setTextures(const Place& on, Shader& shader) {
    const Buffer texels(on.device, std::vector<float>(3 * 16 * 8, 0.5f));
    for (const uint32_t id : {1u, 2u})
        shader.setScatteredTexture(id, imageDesc(texels, PEL_FORMAT_RGB32F, 16, 8));
}

}  // namespace

TEST(Region, IsACroppedFrameForEveryMethod) {
    constexpr PelScattering methods[] = {
        PEL_SCATTERING_NONE,    PEL_SCATTERING_AUTO,          PEL_SCATTERING_SCREEN,   PEL_SCATTERING_LIGHT,
        PEL_SCATTERING_TEXTURE, PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_SEPARABLE};
    // Room between pixels and rows takes other programs.
    for (const auto scattering : methods)
        expectCropped(usual(), frameOf(scattering), setTextures, scattering == PEL_SCATTERING_AUTO);
    // The first two have no kernels of their own.
    const Place oneLane{lanes::deviceOf(1)};
    for (const auto scattering : std::span(methods).subspan(2))
        expectCropped(oneLane, frameOf(scattering), setTextures, false);
}

// What passes blur on the screen; shadows between pixels, wide shadow images, depth and its matrix.
TEST(Region, IsACroppedFrameForEveryPass) {
    Frame f = frameOf(PEL_SCATTERING_PREINTEGRATED);
    f.options = pelShaderOptionsDefaults();
    f.options.blurNormals = 1;
    expectCropped(usual(), f);
    f.lights[0].wide.components = 1;
    for (size_t i = 0; i < f.pixels(); ++i) f.lights[0].wide.values.push_back(float(i % 7) / 7);
    Image& depth = f.slots[PEL_SLOT_DEPTH];
    depth.components = 1;
    for (size_t i = 0; i < f.pixels(); ++i)
        depth.values.push_back(0.5f + 0.01f * f.slots[PEL_SLOT_POSITION].values[3 * i + 2]);
    f.slots[PEL_SLOT_POSITION] = {};
    const float rows[16] = {40, 0, 0, 40, 0, -24, 0, 24, 0, 0, 100, -50, 0, 0, 0, 1};
    std::copy_n(rows, 16, f.camera.inverseViewProjection);
    expectCropped(usual(), f);
}

TEST(Region, AnotherSizeTakesNoMemoryAndNoPrograms) {
    for (const auto scattering :
         {PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN, PEL_SCATTERING_LIGHT,
          PEL_SCATTERING_TEXTURE, PEL_SCATTERING_AUTO}) {
        SCOPED_TRACE(int(scattering));
        Frame f = frameOf(scattering);
        f.options.blurNormals = 1;
        const ShadedImages whole(usual(), f, setTextures);
        Shader shader = whole.shader;
        PelShaderOptions options = f.options;
        setRegion(options, {0, 0, width, height});
        const PelSubmit submit{nullptr, 0, nullptr};
        const auto shade = [&] { shader.set(options).commit().execute(&submit); };
        shade();
        const uint64_t programs = device().stats().programsBuilt;  // waits
        const spy::Counts before = spy::counts();
        for (uint32_t i = 0; i < 12; ++i) {
            const uint32_t w = width - 8 * i, h = height - 7 * i;
            setRegion(options, {i % 3 * 4 * i, i % 2 * 7 * i, w, h});
            shade();
        }
        const spy::Counts after = spy::counts();
        EXPECT_EQ(after.buffersMade, before.buffersMade);
        EXPECT_EQ(after.waits, before.waits);
        EXPECT_EQ(device().stats().programsBuilt, programs);
        // Without a region, memory that is not needed is freed.
        const uint64_t held = shader.stats().scratchBytes;
        shader.set(f.options).commit();
        EXPECT_LE(shader.stats().scratchBytes, held);
    }
}

TEST(Region, OutsideOfTheImagesIsRefused) {
    Frame f = frameOf(PEL_SCATTERING_NONE);
    const ShadedImages whole(usual(), f, setTextures);
    Shader shader = whole.shader;
    for (const Region r : {Region{0, 0, width + 1, 1},
                           {1, 0, width, 1},
                           {0, 1, 1, height},
                           {0, 0, 1, 0},
                           {UINT32_MAX, 0, 2, 2},
                           {0, UINT32_MAX, 2, 2}}) {
        setRegion(f.options, r);
        expectRefused({"region of PelShaderOptions", "160 x 96", "inside"},
                      [&] { shader.set(f.options).commit(); });
    }
    f.options.regionWidth = 0;
    shader.set(f.options).commit().execute();
}
