#include "diffusion/blend_scatter.h"

#include <cstring>

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
#include "shading/scratch_image.h"
#include "shading/shading_constants.h"

namespace pel {

void BlendScatter::prepare(const std::map<uint32_t, PelBlendMaterial>& materials,
                           const PelBlendMaterial& other, const BlendImages& images, bool accumulate) {
    PelBlendFrame frame{};
    frame.width = images.out.width, frame.height = images.out.height;
    frame.accumulate = accumulate;
    frame.irradiance = describeImage(images.irradiance);
    frame.scattered = describeImage(images.scattered);
    frame.material = describeImage(images.ids);
    frame.back = describeImage(images.back);
    frame.weight = describeImage(images.weight);
    frame.albedo = describeImage(images.albedo);
    frame.out = describeImage(images.out);
    std::vector<PelBlendMaterial> all{other};
    for (const auto& [id, material] : materials) {
        frame.materialOf[id] = uint32_t(all.size());
        all.push_back(material);
    }
    if (!frame_ || std::memcmp(&frame, &sent_, sizeof frame))
        frame_ = device_->allocate(sizeof frame, &frame), sent_ = frame;
    const size_t bytes = all.size() * sizeof all[0];
    if (all.size() != sentMaterials_.size() || std::memcmp(all.data(), sentMaterials_.data(), bytes))
        materials_ = device_->allocate(bytes, all.data()), sentMaterials_ = all;
}

std::vector<cl::ProgramKey> BlendScatter::programs(const BlendImages& images) const {
    const auto code = [](const ImageView& view) { return text(formatCode(view, 1)); };
    return {{{"diffusion/blend_scatter.cl"},
             {{"PEL_WIDTH", text(1)},
              {"PEL_FORMAT_IRRADIANCE", code(images.irradiance)},
              {"PEL_FORMAT_SCATTERED", code(images.scattered)},
              {"PEL_FORMAT_MATERIAL", code(images.ids)},
              {"PEL_FORMAT_BACK", code(images.back)},
              {"PEL_FORMAT_SCATTER_WEIGHT", code(images.weight)},
              {"PEL_FORMAT_ALBEDO", code(images.albedo)},
              {"PEL_FORMAT_OUT", code(images.out)}}}};
}

void BlendScatter::launch(cl::Launch& launch, const BlendImages& images, std::vector<cl::Event>& events) {
    events.push_back(
        device_->launch(launch, itemRange(*device_, size_t(images.out.width) * images.out.height)));
}

void BlendScatter::enqueuePreparation(const BlendImages& images, std::vector<cl::Event>& events) {
    cl::Launch one(device_->programs().get(programs(images)[0]), "prepare_irradiance");
    one.arg(frame_).arg(materials_).arg(memoryOf(images.irradiance)).arg(memoryOf(images.ids));
    one.arg(memoryOf(images.back)).arg(memoryOf(images.albedo)).arg(memoryOf(images.out));
    launch(one, images, events);
}

void BlendScatter::enqueueFinish(const BlendImages& images, std::vector<cl::Event>& events) {
    cl::Launch one(device_->programs().get(programs(images)[0]), "finish_scatter");
    one.arg(frame_).arg(materials_).arg(memoryOf(images.irradiance)).arg(memoryOf(images.scattered));
    one.arg(memoryOf(images.ids)).arg(memoryOf(images.weight)).arg(memoryOf(images.albedo));
    one.arg(memoryOf(images.out));
    launch(one, images, events);
}

Rgb throughSheet(const Profile& profile, double scale, double thickness) {
    return thickness > 0 ? profile.shape().transmission(thickness / scale) : Rgb{};
}

}  // namespace pel
