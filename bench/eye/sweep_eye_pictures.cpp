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

io::Tile tile(const char* label, const EyeScene& scene) {
    return {label, developed(EyePicture(scene).shade())};
}

void write(const std::string& file, const std::vector<io::Tile>& tiles) {
    const io::Picture sheet = io::contactSheet(tiles, int(tiles.size()), 1);
    io::writeImage8(file, sheet.width, sheet.height, 3, sheet.rgb);
}

EyeScene withPupil(float radius) {
    EyeScene scene = portrait({0.5, 0.6, 0.8});
    scene.eye.pupilRadius = radius;
    return scene;
}

EyeScene withLimbus(float darkening) {
    EyeScene scene = portrait({0.5, 0.6, 0.8});
    scene.eye.limbusDarkening = darkening;
    scene.eye.gaze[0] = -0.6f;
    return scene;
}

// A lamp beside the eye, and little else; a brown iris.
EyeScene aside(double x) {
    EyeScene scene = portrait({x, 0.15, 0.3}, 1.3);
    for (int c = 0; c < 3; ++c) scene.eye.irisColor[c] = 0.55f - 0.12f * float(c);
    for (float& c : scene.sclera.albedo) c *= 0.6f;
    for (float& c : scene.ambient.constant) c = 0.05f;
    return scene;
}

void tracer(const std::string& file) {
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
    write(file, {{"this library", developed(is)},
                 {"tracer, double precision", developed(should)},
                 {"difference x 10", developed(difference)}});
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 2) throw std::invalid_argument("sweep_eye_pictures FOLDER");
        const std::string folder = argv[1];
        write(folder + "/eye_pupils.png", {tile("pupil 1 mm", withPupil(1)), tile("2 mm", withPupil(2)),
                                           tile("3.5 mm", withPupil(3.5f))});
        EyeScene flat = aside(1);
        flat.eye.corneaIndex = flat.eye.aqueousIndex = 1;
        write(folder + "/eye_caustic.png",
              {tile("light from the left", aside(-1)), tile("from the right", aside(1)),
               tile("the same, index 1: no caustic", flat)});
        write(folder + "/eye_limbus.png", {tile("darkening 0", withLimbus(0)), tile("0.6", withLimbus(0.6f)),
                                           tile("0.9", withLimbus(0.9f))});
        tracer(folder + "/eye_tracer.png");
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
