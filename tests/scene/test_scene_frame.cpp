// A frame that is prepared before its pictures are read: the same bits, and nothing is read or made twice.
#include "scene/scene_frame.h"

#include "cl/cl_spy.h"
#include "fields/field_ranges.h"
#include "io/io_files.h"
#include "io/lut/lut_file.h"

using namespace pellucid;

namespace {

constexpr int width = 40, height = 24;

io::Image pixels(const std::vector<std::string>& names, const std::function<float(size_t, int, int)>& value) {
    io::Image image;
    image.width = width, image.height = height;
    for (size_t c = 0; c < names.size(); ++c) {
        std::vector<float> values;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) values.push_back(value(c, x, y));
        image.channels.push_back({names[c], io::ChannelType::Float, std::move(values)});
    }
    return image;
}

const std::vector<std::string> position{"P.X", "P.Y", "P.Z"}, normal{"N.X", "N.Y", "N.Z"},
    tangent{"T.X", "T.Y", "T.Z"}, uv{"U.X", "U.Y"};

// A ball of eyes and skin seen from the front.
io::Image ball() {
    const auto place = [](size_t c, int x, int y) {
        const float p[] = {float(x) - 19.5f, 11.5f - float(y)};
        return c < 2 ? p[c] : std::sqrt(std::max(0.0f, 900 - p[0] * p[0] - p[1] * p[1]));
    };
    io::Image all = pixels(position, place);
    const auto add = [&](const std::vector<std::string>& names,
                         const std::function<float(size_t, int, int)>& value) {
        for (io::Channel& c : pixels(names, value).channels) all.channels.push_back(std::move(c));
    };
    add(normal, [&](size_t c, int x, int y) { return place(c, x, y) / 30; });
    add(tangent, [](size_t c, int, int) { return c == 0 ? 1.0f : 0.0f; });
    add(uv, [](size_t c, int x, int y) { return c == 0 ? float(x) / width : float(y) / height; });
    add({"M.I"}, [](size_t, int x, int y) { return y == 0 ? 0.0f : x < 20 ? 1.0f : 2.0f; });
    return all;
}

class SceneFrames : public FolderTest {
  protected:
    io::SceneFile scene() const {
        io::SceneFile s;
        s.source = "a scene";
        s.channels[PEL_SLOT_POSITION] = position;
        s.channels[PEL_SLOT_NORMAL_SHADING] = s.channels[PEL_SLOT_NORMAL_GEOMETRIC] = normal;
        s.channels[PEL_SLOT_TANGENT] = tangent;
        s.channels[PEL_SLOT_UV] = uv;
        s.channels[PEL_SLOT_MATERIAL] = {"M.I"};
        s.camera.position[2] = 100;
        s.lights.resize(1);
        s.lights[0].light.toLight[0] = 0.6f;
        s.lights[0].light.toLight[2] = 0.8f;
        s.lights[0].shadowMapFile = path("map.exr");
        for (int i = 0; i < 4; ++i) s.lights[0].light.worldToShadow[5 * i] = i < 2 ? 0.02f : 1.0f;
        s.lights[0].light.shadowDepthRange = 60;
        s.materials.resize(2);
        s.materials[0].id = 1;
        s.materials[0].profile = "skin";
        s.materials[0].normalMap = path("bumps.exr");
        s.materials[1].id = 2;
        s.eyes.resize(1);
        s.eyes[0].material = 2;
        s.eyes[0].irisTexture = path("iris.exr");
        io::writeExr(path("map.exr"), pixels({"Z"}, [](size_t, int x, int) { return 0.01f * float(x); }));
        io::writeExr(path("bumps.exr"), pixels({"R", "G", "B"}, [](size_t c, int x, int y) {
                         return c == 2 ? 1.0f : 0.5f + 0.1f * std::sin(float(x + y));
                     }));
        io::Image iris =
            pixels({"R", "G", "B"}, [](size_t c, int x, int y) { return float((x * y + int(c)) % 7) / 7; });
        iris.height = iris.width = 24;
        for (io::Channel& c : iris.channels) c.pixels.resize(iris.pixelCount());
        io::writeExr(path("iris.exr"), iris);
        return s;
    }
};

