// Variants of the shading kernel: few, equal for shaders that mean the same.
//
// This program defines clBuildProgram itself, which is linked before libOpenCL's: it counts programs without
// compiling them.
#include <CL/cl.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>

#include "shade_scene.h"

using namespace shade_test;

namespace {
std::atomic<bool> pretend{false};
}

extern "C" {
#pragma GCC visibility push(default)
cl_int clBuildProgram(cl_program program, cl_uint count, const cl_device_id* devices, const char* options,
                      void (*notify)(cl_program, void*), void* user) {
    if (pretend) return CL_SUCCESS;
    return reinterpret_cast<decltype(clBuildProgram)*>(dlsym(RTLD_NEXT, "clBuildProgram"))(
        program, count, devices, options, notify, user);
}
#pragma GCC visibility pop
}

namespace {

// Programs that commits of these frames build on a device that has none. Frames are 16 x 1: the least that is
// read in vectors.
uint32_t programsOf(const std::vector<Frame>& frames) {
    const Device own("");
    PelLutInfo curvature = pelLutInfoDefaults(), shadow = curvature;
    shadow.kind = PEL_LUT_SHADOW;
    const std::vector<float> texels(curvature.curvature.width * curvature.curvature.height * 3, 0.5f);
    const Tables tables{pellucid::Lut(own, curvature, texels), pellucid::Lut(own, shadow, texels), {}, {}};
    pretend = true;
    for (const Frame& f : frames) {
        Shader shader(own);
        setFrame(own, shader, f, tables);
        const auto target = setTarget(own, shader, f);
        shader.commit();
    }
    pretend = false;
    PelDeviceStats stats = pelDeviceStatsDefaults();
    pellucid::check(pelDeviceGetStats(own.get(), &stats));
    return stats.programsBuilt;
}

Frame small(uint32_t lights = 1) {
    return randomFrame(1, 16, 1, lights);
}

// All scenes of a host with one kind of G-buffer: each combination of what may be there or not, with other
// numbers, lights and materials for each.
TEST(ShadeVariants, FewAreReached) {
    std::vector<Frame> frames;
    for (int choice = 0; choice < 2 * 3 * 2 * 4 * 3 * 2; ++choice)
        for (int number = 0; number < 4; ++number) {
            int rest = choice;
            const auto next = [&](int count) { return std::exchange(rest, rest / count) % count; };
            const int curvature = next(2), shadow = next(3), ambient = next(2), deep = next(4),
                      specular = next(3), positional = next(2);
            Frame f = small(1 + uint32_t(number));
            f.curvatureLut = curvature;
            f.shadowLut = shadow == 2;
            for (size_t i = 0; i < f.lights.size(); ++i) {
                PelLight& l = f.lights[i].params;
                l.type = positional ? PelLightType(1 + i % 2) : PEL_LIGHT_DIRECTIONAL;
                l.color[0] = 0.1f + 0.2f * float(number);
                if (!shadow || (number == 2 && i > 0)) f.lights[i].wide = {};
            }
            if (!ambient) f.ambient = pelAmbientDefaults();
            if (deep >= 2) f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_CURVATURE];  // 1: taps
            if (number == 3) f.materials.erase(7), f.materials[99] = f.materials[2];
            for (auto& [id, m] : f.materials) {
                if (number == 1) m.diffusionRadius = m.roughness = 0.5f * float(id + 1);
                m.thicknessTaps = 8u << (uint32_t(number) + id) % 3;
                m.specular *= float(specular > 0);
                m.specularModel = specular == 2 ? PEL_SPECULAR_GGX : PEL_SPECULAR_KSK;
                m.deepScatterAmbient = deep == 3 ? 0.2f * float(id) : 0.0f;
                if (!deep)
                    for (float& c : m.deepScatterColor) c = 0;
            }
            frames.push_back(f);
        }
    const uint32_t programs = programsOf(frames);
    std::printf("%zu scenes, %u programs\n", frames.size(), programs);
    // Curvature 2 x shadow 3 x ambient 2 x deep scatter 3 x specular 3 x positional 2, and ambient scatter
    // where there is ambient light: another 2 x 3 x 3 x 2.
    EXPECT_EQ(frames.size(), 1152u);
    EXPECT_LE(programs, 252u);
    EXPECT_GE(programs, 200u) << "they are not all the same either";
    // What one scene changes from frame to frame reaches one of them.
    std::vector<Frame> one;
    for (size_t i = 0; i < frames.size(); ++i)
        if (i / 4 == 201 && i % 4 != 2) one.push_back(frames[i]);
    EXPECT_EQ(programsOf(one), 1u);
}

