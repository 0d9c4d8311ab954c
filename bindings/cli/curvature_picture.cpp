#include "curvature_picture.h"

#include "head/curvature_view.h"
#include "io/image/image_file.h"

namespace pellucid::cli {
namespace {

constexpr int viewWidth = 900, viewHeight = 1000;

}  // namespace

void writeCurvaturePicture(const std::string& path, const io::MeshData& mesh, const std::vector<float>& values,
                           float low, float high, char up, const std::string& unit) {
    sample::MeshView viewed;
    viewed.positions = mesh.positions;
    viewed.normals = mesh.normals;
    viewed.curvature = values;
    viewed.triangles = mesh.triangles;
    const sample::Scene scene(viewed);
    const auto view = [&](double azimuth) {
        sample::Framing framing;
        framing.azimuth = azimuth;
        return head::curvatureView(scene, sample::poseWithUp(up), framing, viewWidth, viewHeight, 2, low, high);
    };
    const io::Picture bar = io::colorBar(2 * viewWidth - 40, low, high, unit);
    io::Picture page(2 * viewWidth, viewHeight + bar.height + 40, head::viewBackground);
    page.paste(0, 0, view(0));
    page.paste(viewWidth, 0, view(60));
    page.paste(20, viewHeight + 20, bar);
    io::writeImage8(path, page.width, page.height, 3, page.rgb);
}

}  // namespace pellucid::cli
