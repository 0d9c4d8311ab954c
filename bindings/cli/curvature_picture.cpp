#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "mesh_curvature.h"
#include "sample/gbuffer.h"

namespace pellucid::cli {

constexpr int viewWidth = 900, viewHeight = 1000;
constexpr io::Srgb8 background{20, 20, 20};

// Shaded a little darker where the surface turns away from the view.
static io::Picture curvatureView(const sample::Scene& scene, char up, double azimuth, float low, float high) {
    constexpr int supersampling = 2, width = supersampling * viewWidth, height = supersampling * viewHeight;
    sample::Framing framing;
    framing.azimuth = azimuth;
    const sample::Camera camera =
        frameHead(scene.bounds(), sample::poseWithUp(up), framing, double(width) / height);
    sample::GBufferOptions options;
    options.detail.enabled = false;
    const sample::GBuffer g = renderGBuffer(scene, camera, width, height, options);
    io::Picture picture =
        io::colored(width, height, g.curvature.data, low, high, g.coverage.data, background);
    const sample::Vec3 toEye = camera.forward() * -1.0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (g.coverage.at(0, x, y) == 0) continue;
            const double cosine = dot(sample::vectorAt(g.geometricNormal, x, y), toEye);
            const float facing = float(0.55 + 0.45 * std::abs(cosine));
            uint8_t* rgb = &picture.rgb[3 * (size_t(y) * size_t(width) + size_t(x))];
            for (int c = 0; c < 3; ++c)
                rgb[c] =
                    uint8_t(255.0f * io::encodeSrgb(facing * io::decodeSrgb(float(rgb[c]) / 255.0f)) + 0.5f);
        }
    return io::shrunk(picture, supersampling);
}

void writeCurvaturePicture(const std::string& path, const io::MeshData& mesh,
                           const std::vector<float>& values, float low, float high, char up,
                           const std::string& unit) {
    const sample::Scene scene(sample::MeshView{mesh.positions, mesh.normals, {}, values, mesh.triangles, {}});
    const io::Picture bar = io::colorBar(2 * viewWidth - 40, low, high, unit);
    io::Picture page(2 * viewWidth, viewHeight + bar.height + 40, background);
    page.paste(0, 0, curvatureView(scene, up, 0, low, high));
    page.paste(viewWidth, 0, curvatureView(scene, up, 60, low, high));
    page.paste(20, viewHeight + 20, bar);
    io::writeImage8(path, page.width, page.height, 3, page.rgb);
}

}  // namespace pellucid::cli
