#include "api/warm_up_jobs.h"

#include "api/entry.h"

using namespace pel;

PelError pelWarmUpPrograms(PelDevice device, const PelWarmUp* work, uint32_t* built) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const PelWarmUp w = readStruct(work, pelWarmUpDefaults(), "PelWarmUp");
        constexpr uint32_t known = PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABULATED_LUTS | PEL_PROGRAMS_CURVATURE;
        if (w.groups & ~known)
            invalidArgument("PelWarmUp.groups is ", w.groups,
                            ", which has bits that are not in PelProgramGroup");
        if (w.numShaders && !w.shaders)
            invalidArgument("PelWarmUp.shaders is NULL but numShaders is ", w.numShaders);
        WarmUpJobs jobs = jobsOfGroups(d, w.groups);
        for (uint32_t i = 0; i < w.numShaders; ++i) {
            const Ref<Shader> shader = fromHandle<Shader>(w.shaders[i]);
            if (&shader->device() != d.get())
                invalidArgument("PelWarmUp.shaders[", i, "] belongs to another PelDevice");
            shader->addWarmUpJobs(jobs);
        }
        const uint32_t before = d->programs().counts().built;
        runJobs(*d, jobs, w.threads);
        if (built) *built = d->programs().counts().built - before;
    });
}
