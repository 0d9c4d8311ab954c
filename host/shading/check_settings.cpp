// The settings that a shader accepts: value by value when they are set, and all together at commit.
#include "shading/check_settings.h"

#include "core/check_range.h"
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

void checkChoice(std::string_view structure, const char* field, int value, int count, const char* type) {
    if (value < 0 || value >= count)
        invalidArgument(structure, ".", field, " is ", value, ", which is not a value of ", type);
}

bool isUnit(const float (&v)[3]) {
    const double length2 = dot(threeAt(v), threeAt(v));
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

void checkSize(const char* name, const ImageView& view, const char* outName, const ImageView& of) {
    if (view.width != of.width || view.height != of.height)
        invalidArgument("the ", name, " image is ", view.width, " x ", view.height, ", the ", outName, " ",
                        of.width, " x ", of.height, "; all must have one size");
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
            invalidArgument("the ", name,
                            " image has another format, pixel stride or buffer than level 0; all levels need "
                            "the same, each at its own byteOffset");
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
    checkChoice(structure, "specularModel", m.specularModel, PEL_MODELS, "PelSpecularModel");
    checkChoice(structure, "scattering", m.scattering, PEL_SCATTERS, "PelScattering");
    if (m.thicknessTaps & (m.thicknessTaps - 1))
        invalidArgument("PelMaterial.thicknessTaps is ", m.thicknessTaps, "; it must be 0, 8, 16 or 32");
}

static void checkRectangle(const PelLight& l, const std::string& name) {
    checkFinite(name.c_str(), "halfWidth", l.halfWidth, 3);
    checkFinite(name.c_str(), "halfHeight", l.halfHeight, 3);
    const Three across = threeAt(l.halfWidth), up = threeAt(l.halfHeight);
    const double width = length(across), height = length(up);
    if (!(std::min(width, height) >= PEL_TINY && std::max(width, height) <= PEL_HUGE))
        invalidArgument(name, ".halfWidth and halfHeight have the lengths ", float(width), " and ",
                        float(height), "; each must be at least ", PEL_TINY, " and at most ", PEL_HUGE);
    const double cosine = dot(across, up) / (width * height);
    if (!(std::abs(cosine) <= 1e-3))
        invalidArgument(
            name, ".halfWidth and halfHeight must be at right angles; the cosine between them is ", cosine);
}

void checkLight(const PelLight& l, uint32_t index) {
    const std::string name = text("PelLight ", index), &structure = name;
    const PelLight& fields = l;
    PEL_EACH_LIGHT_FIELD(PEL_CHECK_RANGE)
    PEL_EACH_SHADOW_MAP_FIELD(PEL_CHECK_RANGE)
    checkChoice(structure, "shadowContent", l.shadowContent, PEL_CONTENTS, "PelShadowContent");
    checkChoice(structure, "shadowProjection", l.shadowProjection, PEL_MAPS, "PelShadowProjection");
    checkChoice(structure, "type", l.type, PEL_TYPES, "PelLightType");
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
    if (l.type == PEL_LIGHT_SPHERE) {
        PEL_EACH_SPHERE_LIGHT_FIELD(PEL_CHECK_RANGE)
    }
    if (l.type == PEL_LIGHT_RECTANGLE) checkRectangle(l, name);
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

void checkEnvironment(const ImageView& image) {
    checkContent(image, Content::COLOR, "environment");
    if (image.width != 2 * image.height && image.height != 6 * image.width && image.width != 6 * image.height)
        invalidArgument("the environment image is ", image.width, " x ", image.height,
                        "; an equirectangular one is 2n x n pixels, six square faces are n x 6n or 6n x n");
}

void checkAxes(const std::array<float, 9>& axes) {
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k <= i; ++k) {
            const double product = dot(threeAt(&axes[3 * i]), threeAt(&axes[3 * k]));
            if (!(std::abs(product - (i == k)) < 1e-3))
                invalidArgument(
                    "the axes of the environment must be three unit vectors at right angles; the "
                    "product of rows ",
                    k, " and ", i, " is ", product);
        }
}

void checkCamera(const PelCamera& camera) {
    checkFinite("PelCamera", "position", camera.position, 3);
    for (const float p : camera.position)
        if (std::abs(p) > 1e18f) invalidArgument("PelCamera.position holds ", p, "; 1e18 is the most");
    checkFinite("PelCamera", "inverseViewProjection", camera.inverseViewProjection, 16);
}

void checkInvertible(const char* structure, const float (&m)[16]) {
    // By its 2 x 2 minors, over the lengths of its rows.
    const auto minor = [&](int row, int a, int b) {
        return double(m[row + a]) * m[row + 4 + b] - double(m[row + b]) * m[row + 4 + a];
    };
    const double determinant = minor(0, 0, 1) * minor(8, 2, 3) - minor(0, 0, 2) * minor(8, 1, 3) +
                               minor(0, 0, 3) * minor(8, 1, 2) + minor(0, 1, 2) * minor(8, 0, 3) -
                               minor(0, 1, 3) * minor(8, 0, 2) + minor(0, 2, 3) * minor(8, 0, 1);
    double lengths = 1;
    for (int r = 0; r < 16; r += 4)
        lengths *= std::hypot(std::hypot(m[r], m[r + 1]), std::hypot(m[r + 2], m[r + 3]));
    if (!(std::abs(determinant) > 1e-14 * lengths))
        invalidArgument(structure, ".inverseViewProjection is singular: positions cannot be made from depth");
}

void checkOptions(const PelShaderOptions& options) {
    checkFinite("PelShaderOptions", "invalidColor", options.invalidColor, 3);
    const char* structure = "PelShaderOptions";
    const PelShaderOptions& fields = options;
    PEL_EACH_OPTION_FIELD(PEL_CHECK_RANGE)
    checkChoice(structure, "tileLists", options.tileLists, PEL_TILES_NO_LIST + 1, "PelTileLists");
}

static void checkCube(const ShaderLight& light, const std::string& name) {
    const PelLight& l = light.params;
    if (l.type == PEL_LIGHT_DIRECTIONAL)
        invalidArgument(
            name,
            ".shadowProjection is a cube, and its type directional: cubes are for lights with a position");
    const ImageView& map = light.images[PEL_LIGHT_SHADOW_MAP];
    if (map.height != 6 * uint64_t(map.width))
        invalidArgument("the shadow map of ", name, " is ", map.width, " x ", map.height,
                        "; a cube of this width is ", map.width, " x ", 6 * map.width,
                        ": six square faces, one below the other, +x -x +y -y +z -z");
    const float* m = l.worldToShadow;
    double largest = 0;
    for (int r = 0; r < 3; ++r) {
        double at = m[4 * r + 3];
        for (int c = 0; c < 3; ++c)
            at += double(m[4 * r + c]) * l.position[c],
                largest = std::max(largest, std::abs(double(l.position[c])));
        if (!(std::abs(at) <= 1e-3 * std::max(1.0, largest)))
            invalidArgument(name, ".worldToShadow maps the light's position to a point whose component ", r,
                            " is ", at, "; the light of a cube map must be at the origin");
        for (int q = 0; q <= r; ++q) {
            const double product = dot(threeAt(m + 4 * r), threeAt(m + 4 * q));
            if (!(std::abs(product - (q == r)) < 1e-3))
                invalidArgument(name, ".worldToShadow stretches or shears (rows ", q, " and ", r,
                                " have the product ", product,
                                "); a cube map needs a rotation, with the light at the origin");
        }
    }
    if (l.shadowProjection == PEL_SHADOW_CUBE && l.shadowDepthA == 0)
        invalidArgument(name,
                        ".shadowDepthA is 0: A and B of distance = 1 / (A z + B) along the axis of a face "
                        "are needed; PEL_SHADOW_CUBE_RADIAL is for distances from the light");
    if (l.shadowProjection == PEL_SHADOW_CUBE_RADIAL && !(l.shadowDepthRange > 0))
        invalidArgument(name, ".shadowDepthRange is ", l.shadowDepthRange,
                        ": the distance from the light at depth 1 is needed, above 0");
}

static void checkCascades(const ShaderLight& light, const std::string& name) {
    const PelLight& l = light.params;
    if (l.type != PEL_LIGHT_DIRECTIONAL || l.shadowProjection != PEL_SHADOW_PARALLEL)
        invalidArgument(name, ".shadowCascades is ", l.shadowCascades,
                        "; only directional lights with parallel maps can have cascades");
    for (uint32_t i = 0; i < l.shadowCascades; ++i) {
        const ShadowCascade c = shadowCascade(light, i);
        const std::string matrix = i ? text("cascadeToShadow[", i - 1, "]") : "worldToShadow";
        if (!*c.map)
            invalidArgument(name, ".shadowCascades is ", l.shadowCascades, ", and its image ",
                            lightSlotName(PelLightSlot(PEL_LIGHT_CASCADE_1 + i - 1)), " is not set");
        checkFinite(name.c_str(), matrix.c_str(), *c.worldToShadow, 16);
        const std::string range = i ? text("cascadeDepthRange[", i - 1, "]") : "shadowDepthRange";
        checkFinite(name.c_str(), range.c_str(), &c.depthRange, 1);
        if (c.depthRange == 0 || (c.depthRange < 0) != (l.shadowDepthRange < 0))
            invalidArgument(name, ".", range, " is ", c.depthRange,
                            ": the length that depths 0 to 1 span is needed, of one sign for all cascades");
        const float* m = *c.worldToShadow;
        // Of the image of a unit cube.
        const double volume = dot(threeAt(m), cross(threeAt(m + 4), threeAt(m + 8)));
        if (!(std::abs(volume) > 0) || m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] == 0)
            invalidArgument(name, ".", matrix,
                            " is singular or no parallel projection (row 3 must be 0, 0, 0 and not 0): each "
                            "cascade needs its own world to (u, v, z)");
    }
}

