// A mesh coloured by a value at its vertices, seen by one camera.
#pragma once
#include <cmath>

#include "io/image/picture.h"
#include "sample/gbuffer.h"

namespace pellucid::head {

constexpr io::Srgb8 viewBackground{20, 20, 20};

// Darkened a little where the surface turns away, so that its shape can be read. Rendered `supersampling` times as wide and high.
inline io::Picture curvatureView(const sample::Scene& scene, const sample::HeadPose& pose,
                                 const sample::Framing& framing, int width, int height, int supersampling,
                                 float low, float high) {
    width *= supersampling, height *= supersampling;
    const sample::Camera camera = frameHead(scene.bounds(), pose, framing, double(width) / height);
    sample::GBufferOptions options;
    options.detail.enabled = false;
    const sample::GBuffer g = renderGBuffer(scene, camera, width, height, options);
    io::Picture picture =
        io::colored(width, height, g.curvature.data, low, high, g.coverage.data, viewBackground);
    const sample::Vec3 toEye = camera.forward() * -1.0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (g.coverage.at(0, x, y) == 0) continue;
            const sample::Vec3 n{g.geometricNormal.at(0, x, y), g.geometricNormal.at(1, x, y),
                                 g.geometricNormal.at(2, x, y)};
            const float facing = float(0.55 + 0.45 * std::abs(dot(n, toEye)));
            uint8_t* rgb = &picture.rgb[3 * (size_t(y) * size_t(width) + size_t(x))];
            for (int c = 0; c < 3; ++c)
                rgb[c] =
                    uint8_t(255.0f * io::encodeSrgb(facing * io::decodeSrgb(float(rgb[c]) / 255.0f)) + 0.5f);
        }
    return io::shrunk(picture, supersampling);
}

}  // namespace pellucid::head
