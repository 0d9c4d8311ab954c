// Variants of the shading kernel: few, and shared by equivalent shaders.
#include "shade_scene.h"
#include "test.h"

using namespace shade_test;

namespace {

// Programs that commits of these frames build on a device that has none. Frames are 16 x 1: the least that is
// read in vectors.
uint32_t programsOf(const std::vector<Frame>& frames) {
    const Device own("");
    PelLutInfo curvature = pelLutInfoDefaults(), shadow = curvature;
    shadow.kind = PEL_LUT_SHADOW;
    const std::vector<float> texels(curvature.curvature.width * curvature.curvature.height * 3, 0.5f);
    const Tables tables{pellucid::Lut(own, curvature, texels), pellucid::Lut(own, shadow, texels), {}, {}};
    for (const Frame& f : frames) shaderOf(f, own, tables).shader.commit();
    return own.stats().programsBuilt;
}

// Numbers, order, and unused inputs do not change the program.
TEST(ShadeVariants, EqualMeaningIsOneProgram) {
    std::vector<Frame> frames;
    const auto add = [&](auto change) {
        Frame f = randomFrame(1, 16, 1, 1);
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
    EXPECT_EQ(programsOf(frames), 2u) << "shading, and the classification of tiles";
    // The blurred normal matters to nothing here.
    std::vector<Frame> plain;
    for (Frame f : {frames[0], frames[0], frames[0]}) {
        f.curvatureLut = false;
        f.ambient = pelAmbientDefaults();
        if (plain.size() == 1) f.slots[PEL_SLOT_NORMAL_BLURRED] = {};
        if (plain.size() == 2) f.slots[PEL_SLOT_CURVATURE] = {};
        plain.push_back(f);
    }
    EXPECT_EQ(programsOf(plain), 2u);
    frames = {frames[0], frames[0]};
    frames[1].slots[PEL_SLOT_ALBEDO] = {};
    EXPECT_EQ(programsOf(frames), 3u) << "an input that is read";
    frames.resize(1);
    frames[0].options.tileLists = PEL_TILES_NO_LIST;
    EXPECT_EQ(programsOf(frames), 1u) << "nothing is classified";
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
    // The light's shadow, where the host's irradiance already has its light.
    f.materials[2].scattering = PEL_SCATTERING_NONE;
    f.slots[PEL_SLOT_IRRADIANCE] = {3, std::vector<float>(3 * f.pixels(), 0.5f)};
    const auto scattered = shade(f, nullptr, noTables);
    f.lights[0].wide.values[at] = std::nanf("");
    EXPECT_EQ(shade(f, nullptr, noTables), scattered);
    f.options.disableSkipping = 1;
    EXPECT_EQ(shade(f, nullptr, noTables), scattered);
}

}  // namespace
