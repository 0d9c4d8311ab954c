// The time and the error of the methods of scattering on the frozen scenes.

#include "io/choice_keys.h"
#include "io/image/flip.h"
#include "io/image/picture_library.h"
#include "io/image/tone_map.h"
#include "io/shortest.h"
#include "measure.h"
#include "power.h"
#include "report.h"
#include "scenes.h"

namespace pellucid::bench {
namespace {

using namespace lit_scenes;
using Json = nlohmann::ordered_json;

struct Setting {
    std::string method, setting;
    ShadeRequest request;
    int mapSize = 0;              // 0: the scene's
    bool quick = false;           // with --quick too
    bool shown = false;           // the setting of this method that pictures, frames and clips have
    bool moving = false;          // in frames and clips too, beside a history that needs several frames
    double budget = 0;            // of time, ns per pixel of skin; 0: none
    bool thickness = false;       // PEL_SLOT_THICKNESS is given
    int texture = 0;              // texels a side of the texture that is scattered; 0: none
    const char* tunes = nullptr;  // its name in records for PelShaderOptions.timeBudget

    std::string name() const { return method + (setting.empty() ? "" : ", " + setting); }
};

// New methods are added here. All make their own shadows from the light's map.
std::vector<Setting> settings() {
    std::vector<Setting> all;
    const auto add = [&](const char* method, const std::string& setting, PelScattering scattering) -> auto& {
        return all.emplace_back(
            Setting{method, setting, {.scattering = scattering, .gain = 1, .count = false}});
    };
    const auto text = [](double v, const char* unit) { return io::printed("%g %s", v, unit); };
    Setting& plain = add("Lambert", "", PEL_SCATTERING_NONE);
    plain.quick = plain.shown = true;
    plain.tunes = "none";
    for (const uint32_t size : {16u, 64u, 256u}) {
        Setting& s = add("pre-integrated", text(size, "texels"), PEL_SCATTERING_PREINTEGRATED);
        s.request.tableSize = size;
        s.quick = s.shown = size == 64;
        if (s.quick) s.tunes = "preintegrated";
    }
    Setting& everyPixel = add("pre-integrated", "64 texels, every pixel", PEL_SCATTERING_PREINTEGRATED);
    everyPixel.request.everyPixel = true, everyPixel.request.tableSize = 64;
    for (const uint32_t size : {128u, 512u}) {
        Setting& s = add("FaceWorks", text(size, "texels"), PEL_SCATTERING_PREINTEGRATED);
        s.request.tableSize = size;
        s.request.faceworks = true;
        s.quick = s.shown = size == 512;
    }
    for (const uint32_t taps : {9u, 17u, 25u, 51u, 101u}) {
        Setting& s = add("separable", "2 x " + text(taps, "taps"), PEL_SCATTERING_SEPARABLE);
        s.request.scatterTaps = taps;
        s.quick = taps == 9 || taps == 25, s.shown = taps == 25;
    }
    for (const uint32_t taps : {8u, 16u, 32u, 64u, 128u}) {
        Setting& s = add("disk", text(taps, "taps"), PEL_SCATTERING_SCREEN);
        s.request.scatterTaps = taps;
        s.quick = taps == 8 || taps == 32, s.shown = taps == 32, s.moving = taps == 8;
    }
    add("separable", "2 x 25 taps, half rate", PEL_SCATTERING_SEPARABLE).request.halfRate = true;
    Setting& half = add("disk", "32 taps, half rate", PEL_SCATTERING_SCREEN);
    half.request.scatterTaps = 32, half.request.halfRate = half.moving = true;
    for (const bool halfRate : {false, true}) {
        Setting& s =
            add("disk", halfRate ? "8 taps, half rate, history" : "8 taps, history", PEL_SCATTERING_SCREEN);
        s.request.scatterTaps = 8, s.request.halfRate = halfRate, s.request.historyWeight = 0.8f;
        s.moving = true, s.quick = !halfRate;
    }
    for (const double target : {0.0, 5e-4, 2e-3, 5e-3, 1e-2, 2e-2}) {
        Setting& s = add("auto", "error " + text(target, "of white"), PEL_SCATTERING_AUTO);
        s.request.targetError = float(target);
        s.shown = s.request.targetError == pelShaderOptionsDefaults().targetError;
        s.quick = s.shown || target == 1e-2;
        s.tunes = "auto";
    }
    for (const int size : {512, 1024})
        add("auto", "map of " + text(size, "texels"), PEL_SCATTERING_AUTO).mapSize = size;
    add("auto", withThickness, PEL_SCATTERING_AUTO).thickness = true;
    Setting& light = add("light", "map of 2048 texels", PEL_SCATTERING_LIGHT);
    light.quick = light.shown = true;
    light.tunes = "light";
    Setting& halfLight = add("light", "half rate", PEL_SCATTERING_LIGHT);
    halfLight.request.halfRate = true, halfLight.tunes = "light-half";
    for (const int size : {512, 1024})
        add("light", "map of " + text(size, "texels"), PEL_SCATTERING_LIGHT).mapSize = size;
    for (const int size : {1024, 2048})
        add("texture", text(size, "texels a side"), PEL_SCATTERING_TEXTURE).texture = size;
    for (const double budget : {25.0, 60.0, 150.0, 600.0, 6000.0}) {
        Setting& s = add("auto", "budget of " + text(budget, "ns a pixel"), PEL_SCATTERING_AUTO);
        s.budget = budget;
        s.quick = budget == 60 || budget == 150;
    }
    return all;
}

std::vector<float> valuesAt(const std::vector<float>& rgb, const std::vector<size_t>& pixels) {
    std::vector<float> some;
    for (const size_t i : pixels)
        for (size_t c = 0; c < 3; ++c) some.push_back(sceneAlbedo * rgb[3 * i + c]);
    return some;
}

// Adds to `row` the errors of values at the drawn pixels; P99 and CIEDE2000 include the walks' noise.
void addErrors(Json& row, const std::vector<float>& values, const Truth& truth,
               const std::vector<uint8_t>& subsets) {
    const auto compared = [&](const std::vector<uint8_t>& mask) {
        return io::compareImages(values, truth.first, mask, nullptr, truth.second);
    };
    const io::ImageDifference all = compared({});
    row["error_rms"] = all.rmseAll;
    row["rmse"] = all.rmse, row["mean_error"] = all.mean, row["p99"] = all.p99, row["noise"] = all.noise;
    row["delta_e"] = all.deltaEMean, row["delta_e_p99"] = all.deltaE99;
    constexpr std::pair<const char*, io::Subset> parts[] = {{"unlit", io::SUBSET_UNLIT},
                                                            {"terminator", io::SUBSET_TERMINATOR},
                                                            {"penumbra", io::SUBSET_PENUMBRA},
                                                            {"rest", io::SUBSET_REST}};
    for (const auto& [name, bit] : parts) {
        std::vector<uint8_t> mask;
        for (const size_t i : truth.pixels) mask.push_back(subsets[i] & bit);
        const io::ImageDifference part = compared(mask);
        if (part.pixels >= 20) row["subsets"][name] = {{"pixels", part.pixels}, {"rmse", part.rmse}};
    }
}

// Light with a sharp shadow in the texture of a body, scattered there.
class InTexture {
  public:
    InTexture(const Device& device, const sample::Mesh& mesh, const LitScene& s, const Profile& profile,
              double scale, uint32_t side)
        : lighting_(device, side, side), scattered_(device, size_t(side) * side * 3 * sizeof(float)) {
        const auto vertices = uint32_t(mesh.positions.size() / 3);
        PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
        desc.width = desc.height = side;
        desc.numVertices = vertices, desc.numIndices = mesh.triangles.size();
        desc.indices = mesh.triangles.data(), desc.uvs = mesh.uvs.data();
        scatter_ = TextureScatter(device, desc);
        const Buffer positions(device, mesh.positions), normals(device, mesh.normals);
        scatter_.setPositions(vertexView(positions, vertices));
        for (const auto& [slot, values] :
             {std::pair{PEL_SLOT_POSITION, &positions}, {PEL_SLOT_NORMAL_SHADING, &normals}}) {
            const Buffer image(device, scattered_.bytes());
            scatter_.draw(vertexView(*values, vertices), slot != PEL_SLOT_POSITION, imageOf(image));
            lighting_.shader.set(slot, imageOf(image));
        }
        lighting_.shader.setMaterial(1, scatter_scene::whiteMaterial(Profile(), PEL_SCATTERING_NONE))
            .set(std::vector<PelLight>{s.lamps[0].light});
        lighting_.setMap(PEL_LIGHT_SHADOW_MAP, s.lamps[0].maps[0], s.lamps[0].width, s.lamps[0].height);
        lighting_.shader.commit();
        params_.profile = profile.get(), params_.scale = float(scale);
    }
    // Returns the time in milliseconds.
    double run() {
        lighting_.shader.execute();
        scatter_.execute(params_, imageOf(lighting_.out), nullptr, imageOf(scattered_));
        return lighting_.shader.stats().deviceMilliseconds + scatter_.stats().deviceMilliseconds;
    }
    std::vector<float> texture() const { return scattered_.readAll<float>(); }
    uint64_t bytes() { return scatter_.stats().scratchBytes + 4 * scattered_.bytes(); }

