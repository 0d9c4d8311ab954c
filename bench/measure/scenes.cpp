#include "scenes.h"

#include "io/image/flip.h"
#include "io/image/image_file.h"
#include "measure.h"
#include "sample/random_walk.h"

namespace pellucid::bench {
namespace {

using namespace lit_scenes;

constexpr size_t truthPoints = 640, clipPoints = 256;
constexpr int cropSide = 48;
constexpr uint32_t truthWalks = 256, clipWalks = 64, cropWalks = 1024,
                   partWalks = 48;  // for each point, channel and half
constexpr int pictureSize = 512, clipSize = 256, mapSize = 2048;
constexpr std::array<double, 3> burleyLengths{0.29205, 0.10902, 0.05411};  // mm

SceneRequest requestOf(double azimuth, double lightAzimuth, double lightElevation, double elevation = 5) {
    SceneRequest r;
    r.azimuth = azimuth, r.elevation = elevation;
    r.lightAzimuth = lightAzimuth, r.lightElevation = lightElevation;
    r.size = pictureSize, r.mapSize = mapSize;
    return r;
}

Body wholeHead(const std::string& file) {
    return head(file, "head", 3);
}
// `size` mm a side round the vertex that is nearest to `at`.
std::function<Body(const std::string&)> partOfHead(const char* name, sample::Vec3 at, double size) {
    return [=](const std::string& file) {
        return closeUp(
            wholeHead(file), name, [=](sample::Vec3 p) { return -length(p - at); }, size);
    };
}

// As many of the covered pixels, each from a stretch of rows of its own.
std::vector<size_t> drawn(const LitScene& s, size_t count) {
    std::vector<size_t> covered, some;
    for (size_t i = 0; i < s.covered.size(); ++i)
        if (s.covered[i]) covered.push_back(i);
    count = std::min(count, covered.size());
    std::mt19937 random(1);
    for (size_t k = 0; k < count; ++k) {
        const size_t begin = covered.size() * k / count, end = covered.size() * (k + 1) / count;
        some.push_back(covered[begin + random() % (end - begin)]);
    }
    return some;
}

std::vector<float> at(const std::vector<float>& rgb, const std::vector<size_t>& pixels) {
    std::vector<float> some;
    for (const size_t i : pixels) some.insert(some.end(), &rgb[3 * i], &rgb[3 * i] + 3);
    return some;
}

std::string fileOf(const std::string& folder, const std::string& name) {
    return folder + "/" + name + ".npy";
}

// `layers` of as many RGB values.
void write(const std::string& path, const std::vector<std::vector<float>>& layers,
           io::ChannelType type = io::ChannelType::Half) {
    std::vector<float> all;
    for (const std::vector<float>& layer : layers) all.insert(all.end(), layer.begin(), layer.end());
    const size_t shape[] = {layers.size(), layers[0].size() / 3, 3};
    io::writeNpy(path, shape, all, type);
}
std::vector<std::vector<float>> readLayers(const std::string& path, size_t values, size_t least = 2) {
    const io::NpyArray array = io::readNpy(path);
    if (array.shape.size() != 3 || array.shape[1] * 3 != values || array.shape[0] < least)
        throw std::runtime_error(path + " is the truth of another scene");
    std::vector<std::vector<float>> layers;
    for (size_t k = 0; k < array.shape[0]; ++k)
        layers.emplace_back(&array.values[k * values], &array.values[k * values] + values);
    return layers;
}
// The last layer must be `places`, so that light is compared where it was made.
std::vector<std::vector<float>> read(const std::string& path, const std::vector<float>& places) {
    std::vector<std::vector<float>> layers = readLayers(path, places.size());
    for (size_t i = 0; i < places.size(); ++i)  // 11 bits of a length
        if (!(std::abs(layers.back()[i] - places[i]) <= 1e-3f * std::abs(places[i]) + 0.02f))
            throw std::runtime_error(path + " is the truth of another scene: a point of it is elsewhere");
    layers.pop_back();
    return layers;
}

// The pixels, row by row, of the fully covered window in which unscattered light varies most, so that
// scattering changes most. Of equal windows, the one nearest to the picture's middle.
std::vector<size_t> croppedPixels(const LitScene& s) {
    std::vector<size_t> best, window;
    std::pair<double, int> bestRank{-1, 0};
    constexpr int step = 4;
    for (int y = 0; y + cropSide <= s.height; y += step)
        for (int x = 0; x + cropSide <= s.width; x += step) {
            window.clear();
            double sum = 0, squares = 0;
            for (int k = 0; k < cropSide * cropSide; ++k) {
                const size_t i = size_t(y + k / cropSide) * size_t(s.width) + size_t(x + k % cropSide);
                if (!s.covered[i]) break;
                window.push_back(i);
                sum += s.irradiance[3 * i], squares += std::pow(s.irradiance[3 * i], 2);
            }
            if (window.size() < size_t(cropSide) * cropSide) continue;
            const std::pair rank{
                squares - sum * sum / double(window.size()),
                -std::abs(2 * x + cropSide - s.width) - std::abs(2 * y + cropSide - s.height)};
            if (rank > bestRank) bestRank = rank, best = window;
        }
    return best;
}

using Say = std::function<void(double)>;

sample::WalkedLight walk(const Stage& stage, const LitScene& s, const std::vector<size_t>& pixels,
                         double scale, uint32_t walks, const Say& say) {
    std::array<double, 3> d = burleyLengths;
    for (double& length : d) length *= scale;
    std::vector<double> ignored;
    const sample::WalkBody body(stage.scene(), stage.material());
    // Where another body is nearest, a point a little inside finds its own.
    const std::vector<sample::SurfacePoint> near =
        sample::nearestPoints(body.body(), at(s.positions, pixels), ignored);
    std::vector<sample::SurfacePoint> places;
    for (const sample::SurfacePoint& p : near) places.push_back({body.litTriangle(p.triangle), p.weights});
    const std::array<double, 3> white{sceneAlbedo, sceneAlbedo, sceneAlbedo};
    return walkLight(body, s.lighting, places, sample::burleyMedium(d, white, sample::Boundary::IndexMatched),
                     {walks, 0, 1, say});
}

void makeScene(const Device& device, const std::string& path, const Stage& stage, const FrozenScene& scene,
               double scale, const Say& say) {
    SceneRequest request = scene.request;
    request.profileScale = scale;
    LitScene s = stage.look(request, usualProfile());
    const std::vector<size_t> pixels = drawn(s, truthPoints);
    const sample::WalkedLight light = walk(stage, s, pixels, scale, truthWalks, say);
    LitScene few = s;  // the integral at the drawn pixels alone
    few.covered.assign(s.covered.size(), 0);
    for (const size_t i : pixels) few.covered[i] = 1;
    stage.addTruth(device, few, usualProfile(), scale);
    std::vector<float> surface = at(few.truth, pixels);
    for (float& v : surface) v *= sceneAlbedo;
    write(path, {light.first, light.second, surface, at(s.positions, pixels)});
}

void makeCrop(const std::string& path, const Stage& stage, const FrozenScene& scene, double scale,
              const Say& say) {
    const LitScene s = stage.look(scene.request, usualProfile());
    const sample::WalkedLight light = walk(stage, s, croppedPixels(s), scale, cropWalks, say);
    write(path, {light.first, light.second});
}

// Where the mean of the 2 x 2 pixels with pixel `i` of a square begins.
size_t meanOf(size_t i, size_t side) {
    return 3 * (i / side / 2 * (side / 2) + i % side / 2);
}

void makePart(const ShownPart& part, const std::string& path, const Stage& stage, const FrozenScene& scene,
              double scale, const Say& say) {
    SceneRequest request = scene.request;
    request.profileScale = scale;
    const LitScene s = stage.look(request, usualProfile());
    const std::vector<size_t> all = part.pixels(s);
    std::vector<size_t> covered;
    std::ranges::copy_if(all, std::back_inserter(covered), [&](size_t i) { return s.covered[i]; });
    const sample::WalkedLight light = walk(stage, s, covered, scale, partWalks, say);
    const size_t side = size_t(part.side(s));
    std::vector<float> means(3 * all.size() / 4);
    for (size_t i = 0, next = 0; i < all.size(); ++i) {
        if (!s.covered[all[i]]) continue;
        float* mean = &means[meanOf(i, side)];
        for (size_t c = 0; c < 3; ++c, ++next) mean[c] += (light.first[next] + light.second[next]) / 8;
    }
    write(path, {means});
}

// The pixels of `frame` that show these points; SIZE_MAX: none within a pixel's width.
std::vector<size_t> pixelsThatShow(const LitScene& frame, const std::vector<float>& points) {
    std::vector<size_t> found;
    for (size_t p = 0; p < points.size(); p += 3) {
        size_t best = SIZE_MAX;
        float nearest = 1;  // mm^2
        for (size_t i = 0; i < frame.covered.size(); ++i) {
            if (!frame.covered[i]) continue;
            float d = 0;
            for (size_t c = 0; c < 3; ++c) d += std::pow(frame.positions[3 * i + c] - points[p + c], 2.0f);
            if (d < nearest) nearest = d, best = i;
        }
        found.push_back(best);
    }
    return found;
}

std::vector<std::vector<size_t>> clipPixels(const std::vector<LitScene>& frames) {
    const std::vector<float> points = at(frames[0].positions, drawn(frames[0], clipPoints));
    std::vector<std::vector<size_t>> pixels;
    for (const LitScene& frame : frames) pixels.push_back(pixelsThatShow(frame, points));
    return pixels;
}

}  // namespace

Profile usualProfile() {
    float path[3];
    for (int c = 0; c < 3; ++c) path[c] = float(1.05 * burleyLengths[size_t(c)]);
    const float albedos[3] = {sceneAlbedo, sceneAlbedo, sceneAlbedo};
    return Profile::burley(path, albedos, PEL_BURLEY_SEARCHLIGHT);
}

const std::vector<FrozenScene>& frozenScenes() {
    static const std::vector<FrozenScene> scenes{
        {"side", "head, light from the side", wholeHead, requestOf(25, 80, 20), 1, true},
        {"ear", "head and ear, light from behind", wholeHead, requestOf(70, 200, 10), 1, true},
        {"eye", "corner of an eye, close up", partOfHead("eye", {25, 122, 68}, 34), requestOf(20, 70, 25)},
        {"lips", "lips, close up", partOfHead("lips", {6, 72, 91}, 36), requestOf(10, 60, 35)},
        {"ball", "ball of 10 mm", [](const std::string&) { return ball(10, 320); }, requestOf(0, 80, 20), 1,
         true},
        {"leaf", "leaf of 1 mm, light from behind", [](const std::string&) { return leaf(160); },
         requestOf(25, 200, 10)},
        {"touching", "two balls of two materials that touch",
         [](const std::string&) { return twoBalls(6, 200); }, requestOf(0, 60, 20), 2},
        {"pores", "pores in grazing light", [](const std::string&) { return relief(320, 6, pores); },
         requestOf(0, 80, 8)}};
    return scenes;
}

SceneRequest clipRequest(const FrozenClip& clip, int frame) {
    SceneRequest request = frozenScenes()[0].request;
    request.size = clipSize;
    request.profileScale = clipScale;
    request.lightAzimuth += clip.lightStep * frame;
    request.azimuth += clip.cameraStep * frame;
    return request;
}

Truth readTruth(const std::string& folder, const std::string& name, const LitScene& scene) {
    Truth t{drawn(scene, truthPoints), {}, {}, {}};
    const auto layers = read(fileOf(folder, name), at(scene.positions, t.pixels));
    if (layers.size() != 3) throw std::runtime_error(fileOf(folder, name) + " has no two halves");
    t.first = layers[0], t.second = layers[1], t.surface = layers[2];
    return t;
}

Crop readCrop(const std::string& folder, const std::string& name, const LitScene& scene) {
    Crop crop{croppedPixels(scene), cropSide, {}, 0};
    const std::vector<std::vector<float>> halves =
        readLayers(fileOf(folder, "crop-" + name), 3 * crop.pixels.size());
    for (size_t i = 0; i < halves[0].size(); ++i) crop.light.push_back((halves[0][i] + halves[1][i]) / 2);
    // The difference of a half from the mean is as large as that of the mean from the true light.
    crop.noise = io::flip(halves[0], crop.light, cropSide);
    return crop;
}

std::vector<size_t> ShownPart::pixels(const LitScene& s) const {
    const int across = side(s), x0 = int(x * s.width) - across / 2, y0 = int(y * s.height) - across / 2;
    std::vector<size_t> all;
    for (int k = 0; k < across * across; ++k)
        all.push_back(size_t(y0 + k / across) * size_t(s.width) + size_t(x0 + k % across));
    return all;
}

std::vector<float> readPart(const std::string& folder, const ShownPart& part, const LitScene& scene) {
    const size_t side = size_t(part.side(scene)), count = side * side;
    const std::vector<float> means =
        readLayers(fileOf(folder, std::string("part-") + part.scene), 3 * count / 4, 1)[0];
    std::vector<float> light;
    for (size_t i = 0; i < count; ++i) {
        const float* mean = &means[meanOf(i, side)];
        light.insert(light.end(), mean, mean + 3);
    }
    return light;
}

ClipTruth readClip(const std::string& folder, const FrozenClip& clip, const std::vector<LitScene>& frames) {
    ClipTruth t{clipPixels(frames), {}};
    t.light = read(fileOf(folder, clip.name), at(frames[0].positions, t.pixels[0]));
    return t;
}

KeptPictures readPictures(const std::string& folder, const std::string& name, const LitScene& scene,
                          size_t methods) {
    KeptPictures kept{drawn(scene, truthPoints), {}};
    const std::string path = fileOf(folder, "pictures-" + name);
    kept.light = read(path, at(scene.positions, kept.pixels));
    if (kept.light.size() != methods) throw std::runtime_error(path + " has pictures of other methods");
    return kept;
}

void writePictures(const std::string& folder, const std::string& name, const LitScene& scene,
                   const std::vector<std::vector<float>>& wholePictures) {
    const std::vector<size_t> pixels = drawn(scene, truthPoints);
    std::vector<std::vector<float>> layers;
    for (const std::vector<float>& picture : wholePictures) layers.push_back(at(picture, pixels));
    layers.push_back(at(scene.positions, pixels));
    write(fileOf(folder, "pictures-" + name), layers, io::ChannelType::Float);
}

void makeTruth(const Device& device, const std::string& folder, const std::string& headFile,
               const std::function<void(const std::string&)>& say, const std::function<bool()>& cancelled) {
    std::filesystem::create_directories(folder);
    const auto progress = [&](const std::string& name) {
        return [&, name, told = -1](double fraction) mutable {
            if (cancelled()) throw pellucid::Error(PEL_ERROR_CANCELLED, "the truth was not made whole");
            if (int(10 * fraction) > told) say(name + ": " + std::to_string(10 * ++told) + " %");
        };
    };
    for (const FrozenScene& scene : frozenScenes()) {
        std::optional<Stage> stage;
        for (const double scale : radiusScales) {
            const std::string name = scene.name + ("-" + std::to_string(int(scale)));
            const auto makeMissing = [&](const std::string& file, const char* what, const auto& make) {
                const std::string path = fileOf(folder, file);
                if (std::filesystem::exists(path)) return;
                if (!stage) stage.emplace(device, scene.body(headFile), 1);
                make(path, *stage, scene, scale, progress(name + what));
            };
            makeMissing(name, "", std::bind_front(makeScene, std::cref(device)));
            makeMissing("crop-" + name, ", cropped", makeCrop);
            for (const ShownPart& part : shownParts)
                if (name == part.scene)
                    makeMissing("part-" + name, ", shown", std::bind_front(makePart, std::cref(part)));
        }
    }
    const Stage stage(device, frozenScenes()[0].body(headFile), 1);
    for (const FrozenClip& clip : frozenClips) {
        if (std::filesystem::exists(fileOf(folder, clip.name))) continue;
        std::vector<LitScene> frames;
        for (int k = 0; k < clipFrames; ++k)
            frames.push_back(stage.look(clipRequest(clip, k), usualProfile()));
        const std::vector<std::vector<size_t>> pixels = clipPixels(frames);
        std::vector<std::vector<float>> layers;
        for (int k = 0; k < clipFrames; ++k) {
            std::vector<size_t> shown = pixels[size_t(k)];
            for (size_t& pixel : shown)
                if (pixel == SIZE_MAX) pixel = pixels[0][0];  // nobody reads it
            const Say tell = progress(clip.name + (", frame " + std::to_string(k)));
            // With one seed the paths are the same in every frame: differences come only from the light.
            const sample::WalkedLight light =
                walk(stage, frames[size_t(k)], shown, clipScale, clipWalks, tell);
            layers.push_back(light.first);
            for (size_t i = 0; i < light.first.size(); ++i)
                layers.back()[i] = 0.5f * (light.first[i] + light.second[i]);
        }
        layers.push_back(at(frames[0].positions, pixels[0]));
        write(fileOf(folder, clip.name), layers);
    }
}

}  // namespace pellucid::bench
