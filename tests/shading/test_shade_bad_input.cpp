// What a shader refuses, and what the messages say.
#include <cstring>
#include <limits>

#include "cl/cl_spy.h"
#include "shader_ready.h"

using namespace shade_test;
using pellucid::Buffer;
using pellucid::imageDesc;
using pellucid::Shader;

namespace {

constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();

TEST(ShadeBadInput, ExecuteNeedsACommit) {
    Ready r;
    expectError(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { r.shader.execute(); });
    r.shader.commit().execute();
    r.shader.set(r.frame.ambient);
    expectError(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { r.shader.execute(); });
    r.shader.commit().execute();
}

TEST(ShadeBadInput, ExecuteNeedsACommitAfterWhateverIsSet) {
    Ready r;
    pellucid::Shader& s = r.shader;
    const Buffer texels(device(), std::vector<float>(6 * 4 * 4 * 3, 0.5f));
    const std::function<void()> setters[] = {
        [&] { s.set(r.frame.options); },
        [&] { s.set(PEL_SLOT_RADIANCE, imageDesc(r.target, PEL_FORMAT_RGB32F, 32, 16)); },
        [&] { pellucid::check(pelShaderSetImage(s.get(), PEL_SLOT_AMBIENT_OCCLUSION, nullptr)); },
        [&] { s.setMaterial(1, r.frame.materials.at(1), tables().curvature, tables().shadow); },
        [&] { pellucid::check(pelShaderSetMaterial(s.get(), 9, nullptr, nullptr, nullptr)); },
        [&] { s.setNormalMap(1, {}); },
        [&] { s.set(std::vector<PelLight>{r.frame.lights[0].params}); },
        [&] { pellucid::check(pelShaderSetLightImage(s.get(), 0, PEL_LIGHT_WIDE_SHADOW, nullptr)); },
        [&] { s.set(r.frame.ambient); },
        [&] { s.setAmbientCube(imageDesc(texels, PEL_FORMAT_RGB32F, 4, 24)); },
        [&] { pellucid::check(pelShaderSetAmbientCube(s.get(), nullptr)); },
        [&] { s.set(r.frame.camera); }};
    s.commit().execute();
    for (size_t i = 0; i < std::size(setters); ++i) {
        SCOPED_TRACE("setter " + std::to_string(i));
        setters[i]();
        expectError(PEL_ERROR_INVALID_STATE, {"pelShaderCommit"}, [&] { s.execute(); });
        s.commit().execute();
    }
}

TEST(ShadeBadInput, ImagesThatDoNotFit) {
    Ready r;
    const Buffer buffer(device(), 32 * 16 * 16);
    const auto image = [&](PelFormat format) { return imageDesc(buffer, format, 32, 16); };
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    expectError(invalid, {"albedo", "R32F", "three components"},
                [&] { r.shader.set(PEL_SLOT_ALBEDO, image(PEL_FORMAT_R32F)); });
    expectError(invalid, {"radiance", "RGBA8_UNORM", "RGB or RGBA"},
                [&] { r.shader.set(PEL_SLOT_RADIANCE, image(PEL_FORMAT_RGBA8_UNORM)); });
    expectError(invalid, {"shading normal", "RGBA8_SRGB"},
                [&] { r.shader.set(PEL_SLOT_NORMAL_SHADING, image(PEL_FORMAT_RGBA8_SRGB)); });
    expectError(invalid, {"material", "R8_UNORM", "uint"},
                [&] { r.shader.set(PEL_SLOT_MATERIAL, image(PEL_FORMAT_R8_UNORM)); });
    expectError(invalid, {"wide shadow", "R32_UINT"},
                [&] { r.shader.set(0, PEL_LIGHT_WIDE_SHADOW, image(PEL_FORMAT_R32_UINT)); });
    expectError(invalid, {"format 99"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, image(PelFormat(99))); });
    expectError(invalid, {"slot 77"}, [&] { r.shader.set(PelImageSlot(77), image(PEL_FORMAT_R32F)); });
    expectError(invalid, {"light 3"}, [&] { r.shader.set(3, PEL_LIGHT_SHADOW_MAP, image(PEL_FORMAT_R32F)); });

