#include "api/prefill_programs.h"

#include "api/entry.h"

using namespace pel;

PelError pelPrefillPrograms(PelDevice device, const PelPrefill* work, uint32_t* built) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const PelPrefill w = readStruct(work, pelPrefillDefaults(), "PelPrefill");
        constexpr uint32_t known = PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABLE_LUTS | PEL_PROGRAMS_CURVATURE;
        if (w.groups & ~known)
            invalidArgument("PelPrefill.groups is ", w.groups,
                            ", which has bits that are not in PelProgramGroup");
        if (w.numShaders && !w.shaders)
            invalidArgument("PelPrefill.shaders is NULL but numShaders is ", w.numShaders);
        PrefillJobs jobs = prefillGroups(d, w.groups);
        for (uint32_t i = 0; i < w.numShaders; ++i) {
            const Ref<Shader> shader = fromHandle<Shader>(w.shaders[i]);
            if (&shader->device() != d.get())
                invalidArgument("PelPrefill.shaders[", i, "] belongs to another PelDevice");
            shader->addPrefillJobs(jobs);
        }
        const uint32_t before = d->programs().counts().built;
        runPrefill(*d, jobs, w.threads);
        if (built) *built = d->programs().counts().built - before;
    });
}