  private:
    PelImageDesc imageOf(const Buffer& b) const {
        return imageDesc(b, PEL_FORMAT_RGB32F, lighting_.width, lighting_.width);
    }
    scatter_scene::ShownImages lighting_;
    Buffer scattered_;
    TextureScatter scatter_;
    PelTextureScatterParams params_ = pelTextureScatterParamsDefaults();
};

// The scenes in which pictures are compared with those kept; the first one alone with --quick.
constexpr std::pair<const char*, double> keptScenes[] = {{"ball", 4}, {"side", 4}, {"ear", 1}};

// A method at work on a scene, and its times, in milliseconds.
struct Contender {
    Setting setting;
    Shot shot;
    std::shared_ptr<InTexture> texture{};
    std::vector<double> device{}, wall{};
    std::map<std::string, std::vector<double>> passes{};  // by name
    std::optional<double> watts{};

    // Returns milliseconds in the texture.
    double frame() {
        const double before = texture ? texture->run() : 0;
        shot.shader.execute();
        return before;
    }
};

class Methods {
  public:
    // `sends`: rows are sent when they are done, and kept if a later one ends the process.
    explicit Methods(const Request& request, bool sends = false)
        : request_(request), device_(request.device), sends_(sends) {}

    Json measure() {
        for (const FrozenScene& scene : frozenScenes())
            if (scene.quick || !request_.quick) measureScene(scene);
        if (!request_.quick) measureFrames();
        measureClips();
        return {{"scenes", scenes_}, {"operations", rows_}, {"pictures", pictures_}};
    }

