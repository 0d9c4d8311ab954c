// Draws docs/figures/eye_pupils.png, eye_caustic.png, eye_limbus.png and eye_tracer.png:
//   sweep_eye_pictures FOLDER

#include "eye/eye_picture.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "io/image/tone_map.h"

using namespace pellucid;
using namespace eye_test;

namespace {

constexpr int side = 320;

// An eye that faces the camera, with a drawn iris, under a soft light and a lamp from `toLight`.
EyeScene portrait(Vec3 toLight, double strength = 1.1) {
    EyeScene scene;
    scene.size = side;
    scene.eye.gaze[0] = 0.12f, scene.eye.gaze[1] = 0.05f, scene.eye.gaze[2] = 1;
    for (float& c : scene.eye.center) c = 0;
    const float color[3] = {0.5f, 0.62f, 0.75f};
    for (int c = 0; c < 3; ++c) scene.eye.irisColor[c] = color[c];
    scene.camera = {0, 0.3, 14};
    scene.addLight(toLight, {strength, 0.95 * strength, 0.88 * strength});
    for (float& c : scene.ambient.constant) c = 0.16f;
    return scene;
}

io::Picture developed(const std::vector<float>& rgb) {
    io::ToneMap map;
    map.exposure = 1.5f;
    return io::Picture(side, side, io::toSrgb8(rgb, map));
}

io::Picture shaded(const EyeScene& scene) {
    return developed(EyePicture(scene).shade());
}

void write(const std::string& folder, const std::string& name, const std::vector<io::Tile>& tiles) {
    const io::Picture sheet = io::contactSheet(tiles, int(tiles.size()), 1);
    io::writeImage8(folder + "/" + name, sheet.width, sheet.height, 3, sheet.rgb);
}

void pupils(const std::string& folder) {
    std::vector<io::Tile> tiles;
    for (const auto& [radius, label] : {std::pair{1.0f, "pupil 1 mm"}, {2.0f, "2 mm"}, {3.5f, "3.5 mm"}}) {
        EyeScene scene = portrait({0.5, 0.6, 0.8});
        scene.eye.pupilRadius = radius;
        tiles.push_back({label, shaded(scene)});
    }
    write(folder, "eye_pupils.png", tiles);
}

// A lamp beside the eye, and little else; a brown iris.
EyeScene aside(double x) {
    EyeScene scene = portrait({x, 0.15, 0.3}, 1.3);
    for (int c = 0; c < 3; ++c) scene.eye.irisColor[c] = 0.55f - 0.12f * float(c);
    for (float& c : scene.sclera.albedo) c *= 0.6f;
    for (float& c : scene.ambient.constant) c = 0.05f;
    return scene;
}

void caustic(const std::string& folder) {
    std::vector<io::Tile> tiles;
    for (const auto& [x, label] : {std::pair{-1.0, "light from the left"}, {1.0, "from the right"}}) {
        EyeScene scene = aside(x);
        tiles.push_back({label, shaded(scene)});
    }
    EyeScene flat = aside(1);
    flat.eye.corneaIndex = flat.eye.aqueousIndex = 1;
    tiles.push_back({"the same, index 1: no caustic", shaded(flat)});
    write(folder, "eye_caustic.png", tiles);
}

void limbus(const std::string& folder) {
    std::vector<io::Tile> tiles;
    for (const auto& [darkening, label] : {std::pair{0.0f, "darkening 0"}, {0.6f, "0.6"}, {0.9f, "0.9"}}) {
        EyeScene scene = portrait({0.5, 0.6, 0.8});
        scene.eye.limbusDarkening = darkening;
        scene.eye.gaze[0] = -0.6f;
        tiles.push_back({label, shaded(scene)});
    }
    write(folder, "eye_limbus.png", tiles);
}

void tracer(const std::string& folder) {
    EyeScene scene = portrait({0.9, 0.3, 0.35}, 1.4);
    scene.camera = {3.2, 1.2, 6.5};
    scene.makeTexture(256);
    for (float& v : scene.texture) v *= 0.6f;
    for (float& c : scene.eye.irisColor) c = -1;
    const EyePicture picture(scene);
    const std::vector<float> is = picture.shade();
    const std::vector<double> truth = picture.trace(20'000'000);
    std::vector<float> should(truth.begin(), truth.end()), difference;
    for (size_t i = 0; i < is.size(); ++i) difference.push_back(std::abs(is[i] - should[i]) * 10);
    const PictureError error = differenceOf(picture, is, truth);
    std::printf("tracer: RMS %.3g, worst %.3g\n", error.rms, error.worst);
    write(folder, "eye_tracer.png",
          {{"this library", developed(is)},
           {"tracer, double precision", developed(should)},
           {"difference x 10", developed(difference)}});
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 2) throw std::invalid_argument("sweep_eye_pictures FOLDER");
        pupils(argv[1]);
        caustic(argv[1]);
        limbus(argv[1]);
        tracer(argv[1]);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