TEST_F(SceneFrames, PreparedShadesTheSameBits) {
    const Device device("");
    const io::SceneFile s = scene();
    const io::Image gbuffer = ball();
    const std::vector<PelImageSlot> outputs{PEL_SLOT_OUT_SPECULAR};
    io::LutStore luts(device), others(device);
    io::SceneFrame whole(device, gbuffer, s, luts, {}, pelShaderOptionsDefaults(), outputs);
    whole.shade();
    io::SceneFrame prepared = io::prepareFrame(device, s, others, pelShaderOptionsDefaults(), outputs);
    prepared.show(gbuffer, s);
    prepared.shade();
    EXPECT_EQ(prepared.radiance(), whole.radiance());
    EXPECT_EQ(prepared.output(PEL_SLOT_OUT_SPECULAR), whole.output(PEL_SLOT_OUT_SPECULAR));
    EXPECT_EQ(prepared.inputBytes(), whole.inputBytes()) << "nothing of the stand-in is held";
    const std::vector<float> radiance = prepared.radiance();
    EXPECT_GT(*std::ranges::max_element(radiance), 0.01f);

    // Another picture in the same frame.
    io::Image turned = gbuffer;
    for (io::Channel& c : turned.channels)
        if (c.name == "M.I")
            for (float& id : c.pixels) id = id > 0 ? 3 - id : 0;
    prepared.show(turned, s, {{path("map.exr"), pixels({"Z"}, [](size_t, int, int) { return 1.0f; })}});
    prepared.shade();
    EXPECT_NE(prepared.radiance(), whole.radiance());
}

// The next picture goes on from the one before; the same picture, changed, begins anew.
TEST_F(SceneFrames, AHistoryIsOfPicturesThatFollowOneAnother) {
    const Device device("");
    io::SceneFile s = scene();
    s.channels[PEL_SLOT_MOTION] = uv;
    s.options.historyWeight = 0.8f;
    s.materials[0].material.scattering = PEL_SCATTERING_SCREEN;
    s.materials[0].material.scatterTaps = 8;
    const io::Image gbuffer = ball();
    io::LutStore luts(device);
    io::SceneFrame frame(device, gbuffer, s, luts);
    const auto historyOf = [&] {
        frame.shade();
        return frame.stats().pixelsHistory;
    };
    EXPECT_EQ(historyOf(), 0u);
    frame.show(gbuffer, s);
    EXPECT_GT(historyOf(), 0u);
    frame.update(s, luts);
    EXPECT_EQ(historyOf(), 0u);
}

// A map and its levels in files of their own; both everywhere the same normal.
TEST_F(SceneFrames, LevelsOfANormalMapComeFromFiles) {
    const Device device("");
    const io::Image gbuffer = ball();
    const auto radianceOf = [&](const std::string& map, const std::vector<std::string>& levels) {
        io::SceneFile s = scene();
        s.materials[0].normalMap = map;
        s.materials[0].normalMapLevels = levels;
        s.materials[0].material.scattering = PEL_SCATTERING_PREINTEGRATED;
        std::fill_n(s.materials[0].material.normalBlend, 3, 1.0f);
        for (int k = 0; k < 3; ++k) s.ambient.constant[k] = s.ambient.sh[k + 1][k] = 1;
        io::LutStore luts(device);
        io::SceneFrame frame(device, gbuffer, s, luts);
        frame.shade();
        return frame.radiance();
    };
    const float even[] = {0.48f, 0, 0.8f};
    io::Image level = pixels({"R", "G", "B"}, [&](size_t c, int, int) { return 0.5f + even[c] / 2; });
    io::writeExr(path("map.even.exr"), level);
    std::vector<std::string> files;
    for (int side = 0; level.width > 1 || side == 0; ++side) {
        if (side > 0) level.width /= 2, level.height = std::max(level.height / 2, 1);
        for (size_t c = 0; c < 3; ++c) level.channels[c].pixels.assign(level.pixelCount(), even[c]);
        files.push_back(path("level" + std::to_string(side) + ".exr"));
        io::writeExr(files.back(), level);
    }
    const std::vector<float> made = radianceOf(path("map.even.exr"), {}), read = radianceOf("", files),
                             flat = radianceOf("", {});
    EXPECT_NE(made, flat);
    for (size_t i = 0; i < made.size(); ++i) ASSERT_NEAR(read[i], made[i], 1e-5) << i;
}

TEST_F(SceneFrames, PreparedReadsAndMakesNothingTwice) {
    const Device device("");
    const io::SceneFile s = scene();
    io::LutStore luts(device);
    io::SceneFrame prepared = io::prepareFrame(device, s, luts);
    std::filesystem::remove(path("bumps.exr"));
    std::filesystem::remove(path("iris.exr"));
    const PelDeviceStats before = device.stats();
    const io::Image gbuffer = ball();
    prepared.show(gbuffer, s);
    EXPECT_EQ(device.stats().launches, before.launches) << "the table of the eye was there";
    EXPECT_EQ(device.stats().programsBuilt, before.programsBuilt);
    prepared.shade();
    EXPECT_EQ(device.stats().programsBuilt, before.programsBuilt);
}