    void comparePictures() {
        for (const auto& [of, scale] : keptScenes) {
            if (request_.quick && of != keptScenes[0].first) continue;
            const std::string name = of + ("-" + std::to_string(int(scale)));
            if (!anyLeft(name)) continue;
            attempt(name, "pictures", [&, of = of, scale = scale] {
                request_.say(name + ": the scene is made");
                const FrozenScene& scene = sceneOf(of);
                const LitScene s = lookAt(scene, scale);
                const std::vector<Setting> methods = keptSettings(s);
                const KeptPictures kept = readPictures(request_.data + "/bench", name, s, methods.size());
                for (size_t i = 0; i < methods.size(); ++i) {
                    attemptAlone(name, methods[i], "pictures", [&] {
                        comparePicture(contenderOf(methods[i], scene, s, scale), name, s, kept.pixels,
                                       kept.light[i]);
                    });
                }
            });
            sendRows();
        }
    }
    void keepPictures(const std::string& folder) {
        for (const auto& [of, scale] : keptScenes) {
            const FrozenScene& scene = sceneOf(of);
            const LitScene s = lookAt(scene, scale);
            std::vector<std::vector<float>> pictures;
            for (const Setting& setting : keptSettings(s))
                pictures.push_back(contenderOf(setting, scene, s, scale).shot.light);
            writePictures(folder, of + ("-" + std::to_string(int(scale))), s, pictures);
        }
    }
    // Each method alone: at 4K all of them together need more memory than most devices have.
    void measureFrames() {
        const FrozenScene& scene = frozenScenes()[0];
        std::optional<Stage> stage;
        // `fill`: height of the head over that of the picture; with 4 only skin is seen.
        using Frame = std::tuple<const char*, int, int, double>;
        const std::vector<Frame> frames = request_.quick
                                              ? std::vector<Frame>{{"270p", 480, 270, scene.request.fill}}
                                              : std::vector<Frame>{{"1080p", 1920, 1080, scene.request.fill},
                                                                   {"4K", 3840, 2160, scene.request.fill},
                                                                   {"1080p, all skin", 1920, 1080, 4}};
        for (const auto& [name, width, height, fill] : frames) {
            if (!anyLeft(name)) continue;
            attempt(name, "frames", [&, name = name, width = width, height = height, fill = fill] {
                request_.say(std::string(name) + ": the scene is made");
                if (!stage) stage.emplace(device_, scene.body(headFile()), 1);
                SceneRequest request = scene.request;
                request.width = width, request.size = height, request.fill = fill;
                const LitScene s = stage->look(request, profile_);
                double plain = NAN;
                for (const Setting& setting : frameSettings(s))
                    attemptAlone(name, setting, "frames", [&] {
                        std::vector<Contender> one;
                        one.push_back(contenderOf(setting, scene, s, 1));
                        const double once = one[0].shot.stats.deviceMilliseconds;
                        run(one, name, "frames", int(std::clamp(3000 / once, 1.0, 7.0)));
                        if (setting.method == "Lambert") plain = median(one[0].device);
                        addTimes(one[0], name, "frames", s, plain);
                    });
            });
            sendRows();
        }
    }

