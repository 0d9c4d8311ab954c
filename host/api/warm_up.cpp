// Warm-up: builds programs before they are needed (pelWarmUpPrograms).
#include "api/entry.h"
#include "api/scatter_images.h"
#include "lut/luts.h"
#include "mesh/curvature.h"
#include "shading/shader.h"

using namespace pel;

namespace {

// The smallest table.
template <class Desc>
Desc small(Desc desc) {
    desc.width = desc.height = 16;
    return desc;
}

// Curvature and shadow tables. Without a profile, of one that is a sum of Gaussians.
void profileLutJobs(const Ref<Device>& device, const Ref<Profile>& profile, BuildJobs& jobs) {
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

void specularLutJob(const Ref<Device>& device, BuildJobs& jobs) {
    jobs.push_back([device] {
        const Ref<Lut> lut = tabulateSpecularLut(device, small(pelSpecularLutDescDefaults()));
        std::vector<char> packed(packedBytes(*lut, PEL_LUT_FLOAT));
        for (const PelLutEncoding encoding : {PEL_LUT_FLOAT, PEL_LUT_HALF, PEL_LUT_FACEWORKS8})
            readLut(*lut, encoding, packed.data(), true);
    });
}

// A profile that is not a sum of Gaussians.
void tableLutJobs(const Ref<Device>& device, BuildJobs& jobs) {
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

void curvatureJobs(const Ref<Device>& device, BuildJobs& jobs) {
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
                                  out, &counts, true);
            });
    jobs.push_back([device] {
        const SmallMesh mesh(device, false);
        meshUvScale(*mesh.topology, mesh.view(3), mesh.view(2));
    });
}

}  // namespace

PelError pelWarmUpPrograms(PelDevice device, const PelWarmUp* work, uint32_t* built) {
    return entry([&] {
        const Ref<Device> d = fromHandle<Device>(device);
        const PelWarmUp w = readStruct(work, pelWarmUpDefaults());
        constexpr uint32_t known = PEL_PROGRAMS_LUTS | PEL_PROGRAMS_TABULATED_LUTS | PEL_PROGRAMS_CURVATURE;
        if (w.groups & ~known)
            invalidArgument("PelWarmUp.groups is ", w.groups,
                            ", which has bits that are not in PelProgramGroup");
        if (w.numShaders && !w.shaders)
            invalidArgument("PelWarmUp.shaders is NULL but numShaders is ", w.numShaders);
        if (w.numScatters && !w.scatters)
            invalidArgument("PelWarmUp.scatters is NULL but numScatters is ", w.numScatters);
        const uint32_t before = d->programs().counts().built;
        const unsigned builders = buildersFor(*d, w.threads);
        cl::BuildHelpers helpers(d->id(), builders);
        BuildJobs jobs;
        if (w.groups & PEL_PROGRAMS_LUTS) profileLutJobs(d, {}, jobs), specularLutJob(d, jobs);
        if (w.groups & PEL_PROGRAMS_TABULATED_LUTS) tableLutJobs(d, jobs);
        if (w.groups & PEL_PROGRAMS_CURVATURE) curvatureJobs(d, jobs);
        {
            const cl::HelpScope scope(helpers);
            for (uint32_t i = 0; i < w.numShaders; ++i) {
                const Ref<Shader> shader = fromHandle<Shader>(w.shaders[i]);
                if (&shader->device() != d.get())
                    invalidArgument("PelWarmUp.shaders[", i, "] belongs to another PelDevice");
                shader->addBuildJobs(jobs);
            }
            eachStruct(w.scatters, w.numScatters, [&](const PelScatterWork* given, uint32_t i) {
                const PelScatterWork s = readStruct(given, pelScatterWorkDefaults());
                const Ref<Scatter> scatter = fromHandle<Scatter>(s.scatter);
                if (&scatter->device() != d.get())
                    invalidArgument("PelWarmUp.scatters[", i, "] belongs to another PelDevice");
                scatter->addBuildJobs(readStructOr(s.params, pelScatterParamsDefaults()),
                                      scatterImages(*d, s.irradiance, s.positions, s.depth, s.ids, s.out),
                                      jobs);
            });
        }
        runJobs(*d, jobs, builders, helpers, [&](size_t done) {
            const std::string what = text("building kernels ", done, "/", jobs.size());
            d->progress(jobs.empty() ? 1 : double(done) / double(jobs.size()), what.c_str());
        });
        if (built) *built = d->programs().counts().built - before;
    });
}
