// Beside kernels/lut/specular_lut.cl.
#include "lut/lut_check.h"
#include "lut/luts.h"

namespace pel {

Ref<Lut> tabulateSpecularLut(Ref<Device> device, const PelSpecularLutDesc& desc) {
    checkSpecularDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SPECULAR;
    info.specular = desc;
    Ref<Lut> lut = make<Lut>(device, info);
    constexpr size_t group = 64;
    cl::Launch launch(device->programs().get("lut/specular_lut.cl", {{"PEL_GROUP", std::to_string(group)}}),
                      "specular_texels");
    launch.arg(lut->layout()).arg(lut->texels());
    device->launch(launch, {{desc.width + size_t(1), desc.height + size_t(1), 1}, {group, 1, 1}});
    return lut;
}

}  // namespace pel