  private:
    // A setting of each method.
    static std::vector<Setting> keptSettings(const LitScene& s) {
        std::vector<Setting> kept = settings();
        std::erase_if(kept, [&](const Setting& one) {
            return !one.shown && (one.texture != 1024 || s.gbuffer.uv.data.empty());
        });
        return kept;
    }
    // These, and those at half rate or with a history.
    static std::vector<Setting> frameSettings(const LitScene& s) {
        std::vector<Setting> timed = keptSettings(s);
        std::ranges::copy_if(settings(), std::back_inserter(timed),
                             [](const Setting& one) { return one.request.halfRate || one.moving; });
        return timed;
    }
    static const FrozenScene& sceneOf(const std::string& name) {
        return *std::ranges::find(frozenScenes(), name, [](const FrozenScene& s) { return s.name; });
    }
    std::string headFile() const { return request_.data + "/heads/head_female.obj"; }
    LitScene lookAt(const FrozenScene& scene, double scale) const {
        SceneRequest request = scene.request;
        request.profileScale = scale;
        LitScene s = Stage(device_, scene.body(headFile()), 1).look(request, profile_);
        // Replaces the mesh's curvature, made by the device: each operation is judged separately.
        for (size_t i = 0; i < s.covered.size(); ++i) s.gbuffer.curvature.data[i] = 0.02f * float(1 + i % 10);
        return s;
    }
    // Whether a method is still to be measured in this scene.
    bool anyLeft(const std::string& scene) const {
        return std::ranges::any_of(settings(), [&](const Setting& s) {
            return (s.shown || s.moving || s.texture == 1024) && request_.wants(scene + ": " + s.name());
        });
    }
    template <class Work>
    void attemptAlone(const std::string& scene, const Setting& setting, const char* group, const Work& work) {
        const std::string name = scene + ": " + setting.name();
        if (!request_.wants(name)) return;
        request_.say(name);
        attempt(name, group, work);
        sendRows();
    }
    void sendRows() {
        if (!sends_) return;
        for (const Json& row : rows_) request_.event({{"row", row}});
        rows_.clear();
    }

