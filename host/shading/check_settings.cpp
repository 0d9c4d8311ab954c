// What a shader accepts, value by value as it is set and as a whole at commit.
#include "shading/check_settings.h"

#include <cmath>
#include <initializer_list>

#include "shared/shade.h"

namespace pel {
namespace {

constexpr const char* slotNames[PEL_SLOT_COUNT] = {"radiance",         "material",
                                                   "position",         "depth",
                                                   "geometric normal", "shading normal",
                                                   "blurred normal",   "curvature",
                                                   "albedo",           "ambient occlusion",
                                                   "thickness",        "roughness",
                                                   "specular",         "UV",
                                                   "UV gradient",      "tangent",
                                                   "diffuse output",   "deep scatter output",
                                                   "specular output",  "thickness output"};

enum class Content { scalar, id, color, normal, output, scalarOutput, uv, gradient };

Content content(PelImageSlot slot) {
    switch (slot) {
        case PEL_SLOT_RADIANCE:
        case PEL_SLOT_OUT_DIFFUSE:
        case PEL_SLOT_OUT_DEEP_SCATTER:
        case PEL_SLOT_OUT_SPECULAR:
            return Content::output;
        case PEL_SLOT_OUT_THICKNESS:
            return Content::scalarOutput;
        case PEL_SLOT_MATERIAL:
            return Content::id;
        case PEL_SLOT_POSITION:
        case PEL_SLOT_ALBEDO:
            return Content::color;
        case PEL_SLOT_NORMAL_GEOMETRIC:
        case PEL_SLOT_NORMAL_SHADING:
        case PEL_SLOT_NORMAL_BLURRED:
        case PEL_SLOT_TANGENT:
            return Content::normal;
        case PEL_SLOT_UV:
            return Content::uv;
        case PEL_SLOT_UV_GRADIENT:
            return Content::gradient;
        default:
            return Content::scalar;
    }
}

bool isUint(PelFormat f) {
    return f == PEL_FORMAT_R8_UINT || f == PEL_FORMAT_R16_UINT || f == PEL_FORMAT_R32_UINT;
}

bool isFloat(PelFormat f) {
    return f >= PEL_FORMAT_R32F && f <= PEL_FORMAT_RGBA16F;
}

void checkContent(const ImageView& view, Content content, const char* what) {
    const PelFormat f = view.format;
    const uint32_t components = view.info().components;
    const char* right = nullptr;
    switch (content) {
        case Content::scalar:
            if (isUint(f) || f == PEL_FORMAT_OCT16X2_SNORM) right = "a float or unorm format";
            break;
        case Content::id:
            if (!isUint(f) && !isFloat(f)) right = "a uint or float format";
            break;
        case Content::color:
            if (isUint(f) || components < 3) right = "three components, float or unorm";
            break;
        case Content::normal:
            if (isUint(f) || f == PEL_FORMAT_RGBA8_SRGB || (components < 3 && f != PEL_FORMAT_OCT16X2_SNORM))
                right = "three components, float or unorm, or OCT16X2_SNORM";
            break;
        case Content::uv:
            if (!isFloat(f) || components < 2) right = "two components, float or half";
            break;
        case Content::gradient:
            if (!isFloat(f) || components < 4) right = "four components, float or half";
            break;
        case Content::scalarOutput:
            if (!isFloat(f)) right = "float or half";
            break;
        case Content::output:
            if (!((isFloat(f) && components >= 3) || f == PEL_FORMAT_PLANAR_RGB32F))
                right = "RGB or RGBA, float or half";
            break;
    }
    if (right) invalidArgument("the ", what, " image has format ", view.info().name, "; it needs ", right);
}

struct Bound {
    const char* field;
    float value, least, most;
};

void within(const char* structure, std::initializer_list<Bound> bounds) {
    for (const Bound& b : bounds)
        if (!(b.value >= b.least && b.value <= b.most))
            invalidArgument(structure, ".", b.field, " is ", b.value, "; it must be between ", b.least,
                            " and ", b.most);
}

constexpr float tiny = 1e-6f, huge = 1e18f;

bool isUnit(const float (&v)[3]) {
    const double length2 = double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2];
    return length2 > 0.998 && length2 < 1.002;
}

}  // namespace

