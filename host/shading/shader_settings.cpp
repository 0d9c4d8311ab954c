// Settings of a PelShader: checked, and kept until the next commit.
#include "core/handle_table.h"
#include "core/struct_size.h"
#include "shading/check_settings.h"
#include "shading/shader.h"

namespace pel {

// A unique number for an image that is converted once.
static uint64_t nextNumber() {
    static std::atomic<uint64_t> last;
    return ++last;
}

void Shader::setOptions(const PelShaderOptions& options) {
    checkOptions(options);
    if (options.millimetresPerUnit != state_.options.millimetresPerUnit) {
        auto materials = state_.materials;
        for (auto& [id, material] : materials) resolveMaterial(material, device_, options, profileTables_);
        state_.materials = std::move(materials);
        profileTables_.keepOnly(state_.materials);
    }
    state_.options = options;
    committed_ = false;
}

// Sets an image that `check` accepts; NULL: none.
template <class Check>
void Shader::setView(ImageView& to, const PelImageDesc* image, const char* name, const Check& check) {
    ImageView view;
    if (image) {
        view = makeImageView(image, *device_, name);
        check(view);
    }
    to = view;
    committed_ = false;
}

void Shader::setImage(PelImageSlot slot, const PelImageDesc* image) {
    if (uint32_t(slot) >= PEL_SLOT_COUNT)
        invalidArgument("image slot ", int(slot), " is not a value of PelImageSlot");
    setView(state_.images[slot], image, slotName(slot), [&](const ImageView& v) { checkImage(slot, v); });
}

void Shader::setMaterial(uint32_t id, const PelMaterial* material, Lut* curvatureLut, Lut* shadowLut) {
    if (id < 1 || id >= PEL_MATERIALS)
        invalidArgument("material id ", id, " is not between 1 and ", PEL_MATERIALS - 1,
                        " (0 is the background)");
    if (!material) {
        state_.materials.erase(id);
        committed_ = false;
        return;
    }
    checkMaterial(*material);
    const auto check = [&](Lut* lut, PelLutKind kind, const char* what) {
        if (!lut) return;
        if (&lut->device() != device_.get())
            invalidArgument("the ", what, " LUT belongs to another PelDevice than the shader");
        if (lut->info().kind != kind) invalidArgument("the LUT given as ", what, " LUT is of another kind");
    };
    check(curvatureLut, PEL_LUT_CURVATURE, "curvature");
    check(shadowLut, PEL_LUT_SHADOW, "shadow");
    const auto known = state_.materials.find(id);
    ShaderMaterial set =
        known == state_.materials.end() ? ShaderMaterial() : known->second;  // which may have textures
    set.given = *material;
    set.profile = material->profile ? fromHandle<Profile>(material->profile) : Ref<Profile>();
    set.givenCurvatureLut = Ref(curvatureLut);
    set.givenShadowLut = Ref(shadowLut);
    resolveMaterial(set, device_, state_.options, profileTables_);
    state_.materials[id] = std::move(set);
    profileTables_.keepOnly(state_.materials);
    committed_ = false;
}

// The material that something belongs to; it must be set first.
ShaderMaterial& Shader::materialFor(uint32_t id, const char* what) {
    const auto found = state_.materials.find(id);
    if (found == state_.materials.end())
        invalidArgument("material ", id, " is not set: pelShaderSetMaterial comes before its ", what);
    return found->second;
}

void Shader::setNormalMap(uint32_t id, const PelImageDesc* levels, uint32_t count) {
    ShaderMaterial& material = materialFor(id, "normal map");
    if (count > PEL_MAP_LEVELS)
        invalidArgument("a normal map of ", count, " levels; ", PEL_MAP_LEVELS, " are the most");
    if (count > 0 && !levels) invalidArgument("levels is NULL but their count is ", count);
    std::vector<ImageView> views;
    eachStruct(levels, count, [&](const PelImageDesc* level, uint32_t i) {
        views.push_back(makeImageView(level, *device_, text("normal map ", i).c_str()));
    });
    checkNormalMap(views);
    material.normalMap = std::move(views);
    committed_ = false;
}

void Shader::setScatteredTexture(uint32_t id, const PelImageDesc* texture) {
    setView(materialFor(id, "scattered texture").scatteredTexture, texture, "scattered texture",
            checkScatteredTexture);
}

void Shader::setEye(uint32_t id, const PelEye* eye, Lut* caustics) {
    ShaderMaterial& material = materialFor(id, "eye");
    if (!eye) {
        material.eye.reset();
        committed_ = false;
        return;
    }
    ShaderEye set = material.eye.value_or(ShaderEye());  // which may have a texture
    const PelEye before = set.params;
    set.given = *eye;
    set.params = resolvedEye(*eye);
    set.ambientKnown &= sameShape(before, set.params);
    if (caustics && &caustics->device() != device_.get())
        invalidArgument("the caustics belong to another PelDevice than the shader");
    if (caustics && caustics->info().kind != PEL_LUT_EYE)
        invalidArgument("the LUT given as caustics is of another kind: pelEyeLutCreate would be right");
    const auto eyes =
        std::ranges::count_if(state_.materials, [](const auto& m) { return m.second.eye.has_value(); });
    if (!material.eye && eyes >= PEL_EYES)
        invalidArgument("material ", id, " would be eye ", eyes + 1, "; at most ", PEL_EYES,
                        " are supported");
    const Ref<Profile> profile = eye->irisProfile ? fromHandle<Profile>(eye->irisProfile) : Ref<Profile>();
    // An eye that only moves keeps its table.
    const bool keeps = !caustics && set.ownCaustics && set.irisProfile.get() == profile.get() &&
                       sameShape(before, set.params);
    if (!keeps) set.caustics = Ref(caustics);
    set.irisProfile = profile;
    set.ownCaustics = caustics == nullptr;
    material.eye = std::move(set);
    committed_ = false;
}

void Shader::setIrisTexture(uint32_t id, const PelImageDesc* texture) {
    ShaderMaterial& material = materialFor(id, "iris");
    if (!material.eye)
        invalidArgument("material ", id, " is not an eye: pelShaderSetEye comes before its iris texture");
    setView(material.eye->iris, texture, "iris texture", checkIrisTexture);
    material.eye->textureNumber = nextNumber();
}

void Shader::setLights(const PelLight* lights, uint32_t count) {
    if (count > 64) invalidArgument(count, " lights were given; 64 is the most");
    if (count > 0 && !lights) invalidArgument("lights is NULL but their count is ", count);
    std::vector<ShaderLight> list(count);
    eachStruct(lights, count, [&](const PelLight* light, uint32_t i) {
        list[i].params = readStruct(light, pelLightDefaults());
        checkLight(list[i].params, i);
        if (i < state_.lights.size()) list[i].images = state_.lights[i].images;
    });
    state_.lights = std::move(list);
    committed_ = false;
}

void Shader::setLightImage(uint32_t light, PelLightSlot slot, const PelImageDesc* image) {
    if (light >= state_.lights.size())
        invalidArgument("light ", light, " is not set, only the first ", state_.lights.size(),
                        "; pelShaderSetLights comes first");
    if (uint32_t(slot) >= PEL_LIGHT_SLOT_COUNT)
        invalidArgument("light image slot ", int(slot), " is not a value of PelLightSlot");
    const std::string name = text(lightSlotName(slot), " (light ", light, ")");
    setView(state_.lights[light].images[slot], image, name.c_str(),
            [&](const ImageView& view) { checkLightImage(slot, view, name.c_str()); });
}

void Shader::setAmbient(const PelAmbient& ambient) {
    checkAmbient(ambient);
    state_.ambient = ambient;
    committed_ = false;
}

void Shader::setAmbientCube(const PelImageDesc* faces) {
    setView(state_.ambientCube, faces, "ambient cube",
            [](const ImageView& v) { checkCube(v, "ambient cube"); });
}

void Shader::setReflectionCube(const PelImageDesc* faces) {
    setView(state_.reflectionCube, faces, "reflection cube",
            [](const ImageView& v) { checkCube(v, "reflection cube"); });
}

void Shader::setEnvironment(const PelImageDesc* image, const float* axes) {
    std::array<float, 9> set = ShaderState().environmentAxes;
    if (axes) std::copy_n(axes, 9, set.begin());
    checkAxes(set);
    setView(state_.environment, image, "environment", checkEnvironment);
    state_.environmentAxes = set;
    state_.environmentNumber = nextNumber();
}

const PelMaterial& Shader::material(uint32_t id) const {
    const auto found = state_.materials.find(id);
    if (found == state_.materials.end()) invalidArgument("material ", id, " is not set");
    return (committed_ ? plan_.state.materials.at(id) : found->second).params;
}

void Shader::setCamera(const PelCamera& camera) {
    checkCamera(camera);
    state_.camera = camera;
    committed_ = false;
}

}  // namespace pel