    Contender contenderOf(const Setting& setting, const FrozenScene& scene, const LitScene& s, double scale) {
        ShadeRequest how = setting.request;
        how.materials = scene.materials;
        how.timeBudget = float(1e-6 * setting.budget * double(s.places.size()));
        std::shared_ptr<InTexture> texture;
        if (setting.texture) {
            texture = std::make_shared<InTexture>(device_, scene.body(headFile()).mesh, s, profile_, scale,
                                                  uint32_t(setting.texture));
            texture->run();
            how.texture = texture->texture();
        }
        return {setting, shoot(device_, s, profile_, scale, how), texture};
    }

    void comparePicture(Contender contender, const std::string& scene, const LitScene& s,
                        const std::vector<size_t>& pixels, const std::vector<float>& kept) {
        const Setting& setting = contender.setting;
        Shot& shot = contender.shot;
        ErrorSum sum;
        std::vector<double> errors;
        for (size_t k = 0; k < kept.size(); ++k) {
            errors.push_back(std::abs(double(shot.light[3 * pixels[k / 3] + k % 3]) - kept[k]));
            if (errors.back() != errors.back()) errors.back() = INFINITY;
            sum.add(errors.back());
        }
        std::ranges::sort(errors);
        // Work-items that run at the same time may not change a bit from one frame to the next.
        shot.shader.execute();
        const std::vector<float> again = shot.out.readAll<float>();
        addRow(scene, setting, "pictures", sizeOf(s),
               {{"error_max", finite(sum.result().max)},
                {"error_rms", finite(sum.result().rms)},
                {"error_p90", finite(errors[errors.size() * 9 / 10])},
                {"repeats", again == shot.light},
                {"truth", "the picture by PoCL on a CPU, with one lane, at drawn pixels; absolute"}});
    }
    static std::string sizeOf(const LitScene& s) {
        return std::to_string(s.width) + "x" + std::to_string(s.height);
    }
    void addRow(const std::string& scene, const Setting& setting, const char* group, const std::string& what,
                const Json& found) {
        rows_.push_back({{"name", scene + ": " + setting.name()},
                         {"group", group},
                         {"scene", scene},
                         {"method", setting.method},
                         {"setting", setting.setting},
                         {"what", what}});
        rows_.back().update(found);
    }

    // Lambert is measured with every other method, for times relative to it.
    bool wanted(const std::string& scene, const Setting& s) const {
        return (s.quick || !request_.quick) && request_.wants(scene + ": " + s.name());
    }
    bool wanted(const std::string& scene) const {
        return std::ranges::any_of(settings(), [&](const Setting& s) { return wanted(scene, s); });
    }

    // Runs `work` as a case that may fail alone, or be left out.
    template <class Work>
    void attempt(const std::string& name, const char* group, const Work& work) {
        if (std::ranges::find(request_.without, name) != request_.without.end()) return;
        request_.begin(name, group);
        try {
            work();
        } catch (const std::exception& e) {
            rows_.push_back({{"name", name}, {"group", group}, {"failed", e.what()}});
        }
    }

    // Runs all contenders in turns, in another order each time, so that drift of the machine affects all.
    // Each runs for two seconds at most, or once.
    void run(std::vector<Contender>& contenders, const std::string& scene, const char* group, int rounds) {
        std::mt19937 random(1);
        for (int round = 0; round < rounds; ++round) {
            std::ranges::shuffle(contenders, random);
            for (Contender& c : contenders) {
                if (round > 0 && c.wall.front() * (round + 1) > 2000) continue;
                request_.begin(scene + ": " + c.setting.name(), group);
                const double start = milliseconds(), before = c.frame();
                c.wall.push_back(milliseconds() - start);
                const double own = before + c.shot.shader.stats().deviceMilliseconds;
                c.device.push_back(own > 0 ? own : c.wall.back());  // of drivers that tell no times
                if (c.texture) c.passes["in the texture"].push_back(before);
                for (const PelPassStats& pass : c.shot.shader.passes())
                    c.passes[pass.name].push_back(pass.milliseconds);
            }
        }
        if (group == std::string("shares")) return;
        for (Contender& c : contenders) {
            if (!c.setting.shown || !joules_) continue;
            request_.begin(scene + ": " + c.setting.name(), group);
            c.watts = meanWatts(joules_, [&c] { c.frame(); });
        }
    }

