#include "diffusion/blend_scatter.h"

#include "core/launch_policy.h"
#include "shading/launch_ranges.h"
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
    frame.curvature = describeImage(images.curvature);
    frame.out = describeImage(images.out);
    std::vector<PelBlendMaterial> all{other};
    for (const auto& [id, material] : materials) {
        frame.materialOf[id] = uint32_t(all.size());
        all.push_back(material);
    }
    frame_.update(*device_, frame);
    materials_.update(*device_, all);
}

std::vector<cl::ProgramKey> BlendScatter::programs(const BlendImages& images) const {
    return {{{"diffusion/blend_scatter.cl"},
             {{"PEL_WIDTH", 1},
              {"PEL_FORMAT_IRRADIANCE", formatCode(images.irradiance, 1)},
              {"PEL_FORMAT_SCATTERED", formatCode(images.scattered, 1)},
              {"PEL_FORMAT_MATERIAL", formatCode(images.ids, 1)},
              {"PEL_FORMAT_BACK", formatCode(images.back, 1)},
              {"PEL_FORMAT_SCATTER_WEIGHT", formatCode(images.weight, 1)},
              {"PEL_FORMAT_ALBEDO", formatCode(images.albedo, 1)},
              {"PEL_FORMAT_MEAN_CURVATURE", formatCode(images.curvature, 1)},
              {"PEL_FORMAT_OUT", formatCode(images.out, 1)}}}};
}

void BlendScatter::enqueuePreparation(const BlendImages& images, std::vector<cl::Event>& events) {
    device_->launch(events, device_->programs().get(programs(images)[0]), "prepare_irradiance",
                    itemRange(*device_, size_t(images.out.width) * images.out.height), frame_, materials_,
                    images.irradiance, images.ids, images.back, images.albedo, images.out);
}

void BlendScatter::enqueueFinish(const BlendImages& images, std::vector<cl::Event>& events) {
    device_->launch(events, device_->programs().get(programs(images)[0]), "finish_scatter",
                    itemRange(*device_, size_t(images.out.width) * images.out.height), frame_, materials_,
                    images.irradiance, images.scattered, images.ids, images.weight, images.albedo,
                    images.curvature, images.out);
}

Rgb throughSheet(const Profile& profile, double scale, double thickness) {
    return thickness > 0 ? profile.shape().transmission(thickness / scale) : Rgb{};
}

}  // namespace pel