TEST_F(SceneFrames, PreparedLeavesProgramsToTheBackground) {
    const Device device("");
    io::SceneFile s = scene();
    s.eyes.clear();  // whose table is made at once
    io::LutStore luts(device);
    PelShaderOptions options = pelShaderOptionsDefaults();
    const uint32_t before = device.stats().programsBuilt;
    options.buildInBackground = 1;
    io::prepareFrame(device, s, luts, options);
    EXPECT_EQ(device.stats().programsBuilt, before);
    options.buildInBackground = 0;
    io::prepareFrame(device, s, luts, options);
    EXPECT_GT(device.stats().programsBuilt, before);
}

// After lights, camera and eyes have moved: the launches of a steady frame, and no new buffer. When inputs
// are removed and restored, the pictures are those of a new frame.
TEST_F(SceneFrames, UpdateSetsWhatChanged) {
    const Device device("");
    io::SceneFile s = scene();
    s.eyes[0].irisProfile = "skin-dark";
    const io::Image gbuffer = ball();
    io::LutStore luts(device);
    io::SceneFrame frame(device, gbuffer, s, luts);
    const auto updated = [&] {
        device.stats();  // waits
        const spy::Counts before = spy::counts();
        frame.update(s, luts);
        frame.shade();
        const spy::Counts now = spy::counts();
        return std::array{now.launches - before.launches, now.fills - before.fills,
                          now.buffersMade - before.buffersMade};
    };
    frame.shade();
    const auto steady = updated();
    s.lights[0].light.toLight[0] = -0.6f;
    s.lights[0].light.worldToShadow[3] = 0.1f;
    s.camera.position[0] = 3;
    s.eyes[0].eye.gaze[0] = 0.2f;
    s.materials[0].material.specular = 0.4f;
    const auto moved = updated();
    EXPECT_EQ(moved, steady);
    EXPECT_EQ(steady[2], 0u) << "buffers";
    const auto expectAsNew = [&](const char* what) {
        SCOPED_TRACE(what);
        updated();
        io::LutStore others(device);
        io::SceneFrame another(device, gbuffer, s, others);
        another.shade();
        EXPECT_EQ(frame.radiance(), another.radiance());
    };
    expectAsNew("moved");
    const io::SceneFile whole = s;
    s.eyes[0].irisTexture.clear();
    expectAsNew("fibres");
    s.eyes.clear();
    s.materials[0].normalMap.clear();
    expectAsNew("no eye, no map");
    s.materials.pop_back();
    expectAsNew("one material");
    s = whole;
    expectAsNew("all again");
}

// A field of a structure at an end of its range, or at its special value.
template <class Struct>
struct End {
    std::string what;
    std::function<void(Struct&)> set;
};