    // Times and sizes of a contender; `plain`: of Lambert.
    void addTimes(const Contender& c, const std::string& scene, const char* group, const LitScene& s,
                  double plain) {
        const PelShaderStats stats = c.shot.shader.stats();
        const auto skin = double(s.places.size()), frame = double(s.width) * s.height;
        // Position, normal and result, and what tables need beside them; ids; the shadow map.
        double bytes = skin * (c.setting.request.tableSize ? 52 : 36) + frame;
        for (const scatter_scene::Lamp& lamp : s.lamps) bytes += 4.0 * lamp.width * lamp.height;
        Json passes = Json::array();
        for (const auto& [pass, times] : c.passes)
            passes.push_back({{"name", pass}, {"ms", median(times)}, {"mad_ms", medianDeviation(times)}});
        Json row = {{"items", skin},
                    {"unit", "pixels of skin"},
                    {"samples", c.device.size()},
                    {"median_ms", median(c.device)},
                    {"mad_ms", medianDeviation(c.device)},
                    {"wall_ms", median(c.wall)},
                    {"added_ms", finite(median(c.device) - plain)},
                    {"launches", stats.launches},
                    {"memory_bytes", stats.scratchBytes + (c.texture ? c.texture->bytes() : 0)},
                    {"bytes", bytes},
                    {"arithmetic_share", Json()},
                    {"passes", passes}};
        if (c.watts) row["watts"] = *c.watts;
        if (c.setting.tunes) {
            row["tunes"] = c.setting.tunes;
            row["target_error"] = c.setting.tunes == std::string("auto") ? c.setting.request.targetError : 0;
        }
        if (c.setting.budget > 0) {
            const PelScattering took = c.shot.shader.material(1).scattering;
            group = "budgets";
            row.update({{"budget_ms", 1e-6 * c.setting.budget * skin},
                        {"took", took == PEL_SCATTERING_SCREEN ? "auto" : io::scatterings[took]},
                        {"took_half_rate", stats.takenHalfRate != 0},
                        {"took_target_error", stats.takenTargetError},
                        {"expected_ms", stats.expectedMilliseconds},
                        {"expected_error", stats.expectedError}});
        }
        addRow(scene, c.setting, group, sizeOf(s), row);
    }
    // Of all, in the order of their names, with what `more` has of them.
    void addTimes(std::vector<Contender>& contenders, const std::string& scene, const char* group,
                  const LitScene& s, const std::map<std::string, Json>& more = {}) {
        double plain = NAN;
        for (const Contender& c : contenders)
            if (c.setting.method == "Lambert") plain = median(c.device);
        std::ranges::sort(contenders, {}, [](const Contender& c) { return c.setting.name(); });
        for (const Contender& c : contenders) {
            addTimes(c, scene, group, s, plain);
            if (!more.empty()) rows_.back().update(more.at(c.setting.name()));
        }
    }

    void measureScene(const FrozenScene& scene) {
        std::optional<Stage> stage;
        for (const double scale : radiusScales) {
            const std::string name = scene.name + ("-" + std::to_string(int(scale)));
            if (!wanted(name)) continue;
            attempt(name, "methods", [&] {
                request_.say(name + ": " + scene.title);
                if (!stage) stage.emplace(device_, scene.body(headFile()), 1);
                measureLook(scene, *stage, name, scale);
            });
        }
        if (scene.name == frozenScenes()[0].name) measureShares(scene, stage);
    }

