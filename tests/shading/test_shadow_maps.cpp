// Shadow maps of every content and projection: wide shadow and thickness against the oracle and without
// bounds and skipping, common properties of all forms, and errors.
#include "shader_ready.h"
#include "shadow_forms.h"

using namespace shade_test;

namespace {

constexpr PelShadowContent filtered[] = {PEL_SHADOW_CONTENT_MOMENTS, PEL_SHADOW_CONTENT_EXPONENTIAL};
const Vec3 lamp{24, 10, 70}, down{0, 0, -1}, slanted{0.5, 0.2, 0.9};
// A face in the middle of the picture, an edge, a corner of three faces.
const Vec3 aims[] = {{0, 0, 1}, {1, 0, 1}, {-1, 1, 1}};

// Bumps on open ground, in cells of texels, so that a wrong texel always changes the result.
double bumps(Vec3 d, int texel) {
    const double ground = d.z < -1e-3 ? (lamp.z + 8) / -d.z : 500;
    const int cell = texel / 7 * 31;
    return std::min(ground, 500.0) - (cell % 3 ? 9 + cell % 23 : 0) / length(d);
}

struct Check {
    double wide = tolerance::wideShadow, thickness = tolerance::mapThickness;
    bool atlas = false;
    std::function<bool(const SurfacePlace&)> counts = {};
};
constexpr double any = INFINITY;

// Pixels that are filtered, and those whose filters bounds of blocks did not decide; and by the oracle those
// that are lit, dark and in between, or thick.
struct Compared {
    uint64_t filtered, read;
    size_t lit = 0, dark = 0, between = 0, thick = 0;
};

// Against the oracle. Filters decided by bounds, and skipped work, give the same bits as reading the texels.
// The latter is another program, without which rotated disks and frames narrower than a vector do.
template <class From>
Compared expectOracle(const std::string& what, Frame f, const From& from, const Check& check = {}) {
    SCOPED_TRACE(what);
    const Seen seen = shadeForms(f, {from.light}, check.atlas);
    f.options.disableSkipping = !f.options.rotateTaps && f.width >= 16;
    const Seen all = shadeForms(f, {from.light}, check.atlas);
    EXPECT_EQ(seen.wide, all.wide);
    EXPECT_EQ(seen.thickness, all.thickness);
    EXPECT_LE(seen.stats.pixelsWideShadow, all.stats.pixelsWideShadow);
    if (f.options.disableSkipping) {
        EXPECT_EQ(all.stats.pixelsShadowTexels, all.stats.pixelsWideShadow);
    }
    for (const float t : seen.thickness) EXPECT_TRUE(std::isfinite(t));
    Compared result{seen.stats.pixelsWideShadow, seen.stats.pixelsShadowTexels};
    EXPECT_LE(result.filtered - result.read,
              size_t(std::ranges::count_if(seen.wide, [](float w) { return w == 0 || w == 1; })));
    double worstWide = 0, worstThickness = 0;
    for (size_t i = 0; i < f.pixels(); ++i) {
        const auto at = placeAt(f, i);
        if (!at || (check.counts && !check.counts(*at))) continue;
        const double wide = wideOf(from, *at), thickness = thicknessOf(from, *at, tapsOf(f, at->material, i));
        worstWide = std::max(worstWide, std::abs(wide - seen.wide[i]));
        worstThickness = std::max(worstThickness, std::abs(thickness - seen.thickness[i]));
        ++(wide < 0.01 ? result.dark : wide > 0.99 ? result.lit : result.between);
        result.thick += thickness > 1;
    }
    EXPECT_LE(worstWide, check.wide);
    EXPECT_LE(worstThickness, check.thickness);
    return result;
}

// Texels that throw no shadow: each fifth is one of `bad`.
void corruptTexels(std::vector<float>& texels, std::vector<double>& truth, std::initializer_list<float> bad,
                   uint32_t components = 1) {
    for (size_t i = 0; i < truth.size(); i += 5) {
        const float value = bad.begin()[i % bad.size()];
        texels[components * i] = value;
        truth[i] = std::isfinite(value) ? value : NAN;
    }
}

std::string nameOf(const char* form, bool perspective, bool reversed, double number) {
    return form + std::string(perspective ? ", perspective" : "") + (reversed ? ", reversed " : " ") +
           std::to_string(number);
}

TEST(ShadowMaps, OfDepthMatchTheOracle) {
    const Frame f = formFrame();
    double decided = 0, all = 0;
    for (const bool perspective : {false, true})
        for (const bool reversed : {false, true}) {
            for (const uint32_t size : {61u, 90u, 300u}) {
                MapLight from = mapLight(size, perspective, reversed, slanted, {24, 10, 5}, 70, size);
                const bool corrupt = size == 90;
                if (corrupt) corruptTexels(from.light.map.values, from.map.depth, {NAN, INFINITY, -INFINITY});
                const Compared seen = expectOracle(nameOf("depth", perspective, reversed, size), f, from,
                                                   {.thickness = corrupt ? any : tolerance::mapThickness});
                EXPECT_GT(seen.between, f.pixels() / 20);
                EXPECT_GT(seen.read, 0u);
                decided += double(seen.filtered - seen.read), all += double(seen.filtered);
            }
            // A matrix of homogeneous coordinates may have any factor.
            MapLight from = mapLight(5, perspective, reversed, slanted, {24, 10, 5}, 70, 90);
            const Seen first = shadeForms(f, {from.light});
            for (const float factor : {0.25f, 16.0f}) {
                for (float& m : from.light.params.worldToShadow) m *= factor;
                EXPECT_EQ(shadeForms(f, {from.light}).wide, first.wide) << factor << perspective << reversed;
            }
        }
    EXPECT_GT(decided / all, 0.2);
    for (const auto& [width, height, size] : {std::tuple{1u, 1u, 1u}, {1u, 7u, 2u}, {131u, 3u, 5u}})
        expectOracle("a small frame", formFrame(1, width, height),
                     mapLight(3, false, false, slanted, {0, 0, 0}, 70, size));
}

TEST(ShadowMaps, OfMomentsAndExponentialsMatchTheOracle) {
    const Frame f = formFrame();
    for (const auto content : filtered)
        for (const bool perspective : {false, true})
            for (const bool reversed : {false, true})
                for (const bool corrupt : {false, true}) {
                    ContentLight from = contentLight(content, perspective, reversed, 131);
                    MapImage& map = from.light.maps[0];
                    if (corrupt && content == PEL_SHADOW_CONTENT_MOMENTS)
                        corruptTexels(map.values, from.first.depth, {NAN, INFINITY}, 2);
                    else if (corrupt)
                        corruptTexels(map.values, from.first.depth, {NAN, INFINITY, -1, 0});
                    const Compared seen =
                        expectOracle(nameOf("content", perspective, reversed, content), f, from,
                                     {tolerance::contentShadow, corrupt ? any : tolerance::contentThickness});
                    EXPECT_GT(seen.between, f.pixels() / 50);
                    EXPECT_GT(seen.thick, f.pixels() / (corrupt ? 50 : 20));
                }
}

TEST(ShadowMaps, CubesMatchTheOracle) {
    Frame f = formFrame();
    for (const bool radial : {false, true})
        for (const Vec3 aim : aims)
            for (const uint32_t size : {16u, 64u, 128u}) {
                CubeLight from = cubeLight(size, radial, turnTo(down, aim), lamp, bumps);
                if (size == 64) corruptTexels(from.light.maps[0].values, from.map.depth, {NAN});
                f.options.rotateTaps = radial && size == 16;
                const Compared seen = expectOracle(nameOf("cube", !radial, false, size), f, from,
                                                   {.thickness = tolerance::cubeThickness});
                EXPECT_GT(seen.between, f.pixels() / 50);
                EXPECT_TRUE(size == 64 || seen.thick > f.pixels() / 20);
                from.light.params.range = 71;  // reaches the middle only
                const Compared middle = expectOracle("range", f, from, {any, any});
                EXPECT_GT(middle.filtered, 0u);
                EXPECT_LT(middle.filtered, seen.filtered);
            }
    expectOracle("the smallest of cubes", formFrame(1, 9, 3),
                 cubeLight(1, true, turnTo(down, aims[1]), lamp, bumps),
                 {.thickness = tolerance::cubeThickness});
}

// Without pixels near the line where another cascade is taken.
TEST(ShadowMaps, CascadesMatchTheOracle) {
    Frame f = formFrame();
    for (const bool reversed : {false, true})
        for (const bool atlas : {false, true})
            for (const bool corrupt : {false, true}) {
                CascadeLight from = cascadeLight({14, 24, 36, 52}, reversed, 97, atlas);
                for (size_t k = 0; corrupt && k < 4; ++k)
                    corruptTexels(from.light.maps[k].values, from.maps[k].map.depth, {NAN});
                f.options.rotateTaps = reversed && atlas;
                const auto matrices = matricesOf(from);
                const double perUv = 1 / reference::uvPerLength(matrices[0], 0);
                const auto sure = [&](Vec3 at, double radius) {
                    const int chosen = reference::cascadeOf(matrices, at, radius);
                    return chosen == reference::cascadeOf(matrices, at, radius - 1e-4) &&
                           chosen == reference::cascadeOf(matrices, at, radius + 1e-4);
                };
                size_t taken[5] = {};  // none, and each
                Check check{.thickness = corrupt ? any : tolerance::mapThickness, .atlas = atlas};
                check.counts = [&](const SurfacePlace& at) {
                    const double half = at.material.shadowFilterWidth / 2;
                    if (!sure(at.position, half) ||
                        !sure(at.inset(), at.material.thicknessFilterRadius * perUv))
                        return false;
                    ++taken[1 + reference::cascadeOf(matrices, at.position, half)];
                    return true;
                };
                const Compared seen =
                    expectOracle(nameOf("cascades", atlas, reversed, corrupt), f, from, check);
                for (const size_t pixels : taken) EXPECT_GT(pixels, 100u);
                EXPECT_GT(seen.between, f.pixels() / 50);
                EXPECT_TRUE(corrupt || seen.thick > f.pixels() / 20);
                EXPECT_LT(seen.filtered, seen.lit + seen.dark + seen.between) << "outside of all: none";
            }
}

// --- the filter: its softness, the borders of the map, and which texels are read ---

Frame filterFrame(uint32_t seed = 1, float factor = 1) {
    Frame f = formFrame(seed, 130, 60);
    f.materials[2].shadowFilterWidth = 3;
    for (auto& [id, material] : f.materials) material.shadowFilterWidth *= factor;
    return f;
}
// Makes the frame a plane.
Frame flattened(Frame f) {
    for (size_t i = 0; i < f.pixels(); ++i) {
        f.slots[PEL_SLOT_POSITION].values[3 * i + 2] = 0;
        f.slots[PEL_SLOT_NORMAL_GEOMETRIC].set(i, {0, 0, 1});
    }
    return f;
}

// Softness from hard to wider than the filter; over open ground, and under a closed roof that comes down into
// it: everything is in shadow but for where the roof is nearer than the softness, or below.
TEST(ShadowFilter, OfAnySoftness) {
    for (const float softness : {0.01f, 0.25f, 1.0f, 1.7f, 5.0f, 40.0f})
        for (const bool perspective : {false, true})
            for (const bool reversed : {false, true})
                for (const bool roof : {false, true}) {
                    MapLight from = mapLight(7, perspective, reversed, roof ? Vec3{0.1, 0.2, 0.9} : slanted,
                                             {26, 12, roof ? 0.0 : 5.0}, roof ? 90 : 70, 200);
                    from.light.params.shadowSoftness = softness;
                    for (size_t i = 0; roof && i < from.light.map.values.size(); ++i)
                        setDepth(from, i, 168 - 0.2 * double(i % 200) + 0.01 * double(i / 200));
                    const std::string what =
                        nameOf(roof ? "softness under a roof" : "softness", perspective, reversed, softness);
                    // Of a hard shadow float depths are a larger part.
                    const Compared seen = expectOracle(
                        what, filterFrame(1, 0.4f), from,
                        {softness < 0.1f ? tolerance::wideShadowAnywhere : tolerance::wideShadow, any});
                    EXPECT_LT(seen.read, seen.filtered) << what << ": bounds decide some";
                    EXPECT_GT(seen.between, roof ? 20u : 100u) << what;
                    EXPECT_GE(seen.dark, roof && softness < 2 ? 51u : 0u) << what;
                }
}

// A roof that is the whole map: beyond each of its four borders light comes in, although the outermost texels
// are near the light. With bias and slope, and with filters of which the map is a small part.
TEST(ShadowFilter, OutsideOfTheMapEverythingIsLit) {
    for (const bool perspective : {false, true})
        for (const bool reversed : {false, true})
            for (const uint32_t size : {1u, 2u, 7u, 8u, 9u, 16u, 17u, 40u, 129u}) {
                MapLight from = mapLight(3, perspective, reversed, {0.2, 0.1, 0.9}, {26, 12, 0}, 16, size);
                for (size_t i = 0; i < from.light.map.values.size(); ++i) setDepth(from, i, 100);
                from.light.params.shadowFilterTexels = 256;
                const std::string what = nameOf("map of", perspective, reversed, size);
                const Compared seen = expectOracle(what, filterFrame(2), from, {.thickness = any});
                EXPECT_GT(seen.between, 200u) << what;
                EXPECT_GE(seen.lit, size > 2 ? 501u : 0u) << what;
                EXPECT_GE(seen.dark, size > 16 ? 51u : 0u) << what;
            }
}

// The map of a plane alone, lit at a slant: the bounds know its slope, so that hardly a filter reads texels.
TEST(ShadowFilter, ASlantedPlaneIsDecidedByItsSlope) {
    MapLight from = mapLight(7, false, false, {0.8, 0.3, 0.5}, {26, 12, 0}, 120, 200);
    const auto& v = from.view;
    for (size_t i = 0; i < from.light.map.values.size(); ++i) {
        const double right = (double(i % 200) + 0.5) / 200 - 0.5, below = (double(i / 200) + 0.5) / 200 - 0.5;
        const Vec3 p = v.origin + right * v.extent * v.right + below * v.extent * v.down;
        setDepth(from, i, -p.z / v.forward.z);
    }
    from.light.params.shadowBias = 1;  // the plane itself is not its own shadow's border
    const Compared seen = expectOracle("plane", flattened(filterFrame(1, 0.4f)), from, {.thickness = any});
    EXPECT_GT(seen.filtered, 1000u);
    EXPECT_LT(double(seen.read), 0.05 * double(seen.filtered));
}

// A straight edge between two blocks of the map: filters that overlap blocks of both sides read texels, and
// no others do.
TEST(ShadowFilter, TexelsAreReadAcrossAnEdgeAlone) {
    for (const bool nearIsLeft : {true, false}) {
        MapLight from = mapLight(3, false, false, {0, 0, 1}, {24, 10, 0}, 128, 128);
        for (size_t i = 0; i < from.light.map.values.size(); ++i)
            setDepth(from, i, (i % 128 < 64) == nearIsLeft ? 50 : 250);
        const Frame f = flattened(filterFrame(2));
        uint64_t skin = 0, across = 0, doubtful = 0;
        for (size_t i = 0; i < f.pixels(); ++i) {
            const auto at = placeAt(f, i);
            if (!at) continue;
            ++skin;
            const double x =
                dot(from.view.right, at->position - from.view.origin) / from.view.extent * 128 + 63.5;
            const double radius =
                std::max(0.5 * at->material.shadowFilterWidth, 2.0);  // texels, at least two
            across += x - radius <= 63 && x + radius >= 64;
            doubtful += std::abs(x - radius - 63) < 1e-3 || std::abs(x + radius - 64) < 1e-3;
        }
        const Compared seen = expectOracle("edge", f, from, {.thickness = any});
        EXPECT_EQ(seen.filtered, skin);
        EXPECT_NEAR(double(seen.read), double(across), double(doubtful));
        EXPECT_GT(across, 500u);
        EXPECT_LT(across, skin / 2);
        EXPECT_LT(doubtful, across / 20);
    }
}

// A straight edge high over a plane gives w = (1 + q sqrt(2 - q^2)) / 2 at q from -1 to 1 across it: the
// profile by which the shadow table reads its columns.
TEST(ShadowFilter, AStraightEdgeHasTheTablesProfile) {
    MapLight from = mapLight(1, false, false, {0, 0, 1}, {24, 10, 0}, 64, 640);
    for (size_t i = 0; i < from.light.map.values.size(); ++i) setDepth(from, i, i % 640 < 320 ? 100 : 200);
    from.light.params.shadowFilterTexels = 256;
    Frame f = flattened(formFrame());
    f.slots[PEL_SLOT_MATERIAL].values.assign(f.pixels(), 1.0f);
    const Seen seen = shadeForms(f, {from.light});
    for (size_t i = 0; i < f.pixels(); ++i) {
        const double across = dot(f.slots[PEL_SLOT_POSITION].vec(i) - Vec3{24, 10, 0}, from.view.right);
        const double q = std::clamp(across / 4, -1.0, 1.0);
        EXPECT_NEAR(seen.wide[i], (1 + q * std::sqrt(2 - q * q)) / 2, tolerance::wideShadowEdge) << across;
    }
}

// The bounds of a map follow from its decoded texels, in any format: each of those that lie alone counts.
TEST(ShadowFilter, AMapOfIntegersIsTheMapOfItsFloats) {
    for (const size_t apart : {113u, 149u}) {
        MapLight from = mapLight(7, false, false, {0, 0, 1}, {24, 10, 0}, 50, 200);
        std::vector<uint16_t> integers;
        for (size_t i = 0; i < from.light.map.values.size(); ++i) {
            setDepth(from, i, i % apart == 0 ? 100 : 200);
            integers.push_back(
                uint16_t(std::lround(65535 * std::clamp(from.light.map.values[i], 0.0f, 1.0f))));
            setDepth(from, i, from.view.decoding.range * integers.back() / 65535.0);
        }
        Frame f = flattened(filterFrame(1, 0.4f));
        f.lights = {from.light};
        showWideShadow(f);
        const std::vector<float> shown = shade(f, nullptr, [&](Shader& shader) {
            const Buffer map(device(), integers);
            shader.set(0, PEL_LIGHT_SHADOW_MAP, imageDesc(map, PEL_FORMAT_R16_UNORM, 200, 200));
        });
        EXPECT_GT(*std::max_element(shown.begin(), shown.end()), 0.1f);
        for (size_t i = 0; i < f.pixels(); ++i)
            if (const auto at = placeAt(f, i)) {
                ASSERT_NEAR(shown[3 * i], wideOf(from, *at), tolerance::wideShadow) << i;
            }
    }
}

// --- when a map is filtered ---

Frame litFrame() {
    Frame f = formFrame();
    f.lights = {mapLight(3).light};
    for (auto& [id, m] : f.materials) std::fill_n(m.deepScatterColor, 3, 0.0f);
    showWideShadow(f);
    return f;
}

TEST(ShadowFilter, OffCostsNothingAndAnImageGoesFirst) {
    Frame f = litFrame();
    PelShaderStats off = pelShaderStatsDefaults(), on = off, given = off;
    shade(f, &on);
    EXPECT_EQ(on.features, uint32_t(PEL_FEATURE_SHADOW | PEL_FEATURE_FILTER_SHADOW));
    EXPECT_EQ(on.launches, 4u);
    EXPECT_EQ(on.pixelsWideShadow, on.pixelsShaded);
    f.lights[0].params.shadowFilterTexels = 0;
    shade(f, &off);
    EXPECT_EQ(off.features, 0u);
    EXPECT_EQ(off.launches, 2u);
    EXPECT_GE(on.scratchBytes, off.scratchBytes + 4 * f.pixels());
    EXPECT_EQ(off.pixelsWideShadow, 0u);
    f.lights[0].params.shadowFilterTexels = 24;
    f.lights[0].wide = {1, std::vector<float>(f.pixels(), 0.5f)};
    EXPECT_EQ(shade(f, &given)[3 * (f.pixels() - 1)], 0.5f);
    EXPECT_EQ(given.launches, off.launches);
}

// Pre-integrated materials are shadowed by a map whatever the light says of its filter, unless it turns the
// filter off.
TEST(ShadowFilter, IsUsedByDefault) {
    for (const bool besideScreen : {false, true})
        for (const bool on : {true, false}) {
            Frame f = litFrame();
            f.lights[0].params.shadowFilterTexels = on ? pelLightDefaults().shadowFilterTexels : 0;
            if (besideScreen) f.materials[2].scattering = PEL_SCATTERING_NONE;
            auto [shader, target] = shaderOf(f);
            shader.commit().execute();
            const auto shown = target.readAll<float>();
            size_t dark = 0;
            for (size_t i = 0; i < f.pixels(); ++i)
                dark += f.slots[PEL_SLOT_MATERIAL].at(i) == 1 && shown[3 * i] < 0.5f;
            EXPECT_EQ(dark > f.pixels() / 50, on);
            EXPECT_EQ(dark == 0, !on);
            EXPECT_EQ(shader.warnings().find("gets no shadow from the map of light 0") == std::string::npos,
                      on)
                << shader.warnings();
        }
}

// --- what the forms have in common ---

// What lies in front of a cube's face is seen alike in every content.
TEST(ShadowForms, CubesHoldAllContents) {
    const Frame f = formFrame();
    const auto shelf = [&](Vec3 d, int) {
        return d.z < -1e-3 ? std::min((d.x * 40 < -d.z * 3 ? 30.0 : 78.0) / -d.z, 500.0) : 500;
    };
    std::vector<float> uneven[2];
    for (const bool radial : {false, true}) {
        const CubeLight cube = cubeLight(256, radial, turnTo(down, {-1, 1, 1}), lamp, shelf);
        const Seen depth = shadeForms(f, {cube.light});
        for (const auto content : filtered) {
            const bool moments = content == PEL_SHADOW_CONTENT_MOMENTS;
            Light other = cube.light;
            other.params.shadowContent = content;
            other.params.shadowExponent = 80;
            MapImage& map = other.maps[0];
            map.components = moments ? 2 : 1;
            map.values.clear();
            for (const double z : cube.map.depth) {
                map.values.push_back(float(moments ? z : std::exp(80 * z)));
                if (moments) map.values.push_back(float(z * z));
            }
            const Seen as = shadeForms(f, {other});
            double wide = 0;
            for (size_t i = 0; i < f.pixels(); ++i) {
                if (!placeAt(f, i)) continue;
                EXPECT_NEAR(as.thickness[i], depth.thickness[i],
                            tolerance::contentInCubeThickness + 0.02 * depth.thickness[i])
                    << i << " radial " << radial;
                wide += std::abs(as.wide[i] - depth.wide[i]) / double(f.pixels());
            }
            EXPECT_LE(wide, tolerance::contentInCube) << "mean; content " << content << ", radial " << radial;
            if (!moments) continue;
            // Where distance varies within texels, some light leaks: equally much in both kinds, if the
            // inverse distance along the face's axis has the same deviation.
            constexpr double deviation = 0.02;
            for (size_t i = 0; i < cube.map.depth.size(); ++i) {
                const int size = cube.map.size, at = int(i) % (size * size);
                const double axis = length(
                    reference::shadowCubeDirection(int(i) / (size * size), at % size, at / size, size));
                const double z = cube.map.depth[i], range = cube.light.params.shadowDepthRange;
                const double slope = radial ? -axis / (z * z * range) : cube.light.params.shadowDepthA;
                map.values[2 * i + 1] = float(z * z + std::pow(deviation / slope, 2));
            }
            uneven[radial] = shadeForms(f, {other}).wide;
            double more = 0;
            for (size_t i = 0; i < f.pixels(); ++i)
                if (placeAt(f, i)) more += (uneven[radial][i] - as.wide[i]) / double(f.pixels());
            EXPECT_GT(more, 0.15);
        }
    }
    for (size_t i = 0; i < f.pixels(); ++i)
        EXPECT_NEAR(uneven[0][i], uneven[1][i], tolerance::contentShadow) << i;
}

// Before cascades a map that began inside its buffer was read from the buffer's start.
TEST(ShadowForms, MapsMayBeginInsideTheirBuffer) {
    const Frame f = formFrame();
    const Light two = cascadeLight({70, 70}, false, 97, true).light;
    Light second = two;  // the second of an atlas as a plain map
    second.params.shadowCascades = 0;
    std::copy_n(two.params.cascadeToShadow[0], 16, second.params.worldToShadow);
    std::swap(second.maps[0].slot, second.maps[1].slot);
    Light plain = second;
    plain.maps = {second.maps[1]};
    EXPECT_EQ(shadeForms(f, {plain}).thickness, shadeForms(f, {second}, true).thickness);
}

// Halves of four components are as far apart as pairs of floats, and depths beside other floats, too.
TEST(ShadowForms, TexelsOfOneSizeHaveTheirOwnFormat) {
    Frame f = formFrame();
    f.lights = {mapLight(3, false, false, slanted, {24, 10, 5}, 70, 131).light};
    const uint32_t size = f.lights[0].mapSize;
    std::vector<uint16_t> halves;
    std::vector<float> pairs;
    for (float& depth : f.lights[0].map.values) {
        depth = std::ldexp(std::round(std::ldexp(depth, 10)), -10);  // a half
        pairs.insert(pairs.end(), {depth, NAN});
        halves.insert(halves.end(), {toHalf(depth), 0x7E00, 0x7E00, 0x7E00});
    }
    FrameShader shown = shaderOf(f);
    const auto picture = [&] {
        shown.shader.commit().execute();
        return shown.target.readAll<float>();
    };
    const auto dense = picture();
    const auto with = [&](const auto& values, PelFormat format) {
        pellucid::OwnedImage image = imageDesc(Buffer(device(), values), format, size, size);
        shown.shader.set(0, PEL_LIGHT_SHADOW_MAP, image);
        return picture();
    };
    EXPECT_EQ(with(halves, PEL_FORMAT_RGBA16F), dense);
    EXPECT_EQ(with(pairs, PEL_FORMAT_RG32F), dense);
}

// Positions that are NaN, far away or at the light only affect their own pixel.
TEST(ShadowForms, BadPlaces) {
    const Light lights[] = {mapLight(3, true).light, cascadeLight({24, 70}).light,
                            contentLight(PEL_SHADOW_CONTENT_EXPONENTIAL, true, false, 61).light,
                            cubeLight(64, false, turnTo(down, aims[2]), lamp, bumps).light};
    for (const Light& light : lights) {
        Frame f = formFrame();
        const Seen before = shadeForms(f, {light});
        const size_t bad = f.pixels() / 4 + 20;
        float* places = &f.slots[PEL_SLOT_POSITION].values[3 * bad];
        places[0] = NAN;
        for (int c = 0; c < 3; ++c) places[9 + c] = 1e30f, places[18 + c] = float(lamp[c]);
        f.slots[PEL_SLOT_NORMAL_GEOMETRIC].values[3 * (bad + 9)] = NAN;
        const Seen after = shadeForms(f, {light});
        for (size_t i = 0; i < f.pixels(); ++i) {
            ASSERT_TRUE(std::isfinite(after.thickness[i])) << i;
            if (i == bad || i == bad + 3 || i == bad + 6 || i == bad + 9) continue;
            ASSERT_EQ(after.wide[i], before.wide[i]) << i;
            ASSERT_EQ(after.thickness[i], before.thickness[i]) << i;
        }
        if (light.params.type != PEL_LIGHT_DIRECTIONAL) continue;
        EXPECT_EQ(after.wide[bad + 3], 1) << "far outside of the map: no shadow";
        EXPECT_EQ(after.thickness[bad + 3], 0) << "and no thickness";
    }
}

TEST(ShadowForms, WhatIsRefused) {
    const Light plain = mapLight(3).light,
                cube = cubeLight(16, false, turnTo(down, aims[0]), lamp, bumps).light,
                cascades = cascadeLight({24, 70}).light,
                moments = contentLight(PEL_SHADOW_CONTENT_MOMENTS, false, false, 31).light,
                exponential = contentLight(PEL_SHADOW_CONTENT_EXPONENTIAL, false, false, 31).light;
    const struct {
        const Light& from;
        const char* word;
        std::function<void(PelLight&, Light&)> change;
    } rows[] = {
        {plain, "singular", [](auto& p, Light&) { std::copy_n(p.worldToShadow, 4, p.worldToShadow + 4); }},
        {plain, "singular", [](auto& p, Light&) { std::fill_n(p.worldToShadow, 4, 0.0f); }},
        {exponential, "two components",
         [](auto& p, Light&) { p.shadowContent = PEL_SHADOW_CONTENT_MOMENTS; }},
        {exponential, "shadowExponent", [](auto& p, Light&) { p.shadowExponent = 0; }},
        {exponential, "shadowExponent", [](auto& p, Light&) { p.shadowExponent = -80; }},
        {exponential, "shadowExponent", [](auto& p, Light&) { p.shadowExponent = NAN; }},
        {exponential, "shadowExponent", [](auto& p, Light&) { p.shadowExponent = 1e5f; }},
        {exponential, "below 0", [](auto& p, Light&) { p.shadowDepthRange *= -1; }},
        {moments, "PelShadowContent", [](auto& p, Light&) { p.shadowContent = PelShadowContent(3); }},
        {cube, "16 x 96", [](auto&, Light& l) { l.maps[0].height = 95; }},
        {cube, "directional", [](auto& p, Light&) { p.type = PEL_LIGHT_DIRECTIONAL; }},
        {cube, "shadowDepthA is 0", [](auto& p, Light&) { p.shadowDepthA = 0; }},
        {cube, "shadowDepthRange",
         [](auto& p, Light&) { p.shadowProjection = PEL_SHADOW_CUBE_RADIAL, p.shadowDepthRange = -1; }},
        {cube, "origin", [](auto& p, Light&) { p.worldToShadow[3] += 1; }},
        {cube, "rotation",
         [](auto& p, Light&) {
             for (int c = 0; c < 4; ++c) p.worldToShadow[c] *= 2;
         }},
        {cube, "rotation", [](auto& p, Light&) { std::fill_n(p.worldToShadow, 16, 0.0f); }},
        {cube, "finite", [](auto& p, Light&) { p.worldToShadow[5] = NAN; }},
        {cube, "PelShadowProjection", [](auto& p, Light&) { p.shadowProjection = PelShadowProjection(4); }},
        {cube, "cascades", [](auto& p, Light&) { p.shadowCascades = 1; }},
        {cascades, "cascade 2 is not set", [](auto& p, Light&) { p.shadowCascades = 3; }},
        {cascades, "directional", [](auto& p, Light&) { p.type = PEL_LIGHT_SPOT; }},
        {cascades, "directional", [](auto& p, Light&) { p.shadowProjection = PEL_SHADOW_PERSPECTIVE; }},
        {cascades, "cascadeToShadow[0] is singular",
         [](auto& p, Light&) { std::fill_n(p.cascadeToShadow[0], 4, 0.0f); }},
        {cascades, "worldToShadow is singular",
         [](auto& p, Light&) { std::fill_n(p.worldToShadow, 16, 0.0f); }},
        {cascades, "cascadeToShadow[0]", [](auto& p, Light&) { p.cascadeToShadow[0][3] = NAN; }},
        {cascades, "cascadeDepthRange[0] is 0", [](auto& p, Light&) { p.cascadeDepthRange[0] = 0; }},
        {cascades, "one sign", [](auto& p, Light&) { p.cascadeDepthRange[0] *= -1; }},
    };
    const auto refused = [](PelError code, const char* word, const std::vector<Light>& lights) {
        expectRefused(code, {word}, [&] { shadeForms(formFrame(1, 9, 3), lights); });
    };
    for (size_t i = 0; i < std::size(rows); ++i) {
        SCOPED_TRACE("row " + std::to_string(i));
        Light light = rows[i].from;
        rows[i].change(light.params, light);
        refused(PEL_ERROR_INVALID_ARGUMENT, rows[i].word, {light});
    }
    Light other = cascades;  // axes may stand in any order
    for (int row = 0; row < 3; ++row)
        for (int k = 0; k < 4; ++k) other.params.worldToShadow[4 * row + k] = float(k == (row + 2) % 3);
    shadeForms(formFrame(1, 9, 3), {other});
    other = cascades;
    other.maps[1].components = 2;
    other.maps[1].values.resize(2 * other.maps[1].values.size());
    refused(PEL_ERROR_UNSUPPORTED, "cascade has format", {other});
    other = exponential;
    other.params.shadowContent = PEL_SHADOW_CONTENT_DEPTH;
    refused(PEL_ERROR_UNSUPPORTED, "shadowContent", {exponential, other});
    // Without places; and beside a filtered shadow, images of the host have its format.
    Frame f = litFrame();
    f.slots[PEL_SLOT_POSITION] = {};
    expectRefused("position image", [&] { shade(f); });
    f = litFrame();
    f.lights.push_back(f.lights[0]);
    for (const PelFormat format : {PEL_FORMAT_R8_UNORM, PEL_FORMAT_R32F}) {
        const auto run = [&] {
            shade(f, nullptr, [&](Shader& shader) {
                const Buffer wide(device(), f.pixels() * 4);
                shader.set(1, PEL_LIGHT_WIDE_SHADOW, imageDesc(wide, format, f.width, f.height));
            });
        };
        if (format == PEL_FORMAT_R32F)
            run();
        else
            expectRefused(PEL_ERROR_UNSUPPORTED, {"R32F"}, run);
    }
}

}  // namespace
