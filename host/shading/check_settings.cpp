// The settings that a shader accepts: value by value when they are set, and all together at commit.
#include "shading/check_settings.h"

#include <cmath>

#include "core/check_range.h"
#include "shading/image_slots.h"
#include "shared/shade.h"

namespace pel {
namespace {

void checkContent(const ImageView& view, Content content, const char* what) {
    const FormatKind kind = view.info().kind;
    const bool isUint = kind == FormatKind::UINT, isFloat = kind == FormatKind::FLOAT;
    const bool octahedral = kind == FormatKind::OCTAHEDRAL;
    const uint32_t components = view.info().components;
    const char* right = nullptr;
    switch (content) {
        case Content::SCALAR:
            if (isUint || octahedral) right = "a float or unorm format";
            break;
        case Content::ID:
            if (!isUint && !isFloat) right = "a uint or float format";
            break;
        case Content::COLOR:
            if (isUint || components < 3) right = "three components, float or unorm";
            break;
        case Content::NORMAL:
            if (isUint || kind == FormatKind::SRGB || (components < 3 && !octahedral))
                right = "three components, float or unorm, or OCT16X2_SNORM";
            break;
        case Content::UV:
            if (!isFloat || components < 2) right = "two components, float or half";
            break;
        case Content::GRADIENT:
            if (!isFloat || components < 4) right = "four components, float or half";
            break;
        case Content::SCALAR_OUTPUT:
            if (!isFloat) right = "float or half";
            break;
        case Content::COLOR_OUTPUT:
            if (!((isFloat && components >= 3) || kind == FormatKind::PLANAR))
                right = "RGB or RGBA, float or half";
            break;
    }
    if (right) invalidArgument("the ", what, " image has format ", view.info().name, "; it needs ", right);
}

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

void checkImage(PelImageSlot slot, const ImageView& view) {
    checkContent(view, imageSlot(slot).content, slotName(slot));
}

void checkLightImage(PelLightSlot slot, const ImageView& view, const char* what) {
    checkContent(view, Content::SCALAR, what);
    // Taps address the map with 32 bits.
    if (slot != PEL_LIGHT_WIDE_SHADOW && view.byteEnd() - view.byteOffset > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, "the ", what, " image spans ", view.byteEnd() - view.byteOffset,
             " bytes; 4 GiB is the most");
}

void checkNormalMap(const std::vector<ImageView>& levels) {
    for (size_t i = 0; i < levels.size(); ++i) {
        const ImageView &level = levels[i], &first = levels[0];
        const std::string name = text("normal map ", i);
        if (level.format == PEL_FORMAT_OCT16X2_SNORM || level.format == PEL_FORMAT_RGBA8_SRGB)
            invalidArgument("the ", name, " image has format ", level.info().name,
                            "; it needs three components, float or unorm, that may be averaged");
        checkContent(level, Content::COLOR, name.c_str());
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

void checkScatterControls(const char* structure, uint32_t taps, float albedoBefore,
                          const float (&borderColor)[3]) {
    checkRange(structure, "scatterTaps", taps, range::material::scatterTaps);
    checkRange(structure, "albedoBefore", albedoBefore, range::material::albedoBefore);
    checkRange(structure, "borderColor", borderColor, range::material::borderColor);
}

void checkScatteredTexture(const ImageView& texture) {
    checkContent(texture, Content::COLOR, "scattered texture");
}

void checkMaterial(const PelMaterial& m) {
    const char* structure = "PelMaterial";
    const PelMaterial& fields = m;
    PEL_EACH_MATERIAL_FIELD(PEL_CHECK_RANGE)
    if (unsigned(m.specularModel) >= PEL_MODELS)
        invalidArgument("PelMaterial.specularModel is ", int(m.specularModel),
                        ", which is none of PelSpecularModel");
    if (unsigned(m.scattering) >= PEL_SCATTERS)
        invalidArgument("PelMaterial.scattering is ", int(m.scattering), ", which is none of PelScattering");
    if (m.thicknessTaps & (m.thicknessTaps - 1))
        invalidArgument("PelMaterial.thicknessTaps is ", m.thicknessTaps, "; it must be 0, 8, 16 or 32");
}

void checkLight(const PelLight& l, uint32_t index) {
    const std::string name = text("PelLight ", index), &structure = name;
    const PelLight& fields = l;
    PEL_EACH_LIGHT_FIELD(PEL_CHECK_RANGE)
    PEL_EACH_SHADOW_MAP_FIELD(PEL_CHECK_RANGE)
    if (unsigned(l.shadowContent) >= PEL_CONTENTS)
        invalidArgument(name, ".shadowContent is ", int(l.shadowContent),
                        ", which is none of PelShadowContent");
    if (unsigned(l.shadowProjection) >= PEL_MAPS)
        invalidArgument(name, ".shadowProjection is ", int(l.shadowProjection),
                        ", which is none of PelShadowProjection");
    if (unsigned(l.type) >= PEL_TYPES)
        invalidArgument(name, ".type is ", int(l.type), ", which is none of PelLightType");
    if (l.type == PEL_LIGHT_DIRECTIONAL) {
        checkFinite(name.c_str(), "toLight", l.toLight, 3);
        if (!isUnit(l.toLight))
            invalidArgument(name, ".toLight is (", l.toLight[0], ", ", l.toLight[1], ", ", l.toLight[2],
                            "); it must be of unit length");
    } else {
        checkFinite(name.c_str(), "position", l.position, 3);
        PEL_EACH_POSITIONAL_LIGHT_FIELD(PEL_CHECK_RANGE)
    }
    if (l.type == PEL_LIGHT_SPOT) {
        checkFinite(name.c_str(), "spotDirection", l.spotDirection, 3);
        if (!isUnit(l.spotDirection)) invalidArgument(name, ".spotDirection must be of unit length");
        PEL_EACH_SPOT_LIGHT_FIELD(PEL_CHECK_RANGE)
        if (l.spotCosInner < l.spotCosOuter)
            invalidArgument(name, ".spotCosInner is ", l.spotCosInner, "; it must be at least spotCosOuter, ",
                            l.spotCosOuter);
    }
}

void checkAmbient(const PelAmbient& ambient) {
    checkFinite("PelAmbient", "constant", ambient.constant, 3);
    checkFinite("PelAmbient", "sh", &ambient.sh[0][0], 27);
}

void checkIrisTexture(const ImageView& texture) {
    checkContent(texture, Content::COLOR, "iris texture");
    if (texture.width != texture.height)
        invalidArgument("the iris texture is ", texture.width, " x ", texture.height,
                        "; a square, whose inscribed circle is the iris' rim, would be right");
}

void checkCube(const ImageView& faces, const char* what) {
    checkContent(faces, Content::COLOR, what);
    if (faces.height != 6 * faces.width && faces.width != 6 * faces.height)
        invalidArgument("the ", what, " image is ", faces.width, " x ", faces.height,
                        "; six square faces one below the other are n x 6n pixels, side by side 6n x n");
}

void checkCamera(const PelCamera& camera) {
    checkFinite("PelCamera", "position", camera.position, 3);
    checkFinite("PelCamera", "inverseViewProjection", camera.inverseViewProjection, 16);
}

void checkOptions(const PelShaderOptions& options) {
    checkFinite("PelShaderOptions", "invalidColor", options.invalidColor, 3);
    const char* structure = "PelShaderOptions";
    const PelShaderOptions& fields = options;
    PEL_EACH_OPTION_FIELD(PEL_CHECK_RANGE)
    if (options.tileLists > PEL_TILES_NO_LIST)
        invalidArgument("PelShaderOptions.tileLists is ", int(options.tileLists),
                        ", which is none of PelTileLists");
}

}  // namespace pel