    void measureLook(const FrozenScene& scene, const Stage& stage, const std::string& name, double scale) {
        SceneRequest request = scene.request;
        request.profileScale = scale;
        LitScene s = stage.look(request, profile_);
        const Truth truth = readTruth(request_.data + "/bench", name, s);
        const Crop crop = readCrop(request_.data + "/bench", name, s);
        Json about = {{"name", name},
                      {"title", scene.title},
                      {"scale", scale},
                      {"width", s.width},
                      {"height", s.height},
                      {"pixels", s.places.size()},
                      {"compared", truth.pixels.size()}};
        addErrors(about["surface_integral"], truth.surface, truth, s.subsets);
        scenes_.push_back(about);
        std::vector<Contender> contenders;
        std::map<std::string, Json> errors;
        const std::vector<scatter_scene::Lamp> lamps = s.lamps;
        for (const Setting& setting : settings()) {
            if (!wanted(name, setting) && (setting.method != "Lambert" || !request_.only.size())) continue;
            if (setting.texture && s.gbuffer.uv.data.empty()) continue;
            if (setting.request.historyWeight > 0) continue;
            attempt(name + ": " + setting.name(), "methods", [&] {
                Setting given = setting;
                if (given.thickness) given.request.thickness = thicknessOf(stage, s);
                s.lamps = setting.mapSize ? stage.lampsOf(s.lighting, setting.mapSize) : lamps;
                contenders.push_back(contenderOf(given, scene, s, scale));
                Shot& shot = contenders.back().shot;
                Json& row = errors[setting.name()];
                addErrors(row, valuesAt(shot.light, truth.pixels), truth, s.subsets);
                row["flip"] = finite(io::flip(valuesAt(shot.light, crop.pixels), crop.light, crop.width));
                row["flip_noise"] = crop.noise;
                for (const ShownPart& part : shownParts)
                    if (setting.shown && name == part.scene)
                        addPicture(part, setting.name(), valuesAt(shot.light, part.pixels(s)));
                shot.light = {};
            });
        }
        for (const ShownPart& part : shownParts)
            if (name == part.scene) addPicture(part, "walk", readPart(request_.data + "/bench", part, s));
        run(contenders, name, "methods", request_.quick ? 3 : 5);
        addTimes(contenders, name, "methods", s, errors);
    }

    // The shown methods at the usual radius, of a frame in which `share` percent of the skin are left.
    void measureShares(const FrozenScene& scene, std::optional<Stage>& stage) {
        const auto nameOf = [](int share) { return std::to_string(share) + " % of the skin"; };
        constexpr int shares[] = {100, 50, 10, 0};
        if (std::ranges::none_of(shares, [&](int share) { return wanted(nameOf(share)); })) return;
        if (!stage) stage.emplace(device_, scene.body(headFile()), 1);
        LitScene s = stage->look(scene.request, profile_);
        std::vector<size_t> skin;
        for (size_t i = 0; i < s.covered.size(); ++i)
            if (s.covered[i]) skin.push_back(i);
        for (const int share : shares) {
            while (skin.size() > s.places.size() * size_t(share) / 100)
                s.gbuffer.material[skin.back()] = 0, skin.pop_back();
            const std::string name = nameOf(share);
            if (!wanted(name)) continue;
            attempt(name, "shares", [&] {
                std::vector<Contender> contenders;
                for (const Setting& setting : settings())
                    if (setting.shown && (wanted(name, setting) || setting.method == "Lambert"))
                        contenders.push_back({setting, shoot(device_, s, profile_, 1, setting.request)});
                run(contenders, name, "shares", request_.quick ? 3 : 7);
                addTimes(contenders, name, "shares", s);
            });
        }
    }

