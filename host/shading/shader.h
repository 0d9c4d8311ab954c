// PelShader: what the caller set (ShaderState), and what a commit made of it (ShaderPlan).
#pragma once
#include <array>
#include <functional>
#include <map>
#include <vector>

#include "core/image_view.h"
#include "lut/lut.h"
#include "shading/ambient_cube.h"
#include "shading/shade_passes.h"
#include "shading/shade_tables.h"

namespace pel {

struct ShaderMaterial {
    PelMaterial params;
    Ref<Lut> curvatureLut, shadowLut;
    std::vector<ImageView> normalMap;  // its levels, the finest first
};

struct ShaderLight {
    PelLight params;
    std::array<ImageView, PEL_LIGHT_SLOT_COUNT> images;
};

struct ShaderState {
    PelShaderOptions options = pelShaderOptionsDefaults();
    std::array<ImageView, PEL_SLOT_COUNT> images;
    std::map<uint32_t, ShaderMaterial> materials;
    std::vector<ShaderLight> lights;
    PelAmbient ambient = pelAmbientDefaults();
    ImageView ambientCube;  // six faces
    PelCamera camera = pelCameraDefaults();
};

// What a variant of a kernel knows of an image's layout: images whose pixels are read one by one get another one than tight
// ones of at least mathWidth pixels a row.
uint32_t formatCode(const ImageView& view, uint32_t mathWidth);
// The same of a light's shadow map and its cascades together.
uint32_t mapFormatCode(const ShaderLight& light);
// CPUs run one vector of pixels after another in each work-item; GPUs want a full work-group in a tile.
uint32_t shadeGroup(const Device& device);
// For classify_tiles: work-items that each take a run of the tiles.
cl::Range classifyRange(const Device& device, size_t tiles);
// Work-items that keep every unit busy to the end; each group takes a run of the frame's tiles.
cl::Range tileRange(const Device& device, uint32_t tiles);

const char* slotName(PelImageSlot slot);
const char* lightSlotName(PelLightSlot slot);

// One of a light's cascades, 0 the finest.
struct ShadowCascade {
    const float (*worldToShadow)[16];
    float depthRange;
    const ImageView* map;
};
inline ShadowCascade shadowCascade(const ShaderLight& light, uint32_t index) {
    const PelLight& l = light.params;
    if (index == 0) return {&l.worldToShadow, l.shadowDepthRange, &light.images[PEL_LIGHT_SHADOW_MAP]};
    return {&l.cascadeToShadow[index - 1], l.cascadeDepthRange[index - 1], &light.images[PEL_LIGHT_CASCADE_1 + index - 1]};
}
inline bool isCube(const PelLight& light) {
    return light.shadowProjection >= PEL_SHADOW_CUBE;
}
// The PelFeature bits of the forms that a light's shadow map has.
inline uint32_t formFeatures(const PelLight& l) {
    uint32_t features = 0;
    if (isCube(l)) features |= PEL_FEATURE_SHADOW_CUBE;
    if (l.shadowCascades) features |= PEL_FEATURE_SHADOW_CASCADES;
    if (l.shadowContent == PEL_SHADOW_CONTENT_EXPONENTIAL) features |= PEL_FEATURE_SHADOW_EXPONENTIAL;
    if (l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS) features |= PEL_FEATURE_SHADOW_MOMENTS;
    return features;
}

// Whether a light's wide shadow is made from its shadow map.
inline bool filtersShadow(const ShaderLight& light) {
    return !light.images[PEL_LIGHT_WIDE_SHADOW] && light.images[PEL_LIGHT_SHADOW_MAP] && light.params.shadowFilterTexels > 0;
}

// Whether PelAmbient gives no light; there may be a cube map beside it.
bool isBlack(const PelAmbient& ambient);

// Those PelFeature bits that a material asks for by itself, as far as the rest is there.
uint32_t materialNeeds(const ShaderState& state, const ShaderMaterial& material);
// The features that each variant of the shading kernel has: of the whole shader first, then fewer and fewer, for tiles whose
// materials need no more.
std::vector<uint32_t> variantFeatures(const ShaderState& state, uint32_t features);
// What makes a variant of the shading kernel and its classification: shaders that mean the same have equal keys.
cl::ProgramKey shadeKey(const ShaderState& plan, uint32_t features, const Device& device);
// PelFeature bits of what is bound and non-zero. Throws when something needed is missing or does not fit.
uint32_t deriveFeatures(const ShaderState& state);

class Shader final : public Object {
  public:
    static constexpr Kind kind = Kind::shader;
    explicit Shader(Ref<Device> device);

    void setOptions(const PelShaderOptions& options);
    void setImage(PelImageSlot slot, const PelImageDesc* image);
    void setMaterial(uint32_t id, const PelMaterial* material, Lut* curvatureLut, Lut* shadowLut);
    void setNormalMap(uint32_t id, const PelImageDesc* levels, uint32_t count);
    void setLights(const PelLight* lights, uint32_t count);
    void setLightImage(uint32_t light, PelLightSlot slot, const PelImageDesc* image);
    void setAmbient(const PelAmbient& ambient);
    void setAmbientCube(const PelImageDesc* faces);
    void setCamera(const PelCamera& camera);
    void commit();
    // `blocking`: the caller waits, and may want to hear how far it is.
    void execute(bool blocking);
    PelShaderStats stats();
    // Jobs that build what a commit would, and launch each kernel on no tile. Throws what a commit would.
    void addPrefillJobs(std::vector<std::function<void()>>& jobs) const;
    Device& device() const { return *device_; }

  private:
    ~Shader() override = default;
    // Rows of tiles, [begin, end), that launches work on.
    struct Rows {
        uint32_t begin, end;
    };
    void plan(uint32_t mostRows);  // a commit
    void setRows(Rows rows, uint32_t scratchRow);
    void launchOnNothing();
    void shadeRows(Rows rows, bool tell, bool& begun);
    bool halveBand();
    uint32_t tileRows() const;
    void enqueueTiles(Rows rows);
    void enqueueShade(uint32_t variant, Rows rows, uint32_t part, uint32_t parts);

    Ref<Device> device_;
    ShaderState state_;  // as the caller set it
    ShaderState plan_;   // as of the last commit, with the images that the passes make in their slots
    ShadePasses passes_;
    AmbientCube cube_;
    ShadeTables tables_;
    bool committed_ = false;
    uint32_t features_ = 0;
    std::vector<uint32_t> variants_;         // features
    std::vector<cl::Program> shadePrograms_;  // one per variant; the first classifies tiles, too
    cl::Memory tileLists_, counters_;
    cl::Memory bandCounts_;  // the counts of the lists, band after band
    size_t tileListBytes_ = 0, bandCountBytes_ = 0;
    uint64_t bands_ = 0;
    uint64_t programsBuilt_ = 0, launches_ = 0, bytesUploaded_ = 0, uploadedBefore_ = 0;
    bool executed_ = false;
    std::vector<cl::Event> events_;
};

}  // namespace pel