static void checkContent(const ShaderLight& light, const std::string& name) {
    const PelLight& l = light.params;
    const ImageView& map = light.images[PEL_LIGHT_SHADOW_MAP];
    if (l.shadowContent == PEL_SHADOW_CONTENT_MOMENTS && map.info().components < 2)
        invalidArgument("the shadow map of ", name, " has format ", map.info().name,
                        "; PEL_SHADOW_CONTENT_MOMENTS needs two components, the means of z and of z^2");
    if (l.shadowContent != PEL_SHADOW_CONTENT_EXPONENTIAL) return;
    const bool nearness =
        l.shadowProjection == PEL_SHADOW_PERSPECTIVE || l.shadowProjection == PEL_SHADOW_CUBE;
    const float growth = nearness ? -l.shadowDepthA : l.shadowDepthRange;
    if (!std::isfinite(l.shadowExponent) || !(l.shadowExponent * growth > 0) ||
        std::abs(l.shadowExponent) > 1e4f)
        invalidArgument(name, ".shadowExponent is ", l.shadowExponent,
                        "; exponential maps need c of exp(c z), ", growth > 0 ? "above" : "below",
                        " 0 here so that c z grows away from the light, such as ", growth > 0 ? "80" : "-80");
}

void checkLightMap(const ShaderLight& light, uint32_t index) {
    const PelLight& l = light.params;
    const std::string name = text("PelLight ", index);
    checkFinite(name.c_str(), "worldToShadow", l.worldToShadow, 16);
    checkFinite(name.c_str(), "shadowDepthRange", &l.shadowDepthRange, 1);
    checkFinite(name.c_str(), "shadowDepthA", &l.shadowDepthA, 1);
    checkFinite(name.c_str(), "shadowDepthB", &l.shadowDepthB, 1);
    if (l.shadowCascades) checkCascades(light, name);
    if (l.shadowProjection == PEL_SHADOW_PARALLEL && l.shadowDepthRange == 0)
        invalidArgument(name, ".shadowDepthRange is 0: the length that depths 0 to 1 span is needed");
    if (l.shadowProjection == PEL_SHADOW_PERSPECTIVE && l.shadowDepthA == 0)
        invalidArgument(name, ".shadowDepthA is 0: A and B of distance = 1 / (A z + B) are needed");
    if (isCube(l)) checkCube(light, name);
    checkContent(light, name);
}

}  // namespace pel