void checkFinite(const char* structure, const char* field, const float* values, size_t count) {
    for (size_t i = 0; i < count; ++i)
        if (!std::isfinite(values[i]))
            invalidArgument(structure, ".", field, "[", i, "] is ", values[i], "; it must be finite");
}

const char* slotName(PelImageSlot slot) {
    return slotNames[slot];
}

const char* lightSlotName(PelLightSlot slot) {
    constexpr const char* names[PEL_LIGHT_SLOT_COUNT] = {"wide shadow", "shadow map", "cascade 1",
                                                         "cascade 2", "cascade 3"};
    return names[slot];
}

void checkImage(PelImageSlot slot, const ImageView& view) {
    checkContent(view, content(slot), slotName(slot));
}

void checkLightImage(PelLightSlot slot, const ImageView& view) {
    checkContent(view, Content::scalar, lightSlotName(slot));
    // Taps address the map with 32 bits.
    if (slot != PEL_LIGHT_WIDE_SHADOW && view.byteEnd() - view.byteOffset > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, "the ", lightSlotName(slot), " image spans ",
             view.byteEnd() - view.byteOffset, " bytes; 4 GiB is the most");
}

void checkNormalMap(const std::vector<ImageView>& levels) {
    for (size_t i = 0; i < levels.size(); ++i) {
        const ImageView &level = levels[i], &first = levels[0];
        const std::string name = text("normal map ", i);
        if (level.format == PEL_FORMAT_OCT16X2_SNORM || level.format == PEL_FORMAT_RGBA8_SRGB)
            invalidArgument("the ", name, " image has format ", level.info().name,
                            "; it needs three components, float or unorm, that may be averaged");
        checkContent(level, Content::color, name.c_str());
        if (level.format != first.format || level.tightlyPacked() != first.tightlyPacked() ||
            level.buffer->memory().get() != first.buffer->memory().get())
            invalidArgument(
                "the ", name,
                " image has another format, pixel stride or buffer than level 0; all levels need the "
                "same, each at its own byteOffset");
        const uint32_t width = std::max(first.width >> i, 1u), height = std::max(first.height >> i, 1u);
        if (level.width != width || level.height != height)
            invalidArgument("the ", name, " image is ", level.width, " x ", level.height, "; below ",
                            first.width, " x ", first.height, " it must be ", width, " x ", height);
    }
}

void checkMaterial(const PelMaterial& m) {
    const char* name = "PelMaterial";
    checkFinite(name, "albedo", m.albedo, 3);
    checkFinite(name, "deepScatterColor", m.deepScatterColor, 3);
    for (float blend : m.normalBlend) within(name, {{"normalBlend", blend, 0, 1}});
    within(name, {{"diffusionRadius", m.diffusionRadius, tiny, huge},
                  {"shadowFilterWidth", m.shadowFilterWidth, tiny, huge},
                  {"deepScatterRadius", m.deepScatterRadius, tiny, huge},
                  {"deepScatterNormalOffset", m.deepScatterNormalOffset, -huge, huge},
                  {"thicknessFilterRadius", m.thicknessFilterRadius, 0, 1},
                  {"specular", m.specular, 0, huge},
                  {"roughness", m.roughness, 0, huge},
                  {"f0", m.f0, 0, 1},
                  {"uvScale", m.uvScale, tiny, huge},
                  {"roughness2", m.roughness2, 0, huge},
                  {"lobeMix", m.lobeMix, 0, 1},
                  {"deepScatterAmbient", m.deepScatterAmbient, 0, huge}});
    if (m.specularModel > PEL_SPECULAR_GGX)
        invalidArgument("PelMaterial.specularModel is ", int(m.specularModel),
                        ", which is none of PelSpecularModel");
    if (m.thicknessTaps != 0 && m.thicknessTaps != 8 && m.thicknessTaps != 16 && m.thicknessTaps != 32)
        invalidArgument("PelMaterial.thicknessTaps is ", m.thicknessTaps, "; it must be 0, 8, 16 or 32");
}