template <class T>
void fill(T& field, float value) {
    if constexpr (std::is_array_v<T>)
        std::fill(std::begin(field), std::end(field), value);
    else  // the largest number of a field of whole numbers is no float
        field = std::is_integral_v<T> ? T(std::min(value, 4294967040.0f)) : T(value);
}
#define AT_ENDS(type, name, value, min, max, special, ...)                            \
    for (const float end : {float(min), float(max), float(special)})                  \
        if (!std::isnan(end) && (end >= 0 || !std::is_integral_v<decltype(S::name)>)) \
            all.push_back(                                                            \
                {#name " = " + (std::ostringstream() << end).str(), [end](S& s) { fill(s.name, end); }});

std::vector<End<PelMaterial>> endsOfMaterials() {
    using S = PelMaterial;
    std::vector<End<S>> all;
    PEL_EACH_MATERIAL_FIELD(AT_ENDS)
    return all;
}
std::vector<End<PelLight>> endsOfLights() {
    using S = PelLight;
    std::vector<End<S>> all;
    PEL_EACH_LIGHT_FIELD(AT_ENDS)
    PEL_EACH_DIRECTIONAL_LIGHT_FIELD(AT_ENDS)
    PEL_EACH_POSITIONAL_LIGHT_FIELD(AT_ENDS)
    PEL_EACH_SPOT_LIGHT_FIELD(AT_ENDS)
    PEL_EACH_SPHERE_LIGHT_FIELD(AT_ENDS)
    PEL_EACH_RECTANGLE_LIGHT_FIELD(AT_ENDS)
    PEL_EACH_SHADOW_MAP_FIELD(AT_ENDS)
    return all;
}
std::vector<End<PelEye>> endsOfEyes() {
    using S = PelEye;
    std::vector<End<S>> all;
    PEL_EACH_EYE_FIELD(AT_ENDS)
    return all;
}

// Ends of ranges, each alone, in small frames: a finite result in bounded time, or an error.
class FieldBounds : public SceneFrames {
  protected:
    template <class Struct>
    void expectBounded(const io::SceneFile& usual, const std::vector<End<Struct>>& ends,
                       const std::function<Struct&(io::SceneFile&)>& of) {
        constexpr double maxSeconds = 10;  // of the processor: five seconds on two cores
        const std::vector<PelImageSlot> outputs{PEL_SLOT_OUT_DIFFUSE, PEL_SLOT_OUT_DEEP_SCATTER,
                                                PEL_SLOT_OUT_SPECULAR, PEL_SLOT_OUT_THICKNESS};
        size_t made = 0;
        for (const End<Struct>& end : ends) {
            SCOPED_TRACE(end.what);
            io::SceneFile s = usual;
            end.set(of(s));
            const auto seconds = [&] {
                const std::clock_t start = std::clock();
                try {
                    io::SceneFrame frame(device_, gbuffer_, s, luts_, {}, pelShaderOptionsDefaults(),
                                         outputs);
                    frame.shade();
                    std::vector<float> values = frame.radiance();
                    for (const PelImageSlot slot : outputs)
                        for (const float v : frame.output(slot)) values.push_back(v);
                    EXPECT_TRUE(std::ranges::all_of(values, [](float v) { return std::isfinite(v); }));
                    ++made;
                } catch (const io::FileError& e) {  // names the scene and the field
                    EXPECT_TRUE(contains(e.what(), "a scene: Pel"));
                } catch (const Error& e) {
                    EXPECT_TRUE(e.code() == PEL_ERROR_INVALID_ARGUMENT || e.code() == PEL_ERROR_UNSUPPORTED)
                        << e.what();
                }
                return double(std::clock() - start) / CLOCKS_PER_SEC;
            };
            if (seconds() >= maxSeconds) {  // the first may compile
                EXPECT_LT(seconds(), maxSeconds);
            }
        }
        EXPECT_GT(made, ends.size() / 2);
    }
    const Device device_{""};
    io::LutStore luts_{device_};
    const io::Image gbuffer_ = ball();
};

TEST_F(FieldBounds, OfMaterials) {
    for (const PelScattering scattering : {PEL_SCATTERING_AUTO, PEL_SCATTERING_PREINTEGRATED,
                                           PEL_SCATTERING_SEPARABLE, PEL_SCATTERING_SCREEN}) {
        io::SceneFile s = scene();
        s.eyes.clear();  // whose tables take time, and which are of another material
        PelMaterial& m = s.materials[0].material;
        m.scattering = scattering;
        m.specular = 1;
        std::fill_n(m.deepScatterColor, 3, 0.5f);
        expectBounded<PelMaterial>(
            s, endsOfMaterials(), [](io::SceneFile & f) -> auto& { return f.materials[0].material; });
    }
}

TEST_F(FieldBounds, OfLights) {
    PelEyeLutDesc small = pelEyeLutDescDefaults();
    small.width = small.height = small.depth = 8;
    io::writeLut(path("caustics.exr"), Lut(device_, small));
    io::SceneFile sun = scene();
    sun.eyes[0].caustics = path("caustics.exr");
    io::SceneFile moments = sun, spot = sun;
    moments.lights[0].light.shadowContent = PEL_SHADOW_CONTENT_MOMENTS;
    moments.lights[0].secondChannel = "Z";
    spot.lights[0].light.type = PEL_LIGHT_SPOT;
    spot.lights[0].light.position[2] = 60;
    spot.lights[0].light.shadowProjection = PEL_SHADOW_PERSPECTIVE;
    spot.lights[0].light.shadowDepthA = -1, spot.lights[0].light.shadowDepthB = 1;
    const float seen[16] = {0.5f, 0, -0.5f, 30, 0, 0.5f, -0.5f, 30,
                            0,    0, -1,    59, 0, 0,    -1,    60};  // from z = 60
    std::copy_n(seen, 16, spot.lights[0].light.worldToShadow);
    io::SceneFile sphere = spot;
    sphere.lights[0].light.type = PEL_LIGHT_SPHERE, sphere.lights[0].light.radius = 1;
    for (io::SceneFile s : {sun, moments, spot, sphere}) {
        std::fill_n(s.materials[0].material.deepScatterColor, 3, 0.5f);
        expectBounded<PelLight>(
            s, endsOfLights(), [](io::SceneFile & f) -> auto& { return f.lights[0].light; });
    }
}

TEST_F(FieldBounds, OfEyes) {
    expectBounded<PelEye>(
        scene(), endsOfEyes(), [](io::SceneFile & f) -> auto& { return f.eyes[0].eye; });
}

}  // namespace
