#include "demo_reference.h"

#include <algorithm>
#include <cmath>

#include "io/lut/profile_file.h"
#include "sample/surface_light.h"
#include "surface_reference.h"

namespace pellucid::cli {
namespace {

// Light changes over a millimetre where skin lets it; edges of shadows are found to half of that.
constexpr double finest = 0.5, coarsest = 4;  // mm

}  // namespace

DemoReference demoReference(const Device& device, const sample::Scene& mesh, const DemoHead& head,
                            const DemoView& view, const std::vector<float>& smooth) {
    DemoReference out;
    out.width = view.gbuffer.width / referenceStride;
    out.height = view.gbuffer.height / referenceStride;
    out.radiance.resize(3 * size_t(out.width) * out.height);
    out.error.resize(out.radiance.size());
    const std::vector<float> positions = view.gbuffer.interleaved(view.scene.channels[PEL_SLOT_POSITION]),
                             albedo = view.gbuffer.interleaved(view.scene.channels[PEL_SLOT_ALBEDO]);
    const std::vector<float>& ids = view.gbuffer.channel("Material.I").pixels;
    std::vector<size_t> from, to;  // pixels of the picture, and of the reference
    std::vector<float> places;
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const size_t i = size_t(y) * referenceStride * view.gbuffer.width + size_t(x) * referenceStride;
            if (ids[i] != float(demo::DEMO_SKIN)) continue;
            from.push_back(i);
            to.push_back(size_t(y) * out.width + x);
            places.insert(places.end(), {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
        }
    sample::LitMeshOptions options;
    options.finest = finest;
    options.coarsest = coarsest;
    options.deviation = 0.01;
    options.material = head.materials.empty() ? 0 : uint32_t(demo::DEMO_SKIN);
    const sample::LitMesh lit = sample::lightMesh(mesh, lightingOf(view.scene), options);
    const Profile profile = io::findProfile(view.scene.materials[0].profile).profile;
    PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
    desc.profile = profile.get();
    const std::vector<float> scattered = sample::scatteredAt(device, lit, places, desc);
    double squares = 0;
    float brightest = 1e-6f;
    for (size_t k = 0; k < from.size(); ++k)
        for (size_t c = 0; c < 3; ++c) {
            const float value = scattered[3 * k + c] * albedo[3 * from[k] + c];
            const float error = smooth[3 * from[k] + c] - value;
            out.radiance[3 * to[k] + c] = value;
            out.error[3 * to[k] + c] = error;
            squares += double(error) * error;
            brightest = std::max(brightest, value);
        }
    out.rms = from.empty() ? 0 : std::sqrt(squares / double(3 * from.size())) / brightest;
    return out;
}

}  // namespace pellucid::cli