void checkLight(const PelLight& l, uint32_t index) {
    const std::string name = text("PelLight ", index);
    checkFinite(name.c_str(), "color", l.color, 3);
    for (float c : l.color) within(name.c_str(), {{"color", c, 0, huge}});
    if (l.shadowFilterTexels != 0 && (l.shadowFilterTexels < 4 || l.shadowFilterTexels > 256))
        invalidArgument(name, ".shadowFilterTexels is ", l.shadowFilterTexels,
                        "; it must be 0, or between 4 and 256");
    within(name.c_str(), {{"shadowBias", l.shadowBias, 0, huge},
                          {"shadowSoftness", l.shadowSoftness, 1e-3f, huge},
                          {"shadowConeSlope", l.shadowConeSlope, 0, huge},
                          {"shadowMinDeviation", l.shadowMinDeviation, 0, huge},
                          {"shadowBleeding", l.shadowBleeding, 0, 0.999f}});
    if (l.shadowCascades > PEL_CASCADES)
        invalidArgument(name, ".shadowCascades is ", l.shadowCascades, "; ", PEL_CASCADES, " are the most");
    if (l.shadowContent > PEL_SHADOW_CONTENT_EXPONENTIAL)
        invalidArgument(name, ".shadowContent is ", int(l.shadowContent),
                        ", which is none of PelShadowContent");
    if (l.shadowProjection > PEL_SHADOW_CUBE_RADIAL)
        invalidArgument(name, ".shadowProjection is ", int(l.shadowProjection),
                        ", which is none of PelShadowProjection");
    if (l.type > PEL_LIGHT_SPOT)
        invalidArgument(name, ".type is ", int(l.type), ", which is none of PelLightType");
    if (l.type == PEL_LIGHT_DIRECTIONAL) {
        checkFinite(name.c_str(), "toLight", l.toLight, 3);
        if (!isUnit(l.toLight))
            invalidArgument(name, ".toLight is (", l.toLight[0], ", ", l.toLight[1], ", ", l.toLight[2],
                            "); it must be of unit length");
    } else {
        checkFinite(name.c_str(), "position", l.position, 3);
        within(name.c_str(), {{"range", l.range, 0, huge}});
    }
    if (l.type == PEL_LIGHT_SPOT) {
        checkFinite(name.c_str(), "spotDirection", l.spotDirection, 3);
        if (!isUnit(l.spotDirection)) invalidArgument(name, ".spotDirection must be of unit length");
        within(name.c_str(), {{"spotCosOuter", l.spotCosOuter, -1, 1}});
        within(name.c_str(), {{"spotCosInner", l.spotCosInner, l.spotCosOuter, 1}});
    }
}

void checkAmbient(const PelAmbient& ambient) {
    checkFinite("PelAmbient", "constant", ambient.constant, 3);
    checkFinite("PelAmbient", "sh", &ambient.sh[0][0], 27);
}

void checkAmbientCube(const ImageView& faces) {
    checkContent(faces, Content::color, "ambient cube");
    if (faces.height != 6 * faces.width && faces.width != 6 * faces.height)
        invalidArgument("the ambient cube image is ", faces.width, " x ", faces.height,
                        "; six square faces one below the other are n x 6n pixels, side by side 6n x n");
}

void checkCamera(const PelCamera& camera) {
    checkFinite("PelCamera", "position", camera.position, 3);
    checkFinite("PelCamera", "inverseViewProjection", camera.inverseViewProjection, 16);
}

void checkOptions(const PelShaderOptions& options) {
    checkFinite("PelShaderOptions", "invalidColor", options.invalidColor, 3);
    if (options.tileLists > PEL_TILES_NO_LIST)
        invalidArgument("PelShaderOptions.tileLists is ", int(options.tileLists),
                        ", which is none of PelTileLists");
}

}  // namespace pel
