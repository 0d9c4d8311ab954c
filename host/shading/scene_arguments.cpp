#include "shading/scene_arguments.h"

#include "shading/image_slots.h"
#include "shading/scratch_image.h"
#include "shading/shading_constants.h"

namespace pel {

void sceneArguments(cl::Launch& launch, const PassWork& work) {
    const ShadingConstants& constants = work.constants;
    launch.arg(constants.frameMemory())
        .arg(constants.materials())
        .arg(constants.lights())
        .arg(constants.luts());
    launch.arg(work.plan.tileLists).arg(work.plan.counters).arg(work.plan.ambientNodes);
    launch.arg(constants.eyes()).arg(work.plan.irises).arg(work.plan.reflectionNodes);
    launch.arg(work.plan.tapCells);
    for (int slot = 0; slot < PEL_SLOT_COUNT; ++slot)
        if (imageSlot(slot).role != SlotRole::PASS) launch.arg(memoryOf(work.plan.state.images[slot]));
    const auto& lights = constants.lightBuffers();
    for (size_t i = 0; i < PEL_LIGHT_BUFFERS; ++i) launch.arg(i < lights.size() ? lights[i] : cl::Memory());
}

}  // namespace pel
