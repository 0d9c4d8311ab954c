#include "io/lut/profile_file.h"
#include "scene/scene_frame.h"

namespace pellucid::io {

ScatteredFrame scatterFrame(const Device& device, const Image& gbuffer, const SceneFile& scene) {
    const auto width = uint32_t(gbuffer.width), height = uint32_t(gbuffer.height);
    std::map<PelImageSlot, OwnedImage> images;
    for (const PelImageSlot slot :
         {PEL_SLOT_IRRADIANCE, PEL_SLOT_POSITION, PEL_SLOT_DEPTH, PEL_SLOT_MATERIAL, PEL_SLOT_SCATTER_WEIGHT,
          PEL_SLOT_ALBEDO, PEL_SLOT_IRRADIANCE_BACK, PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_MEAN_CURVATURE})
        if (const ChannelGroup& channels = scene.channels[slot]; !channels.empty())
            images.emplace(slot, imageDesc(Buffer(device, gbuffer.interleaved(channels)),
                                           groupFormats[channels.size() - 1], width, height));
    const auto given = [&](PelImageSlot slot) {
        const auto found = images.find(slot);
        return found == images.end() ? nullptr : &found->second;
    };

    Scatter scatter(device);
    for (const PelImageSlot slot : {PEL_SLOT_SCATTER_WEIGHT, PEL_SLOT_ALBEDO, PEL_SLOT_IRRADIANCE_BACK,
                                    PEL_SLOT_NORMAL_GEOMETRIC, PEL_SLOT_MEAN_CURVATURE})
        if (const OwnedImage* image = given(slot)) scatter.set(slot, *image);
    for (const SceneMaterial& m : scene.materials) {
        if (m.profile.empty()) continue;
        PelScatterControls controls = pelScatterControlsDefaults();
        if (m.material.scattering != PEL_SCATTERING_AUTO) controls.scattering = m.material.scattering;
        controls.scatterTaps = m.material.scatterTaps;
        controls.albedoBefore = m.material.albedoBefore;
        std::ranges::copy(m.material.borderColor, controls.borderColor);
        controls.thinThickness = m.material.thinThickness;
        try {
            scatter.setMaterial(m.id, findProfile(m.profile).profile,
                                m.scale < 0 ? 1 / scene.options.millimetresPerUnit : m.scale);
            if (m.scale != 0) scatter.setControls(m.id, controls);
        } catch (const Error& e) {
            throw FileError(scene.source, e.what(), m.line);
        }
    }

    PelScatterParams params = *scene.scatter;
    std::ranges::copy(scene.camera.inverseViewProjection, params.inverseViewProjection);
    std::vector<float> held(gbuffer.pixelCount() * 3);
    if (const ChannelGroup& channels = scene.channels[PEL_SLOT_RADIANCE]; !channels.empty())
        held = gbuffer.interleaved(channels);
    const Buffer light(device, held);
    const OwnedImage* const positions = given(PEL_SLOT_POSITION);
    scatter.execute(params, *given(PEL_SLOT_IRRADIANCE), positions,
                    positions ? nullptr : given(PEL_SLOT_DEPTH), given(PEL_SLOT_MATERIAL),
                    imageDesc(light, PEL_FORMAT_RGB32F, width, height));
    return {light.readAll<float>(), scatter.stats()};
}

}  // namespace pellucid::io
