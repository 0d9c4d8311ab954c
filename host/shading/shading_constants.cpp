#include "shading/shading_constants.h"

#include <cstddef>

#include "shading/features.h"
#include "shading/material.h"
#include "shading/tap_cells.h"
#include "shared/environment.h"

namespace pel {
namespace {

template <size_t N>
void copy(float (&to)[N], const float (&from)[N]) {
    std::copy_n(from, N, to);
}

// Texels of a table with its copied last column and row (shared/lut.h).
size_t texelCount(const Lut& lut) {
    return size_t(lut.layout().rowTexels) * (lut.height() + 1);
}

}  // namespace

PelShadeImage describeImage(const ImageView& view) {
    PelShadeImage image{};
    if (!view) return image;
    image.offset[0] = uint32_t(view.byteOffset);
    image.offset[1] = uint32_t(view.byteOffset >> 32);
    image.plane[0] = uint32_t(view.planeStride);
    image.plane[1] = uint32_t(view.planeStride >> 32);
    image.pixelStride = uint32_t(view.pixelStride);
    image.rowStride = uint32_t(view.rowStride);
    image.width = view.width;
    image.height = view.height;
    return image;
}

size_t ShadingConstants::update(Device& device, const ShaderState& state,
                                const std::vector<uint32_t>& variants, uint32_t listTiles) {
    gatherLuts(device, state);
    fillFrame(state);
    frame_.listTiles = listTiles;
    const auto materials = describeMaterials(state, variants);
    const auto lights = describeLights(state);
    const auto eyes = describeEyes(state);
    const size_t frameBytes = frameUpload_.update(device, frame_);
    if (frameBytes) band_ = {frame_.tiles, frame_.firstTile, frame_.scratchRow};
    return frameBytes + materialUpload_.update(device, materials) + lightUpload_.update(device, lights) +
           (eyes.empty() ? 0 : eyeUpload_.update(device, eyes));
}

void ShadingConstants::setBand(Device& device, uint32_t firstTile, uint32_t tiles, uint32_t scratchRow) {
    const std::array<uint32_t, 3> band{tiles, firstTile, scratchRow};
    static_assert(offsetof(PelShadeFrame, firstTile) == offsetof(PelShadeFrame, tiles) + 4 &&
                  offsetof(PelShadeFrame, scratchRow) == offsetof(PelShadeFrame, tiles) + 8);
    for (size_t i = 0; i < band.size(); ++i) {
        if (band_[i] == band[i]) continue;
        device.fill(frameMemory().get(), offsetof(PelShadeFrame, tiles) + 4 * i, 4, band[i]);
        band_[i] = band[i];
    }
}

size_t ShadingConstants::scratchBytes() const {
    return frameUpload_.bytes() + materialUpload_.bytes() + lightUpload_.bytes() + lutBytes_;
}

void ShadingConstants::gatherLuts(Device& device, const ShaderState& state) {
    std::vector<Ref<Lut>> wanted;
    for (const auto& [id, material] : state.materials)
        for (const Ref<Lut>& lut : {material.curvatureLut, material.shadowLut, material.transmission,
                                    material.eye ? material.eye->caustics : Ref<Lut>()})
            if (lut &&
                std::none_of(wanted.begin(), wanted.end(), [&](auto& w) { return w.get() == lut.get(); }))
                wanted.push_back(lut);
    const bool same = std::equal(wanted.begin(), wanted.end(), gathered_.begin(), gathered_.end(),
                                 [](auto& a, auto& b) { return a.get() == b.get(); });
    if (same) return;
    std::vector<uint32_t> offsets;
    uint64_t texels = 0;
    for (const auto& lut : wanted) {
        offsets.push_back(uint32_t(texels));
        texels += texelCount(*lut);
    }
    if (texels > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, "the look-up tables of all materials hold ", texels,
             " texels; 2^32 is the most");
    cl::Memory memory;
    size_t bytes = 0;
    if (wanted.size() == 1) {
        memory = wanted[0]->texels();
    } else if (!wanted.empty()) {
        bytes = texels * sizeof(cl_float4);
        memory = device.allocate(bytes);
        for (size_t i = 0; i < wanted.size(); ++i)
            device.copy(wanted[i]->texels().get(), 0, memory.get(), offsets[i] * sizeof(cl_float4),
                        texelCount(*wanted[i]) * sizeof(cl_float4));
    }
    luts_ = memory;
    lutBytes_ = bytes;
    gathered_ = std::move(wanted);
    offsets_ = std::move(offsets);
}

uint32_t ShadingConstants::offsetOf(const Lut* lut) const {
    const auto found =
        std::find_if(gathered_.begin(), gathered_.end(), [&](const auto& g) { return g.get() == lut; });
    return offsets_[size_t(found - gathered_.begin())];
}

PelShadeLut ShadingConstants::describe(const Lut* lut, float materialRadius) const {
    PelShadeLut result{};
    if (!lut) return result;
    result.layout = lut->layout();
    result.offset = offsetOf(lut);
    result.radiusRatio = float(double(materialRadius) / lut->diffusionRadius());
    return result;
}

void ShadingConstants::fillFrame(const ShaderState& state) {
    const ImageView& target = state.images[PEL_SLOT_RADIANCE];
    frame_ = {};
    frame_.width = target.width;
    frame_.height = target.height;
    frame_.tilesX = (target.width + PEL_TILE_WIDTH - 1) / PEL_TILE_WIDTH;
    frame_.tiles = frame_.tilesX * ((target.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT);
    frame_.lights = uint32_t(state.lights.size());
    for (const auto& [id, material] : state.materials) frame_.materialMask[id / 32] |= 1u << id % 32;
    copy(frame_.cameraPosition, state.camera.position);
    copy(frame_.inverseViewProjection, state.camera.inverseViewProjection);
    copy(frame_.invalidColor, state.options.invalidColor);
    frame_.cubeSize = std::min(state.ambientCube.width, state.ambientCube.height);
    frame_.reflectionSize = std::min(state.reflectionCube.width, state.reflectionCube.height);
    if (state.environment) {
        if (!state.ambientCube) frame_.cubeSize = PEL_ENVIRONMENT_LEAST;
        if (!state.reflectionCube) frame_.reflectionSize = PEL_ENVIRONMENT_SIZE;
    }
    // Factors of the orthonormal real spherical harmonics.
    const double pi = 3.14159265358979323846, one = std::sqrt(3 / (4 * pi)), two = std::sqrt(15 / (4 * pi));
    const double factors[9] = {std::sqrt(1 / (4 * pi)),  one, one,      one, two, two,
                               std::sqrt(5 / (16 * pi)), two, 0.5 * two};
    for (int i = 0; i < 9; ++i)
        for (int c = 0; c < 3; ++c)
            frame_.ambient[i][c] = float(factors[i] * state.ambient.sh[i][c] +
                                         (i == 0 ? double(state.ambient.constant[c]) : 0.0));
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot) frame_.images[slot] = describeImage(state.images[slot]);
}

std::vector<PelShadeMaterial> ShadingConstants::describeMaterials(
    const ShaderState& state, const std::vector<uint32_t>& variants) const {
    std::vector<PelShadeMaterial> table(state.materials.empty() ? 1 : state.materials.rbegin()->first + 1);
    const std::vector<float> disks = tapDisks(state);
    uint32_t eyes = 0;
    for (const auto& [id, from] : state.materials) {
        const PelMaterial& m = from.params;
        PelShadeMaterial& to = table[id];
        copy(to.albedo, m.albedo);
        copy(to.normalBlend, m.normalBlend);
        to.curvature = describe(from.curvatureLut.get(), m.diffusionRadius);
        to.shadow = describe(from.shadowLut.get(), m.diffusionRadius);
        to.penumbraPerCosine = 1 / m.shadowFilterWidth;
        const float sharpening = from.shadowLut ? from.shadowLut->info().shadow.sharpening
                                 : from.profile ? pelShadowLutDescDefaults().sharpening
                                                : 0.0f;
        to.specularSharpening = 0.9f * sharpening;
        copy(to.deepScatterColor, m.deepScatterColor);
        const double radius = m.deepScatterRadius, log2e = 1.4426950408889634;
        to.deepScatterFalloff = float(-log2e / (2 * radius * radius));
        to.thicknessCutoff = float(radius * std::sqrt(2 * PEL_LEAST_TRANSMITTANCE_LOG2 / log2e));
        to.deepScatterNormalOffset = m.deepScatterNormalOffset;
        to.thicknessFilterRadius = m.thicknessFilterRadius;
        to.thicknessTaps = m.thicknessTaps;
        to.tapDisk = tapDiskOf(disks, state, from);
        to.specular = m.specular;
        to.roughness = m.roughness;
        to.f0 = m.f0;
        to.diffusionRadius = m.diffusionRadius;
        to.shadowFilterWidth = readsIrradiance(from) ? 0 : m.shadowFilterWidth;
        to.shadowBias = from.shadowBias;
        to.shadowSoftness = from.shadowSoftness;
        to.shadowConeSlope = from.shadowConeSlope;
        to.scattering = m.scattering;
        to.albedoAfter =
            readsIrradiance(from) && m.scattering != PEL_SCATTERING_NONE ? 1 - m.albedoBefore : 1;
        copy(to.through, from.through);
        to.named = from.given.scattering;
        to.specularModel = m.specularModel;
        to.roughness2 = m.roughness2;
        to.lobeMix = m.lobeMix;
        to.deepScatterAmbient = m.deepScatterAmbient;
        if (materialNeeds(state, from) & PEL_FEATURE_TRANSMISSION) {
            const double reach =
                transmissionReach(*from.profile) * m.diffusionRadius / float(from.profile->radius());
            to.transmission = describe(from.transmission.get(), 1);
            to.transmission.radiusRatio = 1;
            to.transmissionPerLength = float(1 / reach);
            to.transmissionShare = m.transmission;
        }
        copy(to.gain, from.gain);
        copy(to.gainSlope, from.gainSlope);
        copy(to.gainSaturation, from.gainSaturation);
        copy(to.absorption, from.absorption);
        to.hasNormalMap = !from.normalMap.empty();
        if (from.eye) to.eye = ++eyes;
        to.needs = materialNeeds(state, from);
        for (size_t i = 0; i < variants.size(); ++i)
            if (!(to.needs & ~variants[i])) to.variants |= 1u << i;
    }
    return table;
}

std::vector<PelShadeEye> ShadingConstants::describeEyes(const ShaderState& state) const {
    std::vector<PelShadeEye> table;
    uint32_t texels = 0;
    for (const auto& [id, material] : state.materials) {
        if (!material.eye) continue;
        const ShaderEye& from = *material.eye;
        PelShadeEye to = describeEye(from.params, from.ambient, state.options.millimetresPerUnit);
        static constexpr float brown[3] = {0.22f, 0.12f, 0.06f};
        for (int c = 0; c < 3; ++c)
            if (to.irisColor[c] < 0) to.irisColor[c] = from.iris ? 1 : brown[c];
        to.textureSize = irisTexels(from);
        to.textureOffset = texels;
        to.textureLevels = irisLevels(to.textureSize);
        texels += irisRowTexels(to.textureSize) * irisRows(to.textureSize);
        const PelEyeLutDesc& lut = from.caustics->info().eye;
        to.causticOffset = offsetOf(from.caustics.get());
        to.causticWidth = lut.width;
        to.causticHeight = lut.height;
        to.causticDepth = lut.depth;
        to.slicesPerRadian = float((lut.depth - 1) / EyeShape(lut, "PelEyeLutDesc").largestAngle);
        table.push_back(to);
    }
    return table;
}

uint32_t ShadingConstants::lightBuffer(const cl::Memory& memory) {
    for (size_t i = 0; i < lightBuffers_.size(); ++i)
        if (lightBuffers_[i].get() == memory.get()) return uint32_t(i);
    if (lightBuffers_.size() == PEL_LIGHT_BUFFERS)
        fail(PEL_ERROR_UNSUPPORTED, "the images of the lights lie in more than ", PEL_LIGHT_BUFFERS,
             " buffers: put several of them into one, with byteOffset");
    lightBuffers_.push_back(memory);
    return uint32_t(lightBuffers_.size() - 1);
}

std::vector<PelShadeLight> ShadingConstants::describeLights(const ShaderState& state) {
    lightBuffers_.clear();
    std::vector<PelShadeLight> table;
    for (const ShaderLight& from : state.lights) {
        const PelLight& l = from.params;
        PelShadeLight to{};
        describeLamp(l, to);
        copy(to.worldToShadow, l.worldToShadow);
        to.projection = l.shadowProjection;
        to.depthRange = l.shadowDepthRange;
        to.depthA = l.shadowDepthA;
        to.depthB = l.shadowDepthB;
        const ImageView &wide = from.images[PEL_LIGHT_WIDE_SHADOW], &map = from.images[PEL_LIGHT_SHADOW_MAP];
        to.wideBuffer = wide ? lightBuffer(wide.buffer->memory()) : PEL_LIGHT_BUFFERS;
        to.mapBuffer = map ? lightBuffer(map.buffer->memory()) : PEL_LIGHT_BUFFERS;
        to.wide = describeImage(wide);
        to.map = describeImage(map);
        to.cascades = map ? l.shadowCascades : 0;
        for (uint32_t i = 0; i < to.cascades; ++i) {
            const ShadowCascade c = shadowCascade(from, i);
            PelShadeCascade& cascade = to.cascade[i];
            copy(cascade.worldToShadow, *c.worldToShadow);
            cascade.depthRange = c.depthRange;
            cascade.mapBuffer = lightBuffer(c.map->buffer->memory());
            cascade.map = describeImage(*c.map);
            for (int r = 0; r < 2; ++r) cascade.tapScale[r] = tapScale(from, i, r);
        }
        table.push_back(to);
    }
    for (const MapCells& map : mapCells(state)) {
        PelShadeLight& light = table[map.light];
        (light.cascades ? light.cascade[map.cascade].cells : light.cells)[map.disk] = map.cells;
    }
    return table;
}

}  // namespace pel
