// Warm-up: builds programs before they are needed (pelWarmUpPrograms).
#include <condition_variable>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "api/entry.h"
#include "lut/luts.h"
#include "mesh/curvature.h"
#include "mesh/mesh_passes.h"
#include "shading/shader.h"

using namespace pel;

namespace {

// Jobs that may run at the same time, in any order. Each builds programs and launches their kernels on
// nothing, or on the smallest possible input.
using WarmUpJobs = std::vector<std::function<void()>>;

constexpr uint32_t texels = 16;  // a side of the smallest table

template <class Desc>
Desc small(Desc desc) {
    desc.width = desc.height = texels;
    return desc;
}

// Curvature and shadow tables. Without a profile, of one that is a sum of Gaussians.
void profileLutJobs(const Ref<Device>& device, const Ref<Profile>& profile, WarmUpJobs& jobs) {
    const auto add = [&](auto desc, auto integrate) {
        jobs.push_back([device, profile, desc, integrate]() mutable {
            std::optional<LentHandle<PelProfile, Profile>> lent;
            if (profile) desc.profile = lent.emplace(profile).get();
            integrate(device, desc);
        });
    };
    PelCurvatureLutDesc curvature = small(pelCurvatureLutDescDefaults());
    for (const PelCurvatureForm form :
         {PEL_FORM_SPHERE, PEL_FORM_RING, PEL_FORM_HALF_RING, PEL_FORM_PENNER_RING, PEL_FORM_ARC}) {
        curvature.form = form;
        add(curvature, [](const auto& on, const auto& desc) { integrateCurvatureLut(on, desc); });
    }
    add(small(pelShadowLutDescDefaults()),
        [](const auto& on, const auto& desc) { integrateShadowLut(on, desc); });
}

void lutJobs(const Ref<Device>& device, WarmUpJobs& jobs) {
    profileLutJobs(device, {}, jobs);
    jobs.push_back([device] {
        const Ref<Lut> lut = tabulateSpecularLut(device, small(pelSpecularLutDescDefaults()));
        std::vector<char> packed(packedBytes(*lut, PEL_LUT_FLOAT));
        for (const PelLutEncoding encoding : {PEL_LUT_FLOAT, PEL_LUT_HALF, PEL_LUT_FACEWORKS8})
            readLut(*lut, encoding, packed.data(), true);
    });
}

// A profile that is not a sum of Gaussians.
void tableLutJobs(const Ref<Device>& device, WarmUpJobs& jobs) {
    const std::vector<float> radii{0, 1, 3}, values{1, 1, 1, 0.5, 0.4, 0.3, 0, 0, 0};
    profileLutJobs(device, Profile::table(radii.data(), values.data(), uint32_t(radii.size())), jobs);
}

// A tetrahedron.
struct SmallMesh {
    Ref<MeshTopology> topology;
    cl::Memory memory;

    SmallMesh(const Ref<Device>& device, bool welded) {
        const float positions[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
        const uint32_t indices[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = 4;
        desc.indices = indices;
        desc.numIndices = 12;
        desc.positions = positions;
        desc.weld = welded ? PEL_WELD_EXACT : PEL_WELD_NONE;
        PelMeshReport report = pelMeshReportDefaults();
        // For other threads, where the caller's callback must not be called.
        topology = MeshTopology::create(device, desc, report, [](double) {});
        memory = device->allocate(sizeof positions, positions);
    }
    VertexView view(uint32_t words) const { return {memory, {4, 0, words, 0}}; }
};

void curvatureJobs(const Ref<Device>& device, WarmUpJobs& jobs) {
    for (const bool welded : {false, true})
        for (const PelCurvatureEstimator estimator :
             {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR, PEL_CURVATURE_QUADRIC})
            jobs.push_back([device, welded, estimator] {
                const SmallMesh mesh(device, welded);
                PelCurvatureParams params = pelCurvatureParamsDefaults();
                params.estimator = estimator;
                params.smoothingRadius = 0.1f;
                const VertexView out{device->allocate(4 * sizeof(float)), {4, 0, 1, 0}};
                MeshCounts counts;
                for (const bool given : {true, false})
                    meshCurvature(*mesh.topology, params, mesh.view(3), given ? mesh.view(3) : VertexView{},
                                  out, &counts);
            });
    jobs.push_back([device] {
        const SmallMesh mesh(device, false);
        meshUvScale(*mesh.topology, mesh.view(3), mesh.view(2));
    });
}

WarmUpJobs jobsOfGroups(const Ref<Device>& device, uint32_t groups) {
    WarmUpJobs jobs;
    if (groups & PEL_PROGRAMS_LUTS) lutJobs(device, jobs);
    if (groups & PEL_PROGRAMS_TABULATED_LUTS) tableLutJobs(device, jobs);
    if (groups & PEL_PROGRAMS_CURVATURE) curvatureJobs(device, jobs);
    return jobs;
}

// What `call` throws.
template <class Call>
std::exception_ptr thrownBy(const Call& call) {
    try {
        call();
    } catch (...) {
        return std::current_exception();
    }
    return {};
}

// Runs them on `threads` threads (0: one per core), reports progress to the device's callback, and throws the
// first error. Jobs that have not begun by then are left out.
void runJobs(Device& device, const WarmUpJobs& jobs, uint32_t threads) {
    std::mutex mutex;  // of these
    std::condition_variable changed;
    size_t next = 0, done = 0;
    std::exception_ptr failure;
    const auto work = [&] {
        std::unique_lock lock(mutex);
        while (!failure && next < jobs.size()) {
            const auto& job = jobs[next++];
            lock.unlock();
            const std::exception_ptr thrown = thrownBy(job);
            lock.lock();
            ++done;
            if (!failure) failure = thrown;
            changed.notify_one();
        }
    };
    const auto report = [&](size_t ready) {
        const std::string what = text("building kernels ", ready, "/", jobs.size());
        device.progress(jobs.empty() ? 1 : double(ready) / double(jobs.size()), what.c_str());
    };
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    if (std::string_view(device.info().platform) == "Oclgrind")
        threads = 1;  // it stops where kernels overlap
    failure = thrownBy([&] { report(0); });
    std::vector<std::jthread> workers;
    while (workers.size() < std::min<size_t>(threads, jobs.size())) {
        const std::exception_ptr none = thrownBy([&] { workers.emplace_back(work); });
        if (none && workers.empty()) failure = none;
        if (none) break;  // fewer threads are enough
    }
    // The callback is called on this thread only, and never while the lock is held.
    std::unique_lock lock(mutex);
    for (size_t reported = 0; reported < jobs.size();) {
        changed.wait(lock, [&] { return failure || done > reported; });
        if (failure) break;
        reported = done;
        lock.unlock();
        const std::exception_ptr cancelled = thrownBy([&] { report(reported); });
        lock.lock();
        if (!failure) failure = cancelled;
    }
    lock.unlock();
    workers.clear();
    device.finish();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace

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