// Numbers, order, and inputs that nothing reads make no other program.
TEST(ShadeVariants, EqualMeaningIsOneProgram) {
    std::vector<Frame> frames;
    const auto add = [&](auto change) {
        Frame f = small();
        f.shadowLut = false;
        f.lights[0].params.type = PEL_LIGHT_DIRECTIONAL;
        for (auto& [id, m] : f.materials) {
            m.specular = 0;
            for (float& c : m.deepScatterColor) c = 0;
        }
        change(f);
        frames.push_back(f);
    };
    add([](Frame&) {});
    add([](Frame& f) { f.materials.erase(2); });
    add([](Frame& f) { f.materials[200] = f.materials[1]; });
    add([](Frame& f) { f.materials[1].diffusionRadius = 1; });
    add([](Frame& f) { f.materials[1].thicknessTaps = 0; });
    add([](Frame& f) { f.materials[1].specularModel = PEL_SPECULAR_GGX; });  // of a specular of 0
    add([](Frame& f) { f.materials[1].deepScatterAmbient = 1; });            // of a black colour
    add([](Frame& f) { f.lights[0].params.color[1] = 7; });
    add([](Frame& f) { f.lights.push_back(f.lights[0]); });
    add([](Frame& f) { f.lights[0].map = {}; });  // no taps read it
    add([](Frame& f) {
        f.lights[0].params.shadowProjection = PEL_SHADOW_PERSPECTIVE, f.lights[0].params.shadowDepthA = 1;
    });
    for (const PelImageSlot unread :
         {PEL_SLOT_POSITION, PEL_SLOT_ROUGHNESS, PEL_SLOT_SPECULAR, PEL_SLOT_NORMAL_GEOMETRIC})
        add([=](Frame& f) { f.slots[unread] = {}; });
    add([](Frame& f) { f.slots[PEL_SLOT_THICKNESS] = f.slots[PEL_SLOT_CURVATURE]; });
    add([](Frame& f) { f.slots[PEL_SLOT_DEPTH] = f.slots[PEL_SLOT_CURVATURE]; });
    add([](Frame& f) { f.options.invalidColor[0] = 1; });
    add([](Frame& f) { f.options.scratchBudget = 1 << 20; });
    add([](Frame& f) { f.options.tileLists = PEL_TILES_NO_LIST; });
    add([](Frame& f) { f.options.rotateTaps = 1; });  // of taps that nothing takes
    EXPECT_EQ(programsOf(frames), 1u);
    // The blurred normal matters to nothing here.
    std::vector<Frame> plain;
    for (Frame f : {frames[0], frames[0], frames[0]}) {
        f.curvatureLut = false;
        f.ambient = pelAmbientDefaults();
        if (plain.size() == 1) f.slots[PEL_SLOT_NORMAL_BLURRED] = {};
        if (plain.size() == 2) f.slots[PEL_SLOT_CURVATURE] = {};
        plain.push_back(f);
    }
    EXPECT_EQ(programsOf(plain), 1u);
    frames = {frames[0], frames[0]};
    frames[1].slots[PEL_SLOT_ALBEDO] = {};
    EXPECT_EQ(programsOf(frames), 2u) << "an input that is read";
}

// NaN in an image that the pixel's material does not read does not make the pixel invalid.
TEST(ShadeVariants, InputsThatAMaterialDoesNotReadMayBeNan) {
    Frame f = randomFrame(3, 64, 4, 1);
    for (float& id : f.slots[PEL_SLOT_MATERIAL].values) id = 1;
    f.materials[2].specular = 0;
    for (float& c : f.materials[2].deepScatterColor) c = 0;
    f.lights[0].params.type = PEL_LIGHT_DIRECTIONAL;
    const size_t at = 2 * 64 + 33;
    f.slots[PEL_SLOT_MATERIAL].values[at] = 2;  // amid skin
    // Curvature and deep scatter with skin only: setFrame gives all materials the tables.
    const auto noTables = [&](Shader& shader) { shader.setMaterial(2, f.materials.at(2)); };
    const auto right = shade(f, nullptr, noTables);
    for (const PelImageSlot unread :
         {PEL_SLOT_POSITION, PEL_SLOT_CURVATURE, PEL_SLOT_ROUGHNESS, PEL_SLOT_SPECULAR}) {
        Image& image = f.slots[unread];
        for (uint32_t c = 0; c < image.components; ++c)
            image.values[at * image.components + c] = std::nanf("");
    }
    EXPECT_EQ(shade(f, nullptr, noTables), right);
}

// A frame without skin: the ids are read, and nothing else is done.
TEST(ShadeVariants, AFrameWithoutMaterialsCostsOneClassification) {
    Frame f = randomFrame(4, 700, 40, 2);
    f.options.countPixels = 1;
    for (float& id : f.slots[PEL_SLOT_MATERIAL].values) id = 0;
    for (int slot = PEL_SLOT_POSITION; slot < PEL_SLOT_OUT_DIFFUSE; ++slot)
        for (float& v : f.slots[slot].values) v = std::nanf("");
    f.options.tileLists = PEL_TILES_ONE_LIST;
    PelShaderStats stats = pelShaderStatsDefaults();
    for (float v : shade(f, &stats)) ASSERT_EQ(v, 0);
    EXPECT_EQ(stats.launches, 2u) << "the classification, and the kernel that finds its list empty";
    EXPECT_EQ(stats.tilesShaded, 0u);
    for (const uint64_t touched : {stats.pixelsShaded, stats.pixelsShadowLut, stats.pixelsThickness,
                                   stats.pixelsSpecular, stats.pixelsInvalid, stats.pixelsWideShadow})
        EXPECT_EQ(touched, 0u);
}

}  // namespace