    PelImageDesc desc = image(PEL_FORMAT_RGB32F);
    desc.width = 0;
    expectError(invalid, {"0 x 16"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_RGB32F);
    desc.height = 20000;
    expectError(invalid, {"32 x 20000"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_RGBA32F);
    desc.byteOffset = 4;
    expectError(invalid, {"albedo", "ends at byte"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_R32F);
    desc.byteOffset = 2;
    expectError(invalid, {"byteOffset", "multiple of 4"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    desc = image(PEL_FORMAT_RGB32F);
    desc.pixelStride = 8;
    expectError(invalid, {"pixelStride", "12 bytes"}, [&] { r.shader.set(PEL_SLOT_ALBEDO, desc); });
    desc = image(PEL_FORMAT_R32F);
    desc.rowStride = 64;
    expectError(invalid, {"rowStride", "128"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    desc.rowStride = uint64_t(1) << 62;
    expectError(invalid, {"rowStride"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    desc = image(PEL_FORMAT_R32F);
    desc.buffer = nullptr;
    expectError(invalid, {"PelBuffer"}, [&] { r.shader.set(PEL_SLOT_CURVATURE, desc); });
    const pellucid::Device other("");
    expectError(invalid, {"another PelDevice"}, [&] {
        r.shader.set(PEL_SLOT_CURVATURE, imageDesc(Buffer(other, 4096), PEL_FORMAT_R32F, 32, 16));
    });
    // The refused calls changed nothing.
    r.shader.commit().execute();
    EXPECT_EQ(r.target.readAll<float>(), shade(device(), r.frame, tables()));
}

TEST(ShadeBadInput, WhatCommitMisses) {
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    const auto commit = [](Ready& r) { return [&r] { r.shader.commit(); }; };
    {
        Ready r;
        r.shader.set(PEL_SLOT_ALBEDO, imageDesc(Buffer(device(), 4800), PEL_FORMAT_RGB32F, 20, 20));
        expectError(invalid, {"albedo", "20 x 20", "32 x 16"}, commit(r));
    }
    for (const auto& [slot, word] : {std::pair{PEL_SLOT_RADIANCE, "radiance"},
                                     {PEL_SLOT_NORMAL_SHADING, "shading normal"},
                                     {PEL_SLOT_POSITION, "position"}}) {
        Ready r;
        r.shader.clear(slot);
        expectError(invalid, {word, "needed"}, commit(r));
    }
    {
        Ready r;
        for (uint32_t id : {1, 2, 7})
            pellucid::check(pelShaderSetMaterial(r.shader.get(), id, nullptr, nullptr, nullptr));
        expectError(invalid, {"no material"}, commit(r));
        r.shader.setMaterial(9, fixture::faceworksMaterial());
        r.shader.clear(PEL_SLOT_MATERIAL);
        expectError(invalid, {"material 1"}, commit(r));
    }
    {
        Ready r;
        PelLight light = r.frame.lights[0].params;
        light.shadowDepthRange = 0;
        r.shader.set({light});
        expectError(invalid, {"shadowDepthRange"}, commit(r));
        light = r.frame.lights[0].params;
        light.shadowProjection = PEL_SHADOW_PERSPECTIVE;
        r.shader.set({light});
        expectError(invalid, {"shadowDepthA"}, commit(r));
    }
    {
        Ready r;
        r.shader.set({r.frame.lights[0].params, r.frame.lights[0].params});
        r.shader.set(1, PEL_LIGHT_WIDE_SHADOW,
                     imageDesc(Buffer(device(), 32 * 16), PEL_FORMAT_R8_UNORM, 32, 16));
        expectError(PEL_ERROR_UNSUPPORTED, {"wide shadow", "R32F", "R8_UNORM"}, commit(r));
    }
    {
        Ready r;
        std::vector<PelLight> lights(20, r.frame.lights[0].params);
        r.shader.set(lights);
        for (uint32_t i = 0; i < 20; ++i)
            r.shader.set(i, PEL_LIGHT_WIDE_SHADOW,
                         imageDesc(Buffer(device(), 2048), PEL_FORMAT_R32F, 32, 16));
        expectError(PEL_ERROR_UNSUPPORTED, {"16", "buffers"}, commit(r));
        const Buffer one(device(), 20 * 2048);
        for (uint32_t i = 0; i < 20; ++i)
            r.shader.set(i, PEL_LIGHT_WIDE_SHADOW, imageDesc(one, PEL_FORMAT_R32F, 32, 16, i * 2048));
        EXPECT_NO_THROW(r.shader.commit().execute());
    }
}

TEST(ShadeBadInput, Values) {
    Ready r;
    const auto invalid = PEL_ERROR_INVALID_ARGUMENT;
    const auto material = [&](const char* word, auto change) {
        PelMaterial m = fixture::faceworksMaterial();
        change(m);
        expectError(invalid, {"PelMaterial", word}, [&] { r.shader.setMaterial(1, m); });
    };
    material("thicknessTaps", [](PelMaterial& m) { m.thicknessTaps = 12; });
    const PelMaterial good = fixture::faceworksMaterial();
    expectError(invalid, {"material id 0"}, [&] { r.shader.setMaterial(0, good); });
    expectError(invalid, {"material id 256"}, [&] { r.shader.setMaterial(256, good); });
    expectError(invalid, {"curvature LUT", "other kind"},
                [&] { r.shader.setMaterial(1, good, tables().shadow); });

    const auto light = [&](const char* word, auto change) {
        PelLight l = pelLightDefaults();
        change(l);
        expectError(invalid, {"PelLight 0", word}, [&] { r.shader.set({l}); });
    };
    light("unit length", [](PelLight& l) { l.toLight[0] = 1; });
    light("toLight", [](PelLight& l) { l.toLight[0] = nan; });
    light("type", [](PelLight& l) { l.type = PelLightType(9); });
    light("spotCosInner", [](PelLight& l) { l.type = PEL_LIGHT_SPOT, l.spotCosInner = 0.5f; });
    expectError(invalid, {"65 lights"}, [&] { r.shader.set(std::vector<PelLight>(65, pelLightDefaults())); });
    PelAmbient ambient = pelAmbientDefaults();
    ambient.sh[4][1] = inf;
    expectError(invalid, {"sh"}, [&] { r.shader.set(ambient); });
    PelCamera camera = pelCameraDefaults();
    camera.position[0] = nan;
    expectError(invalid, {"position[0]"}, [&] { r.shader.set(camera); });
    r.shader.commit().execute();
}

}  // namespace
