#include "shading/shader.h"

#include "api/entry.h"
#include "core/submission.h"
#include "diffusion/passes.h"

using namespace pel;

// The passes of every shader, in the order in which they run: a pass reads what earlier passes made.
static const PassKind shadingPasses[] = {
    ambientCubePass,    reflectionCubePass, environmentPass,  irisesPass,     classifyTilesPass, tapCellsPass,
    blurNormalsPass,    normalMapPass,      shadowBoundsPass, wideShadowPass, irradiancePass,    skinMapsPass,
    prepareScatterPass, curvaturePass,      diskPass,         separablePass,  texturePass,       scatterPass,
    lightScatterPass,   weighScatterPass,   shadePass};

PelError pelShaderCreate(PelDevice device, PelShader* shader) {
    return create(shader, "shader", [&] { return make<Shader>(fromHandle<Device>(device), shadingPasses); });
}

PEL_COUNTED(Shader)

PelError pelShaderSetOptions(PelShader shader, const PelShaderOptions* options) {
    return entry(
        [&] { fromHandle<Shader>(shader)->setOptions(readStruct(options, pelShaderOptionsDefaults())); });
}

PelError pelShaderSetImage(PelShader shader, PelImageSlot slot, const PelImageDesc* image) {
    return entry([&] { fromHandle<Shader>(shader)->setImage(slot, image); });
}

PelError pelShaderSetMaterial(PelShader shader, uint32_t id, const PelMaterial* material, PelLut curvatureLut,
                              PelLut shadowLut) {
    return entry([&] {
        const Ref<Shader> s = fromHandle<Shader>(shader);
        if (!material) return s->setMaterial(id, nullptr, nullptr, nullptr);
        const Ref<Lut> curvature = curvatureLut ? fromHandle<Lut>(curvatureLut) : Ref<Lut>();
        const Ref<Lut> shadow = shadowLut ? fromHandle<Lut>(shadowLut) : Ref<Lut>();
        const PelMaterial m = readStruct(material, pelMaterialDefaults());
        s->setMaterial(id, &m, curvature.get(), shadow.get());
    });
}

PelError pelShaderSetNormalMap(PelShader shader, uint32_t id, const PelImageDesc* levels, uint32_t count) {
    return entry([&] { fromHandle<Shader>(shader)->setNormalMap(id, levels, count); });
}

PelError pelShaderSetScatteredTexture(PelShader shader, uint32_t id, const PelImageDesc* texture) {
    return entry([&] { fromHandle<Shader>(shader)->setScatteredTexture(id, texture); });
}

PelError pelShaderSetEye(PelShader shader, uint32_t id, const PelEye* eye, PelLut caustics) {
    return entry([&] {
        const Ref<Shader> s = fromHandle<Shader>(shader);
        if (!eye) return s->setEye(id, nullptr, nullptr);
        const Ref<Lut> table = caustics ? fromHandle<Lut>(caustics) : Ref<Lut>();
        const PelEye given = readStruct(eye, pelEyeDefaults());
        s->setEye(id, &given, table.get());
    });
}

PelError pelShaderSetIrisTexture(PelShader shader, uint32_t id, const PelImageDesc* texture) {
    return entry([&] { fromHandle<Shader>(shader)->setIrisTexture(id, texture); });
}

PelError pelShaderSetReflectionCube(PelShader shader, const PelImageDesc* faces) {
    return entry([&] { fromHandle<Shader>(shader)->setReflectionCube(faces); });
}

PelError pelShaderSetEnvironment(PelShader shader, const PelImageDesc* image, const float* axes) {
    return entry([&] { fromHandle<Shader>(shader)->setEnvironment(image, axes); });
}

PelError pelShaderSetLights(PelShader shader, const PelLight* lights, uint32_t count) {
    return entry([&] { fromHandle<Shader>(shader)->setLights(lights, count); });
}

PelError pelShaderSetLightImage(PelShader shader, uint32_t light, PelLightSlot slot,
                                const PelImageDesc* image) {
    return entry([&] { fromHandle<Shader>(shader)->setLightImage(light, slot, image); });
}

PelError pelShaderSetAmbient(PelShader shader, const PelAmbient* ambient) {
    return entry([&] { fromHandle<Shader>(shader)->setAmbient(readStruct(ambient, pelAmbientDefaults())); });
}

PelError pelShaderSetAmbientCube(PelShader shader, const PelImageDesc* faces) {
    return entry([&] { fromHandle<Shader>(shader)->setAmbientCube(faces); });
}

PelError pelShaderSetCamera(PelShader shader, const PelCamera* camera) {
    return entry([&] { fromHandle<Shader>(shader)->setCamera(readStruct(camera, pelCameraDefaults())); });
}

PelError pelShaderCommit(PelShader shader) {
    return entry([&] {
        const Ref<Shader> s = fromHandle<Shader>(shader);
        s->commit();
        warn(s->warnings());
    });
}

PelError pelShaderExecute(PelShader shader, const PelSubmit* submit) {
    return entry([&] {
        const Ref<Shader> s = fromHandle<Shader>(shader);
        submitted(s->device(), submit, [&](bool) { s->execute(submit == nullptr); });
    });
}

PelError pelShaderGetMaterial(PelShader shader, uint32_t id, PelMaterial* material) {
    return entry([&] {
        PelMaterial resolved = fromHandle<Shader>(shader)->material(id);
        resolved.profile = nullptr;  // the caller's handle may be gone
        writeStruct(material, resolved);
    });
}

PelError pelShaderGetWarnings(PelShader shader, const char** warnings) {
    return entry([&] { output(warnings, "warnings") = fromHandle<Shader>(shader)->warnings().c_str(); });
}

PelError pelShaderGetStats(PelShader shader, PelShaderStats* stats) {
    return entry([&] { writeStruct(stats, fromHandle<Shader>(shader)->stats()); });
}

template <class T>
static void writeArray(T* to, uint32_t* count, const std::vector<T>& values) {
    uint32_t& room = output(count, "count");
    writeStructs(to, room, values);
    room = uint32_t(values.size());
}

PelError pelShaderGetPasses(PelShader shader, PelPassStats* passes, uint32_t* count) {
    return entry([&] { writeArray(passes, count, fromHandle<Shader>(shader)->passStats()); });
}

PelError pelShaderGetMemory(PelShader shader, PelPassMemory* passes, uint32_t* count) {
    return entry([&] { writeArray(passes, count, fromHandle<Shader>(shader)->memory()); });
}
