#include <Imath/ImathBox.h>

#include "io/lut/profile_file.h"
#include "scene/scene_frame.h"

namespace pellucid::io {
namespace {

constexpr float fingertip = 20;  // mm

std::string shown(float value) {
    return printed("%.4g", value);
}

// use(values of a slot, pixel) at each pixel that may have a material.
template <class Use>
void eachPixel(const Image& gbuffer, const SceneFile& scene, const DeviceImages* images, PelImageSlot slot,
               Use&& use) {
    const PixelValues values(gbuffer, scene.channels[slot], images);
    const size_t components = scene.channels[slot].size();
    std::optional<PixelValues> ids;
    if (!scene.channels[PEL_SLOT_MATERIAL].empty())
        ids.emplace(gbuffer, scene.channels[PEL_SLOT_MATERIAL], images);
    for (size_t i = 0; i < gbuffer.pixelCount(); ++i)
        if (!ids || ids->at()[i] > 0) use(values.at() + i * components, i);
}

// The extent of the visible surface, from positions or from device depth. A point with NaN or Inf is left
// out.
Imath::Box3d extentOf(const Image& gbuffer, const SceneFile& scene, const DeviceImages* images) {
    Imath::Box3d extent;
    const auto add = [&](double x, double y, double z) {
        if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) extent.extendBy({x, y, z});
    };
    if (!scene.channels[PEL_SLOT_POSITION].empty()) {
        eachPixel(gbuffer, scene, images, PEL_SLOT_POSITION,
                  [&](const float* p, size_t) { add(p[0], p[1], p[2]); });
        return extent;
    }
    const float* m = scene.camera.inverseViewProjection;
    eachPixel(gbuffer, scene, images, PEL_SLOT_DEPTH, [&](const float* depth, size_t i) {
        const double clip[] = {(double(i % size_t(gbuffer.width)) + 0.5) * 2 / gbuffer.width - 1,
                               1 - (double(i / size_t(gbuffer.width)) + 0.5) * 2 / gbuffer.height, depth[0],
                               1};
        double p[4] = {};
        for (int row = 0; row < 4; ++row)
            for (int c = 0; c < 4; ++c) p[row] += double(m[4 * row + c]) * clip[c];
        add(p[0] / p[3], p[1] / p[3], p[2] / p[3]);
    });
    return extent;
}

}  // namespace

std::vector<std::string> unlikely(const Image& gbuffer, const SceneFile& scene, const DeviceImages* images) {
    std::vector<std::string> found;
    const bool fromDepth = scene.channels[PEL_SLOT_POSITION].empty();
    if (fromDepth && scene.channels[PEL_SLOT_DEPTH].empty()) return found;
    if (fromDepth) {
        float furthest = 0;  // distance outside the range of device depth, on either side
        eachPixel(gbuffer, scene, images, PEL_SLOT_DEPTH, [&](const float* v, size_t) {
            if (std::isfinite(v[0]) && std::abs(v[0]) > std::abs(furthest)) furthest = v[0];
        });
        if (std::abs(furthest) > 1.001f) {
            found.push_back("the depth channel reaches " + shown(furthest) + ", but device depth " +
                            (furthest > 0 ? "ends at 1" : "is -1 or more") +
                            ": it looks like a distance along the view; name a position channel, or write "
                            "the depth that the projection gives");
            return found;
        }
    }
    const Imath::Box3d extent = extentOf(gbuffer, scene, images);
    if (extent.isEmpty()) return found;
    const auto size = float(extent.size()[int(extent.majorAxis())] * scene.options.millimetresPerUnit);
    for (const SceneMaterial& m : scene.materials) {
        if (m.profile.empty()) continue;
        const float reach = findProfile(m.profile).profile.info().reach;
        // An object of skin is not smaller than a fingertip, nor larger than a few people; through wax light
        // travels further.
        if (size > std::min(2.3f * reach, fingertip) && size < 500 * reach) continue;
        found.push_back(
            concat("the visible scene is ", shown(size),
                   " mm across with unit_mm = ", shown(scene.options.millimetresPerUnit),
                   ", but light travels ", shown(reach), " mm in the profile of material ", m.id,
                   ": set unit_mm to the millimetres in a unit of the positions",
                   (fromDepth ? ", or check that the depth is what inverse_view_projection takes, not a "
                                "distance along the view"
                              : "")));
    }
    return found;
}

}  // namespace pellucid::io