    // How much more, or less, a method changes from frame to frame than the true light.
    void measureClips() {
        std::optional<Stage> stage;
        for (const FrozenClip& clip : frozenClips) {
            std::vector<LitScene> frames;
            std::optional<ClipTruth> truth;
            for (const Setting& setting : settings()) {
                if (!(setting.shown || setting.moving) || !wanted(clip.name, setting)) continue;
                if (request_.quick && (setting.method == "light" || clip.cameraStep > 0)) continue;
                attempt(clip.name + (": " + setting.name()), "clips", [&] {
                    if (!stage) stage.emplace(device_, frozenScenes()[0].body(headFile()), 1);
                    for (int k = int(frames.size()); k < clipFrames; ++k)
                        frames.push_back(stage->look(clipRequest(clip, k), profile_));
                    if (!truth) truth = readClip(request_.data + "/bench", clip, frames);
                    request_.say(std::string(clip.name) + ": " + setting.name());
                    measureClip(clip, setting, frames, *truth);
                });
            }
        }
    }
    void measureClip(const FrozenClip& clip, const Setting& setting, const std::vector<LitScene>& frames,
                     const ClipTruth& truth) {
        double largest = 0, sum = 0, count = 0;
        ErrorSum errors;
        std::vector<float> before;
        ShadeRequest request = setting.request;
        const scatter_scene::ShownImages shown(device_, uint32_t(frames[0].width),
                                               uint32_t(frames[0].height));
        for (size_t k = 0; k < frames.size(); ++k) {
            if (request.historyWeight > 0) {
                request.frameIndex = uint32_t(k);
                request.motion = motionBetween(frames[k ? k - 1 : 0], frames[k]);
            }
            const std::vector<float> now =
                shoot(device_, frames[k], profile_, clipScale, request, shown).light;
            for (size_t p = 0; p < truth.pixels[k].size(); ++p) {
                const size_t to = truth.pixels[k][p];
                for (size_t c = 0; to != SIZE_MAX && c < 3; ++c)
                    errors.add(sceneAlbedo * now[3 * to + c] - truth.light[k][3 * p + c]);
                const size_t from = k ? truth.pixels[k - 1][p] : SIZE_MAX;
                if (from == SIZE_MAX || to == SIZE_MAX) continue;
                for (size_t c = 0; c < 3; ++c) {
                    const double own = sceneAlbedo * (double(now[3 * to + c]) - before[3 * from + c]),
                                 light = double(truth.light[k][3 * p + c]) - truth.light[k - 1][3 * p + c];
                    largest = std::max(largest, std::abs(own - light));
                    sum += std::abs(own - light), ++count;
                }
            }
            before = now;
        }
        addRow(clip.name, setting, "clips", clip.title,
               {{"frames", frames.size()},
                {"error_rms", errors.result().rms},
                {"error_max", largest},
                {"error_mean", sum / count}});
    }

    // A part of a picture, as the bytes of a PNG file in base 64. `light`: RGB at `pixels`.
    void addPicture(const ShownPart& part, const std::string& method, std::vector<float> light) {
        const size_t side = size_t(std::sqrt(double(light.size() / 3)));
        const std::vector<uint8_t> pixels = io::toSrgb8(light, io::ToneMap{part.exposure});
        const std::string file =
            io::pngPictures.encode("picture.png", uint32_t(side), uint32_t(side), 3, pixels, true);
        pictures_.push_back(
            {{"scene", part.scene}, {"method", method}, {"exposure", part.exposure}, {"png", base64(file)}});
    }

    static std::string base64(const std::string& bytes) {
        constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (size_t i = 0; i < bytes.size(); i += 3) {
            uint32_t group = 0;
            for (size_t k = 0; k < 3; ++k)
                group = group << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
            for (size_t k = 0; k < 4; ++k)
                text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
        }
        return text;
    }

    const Request& request_;
    Device device_;
    bool sends_;
    EnergyMeter joules_ = energyOf(device_, request_.powercap);
    Profile profile_ = usualProfile();
    Json scenes_ = Json::array(), rows_ = Json::array(), pictures_ = Json::array();
};

}  // namespace

Json measureMethods(const Request& request) {
    return Methods(request).measure();
}

void measureFirst(const Request& request) {
    Methods methods(request, true);
    methods.comparePictures();
    methods.measureFrames();
}

void keepPictures(const Request& request, const std::string& folder) {
    Methods(request).keepPictures(folder);
}

}  // namespace pellucid::bench
