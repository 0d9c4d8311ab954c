// Library and scene file accept and refuse the same values of each field (pellucid_fields.h), at both ends.
#include "fields/field_ranges.h"
#include "io/file_error.h"
#include "io/scene/scene_file.h"
#include "io/shortest.h"
#include "io_files.h"

using namespace pellucid;

namespace {

std::string snake(std::string_view name) {
    std::string out;
    for (const char c : name)
        c >= 'A' && c <= 'Z' ? void((out += '_') += char(c - 'A' + 'a')) : void(out += c);
    return out;
}

template <class T>
void fill(T& field, float value) {
    if constexpr (std::is_array_v<T>)
        std::fill(std::begin(field), std::end(field), value);
    else
        field = T(value);
}

// A number as it is written in a file.
template <class T>
std::string said(float value) {
    const std::string one = io::printed(std::is_integral_v<T> ? "%.0f" : "%.9e", double(value));
    return std::is_array_v<T> ? "[" + one + ", " + one + ", " + one + "]" : one;
}

template <class T>
std::vector<float> tried(const pel::FieldRange& r) {
    const float inf = std::numeric_limits<float>::infinity();
    std::vector<float> values{r.min, r.max};
    if (!std::isnan(r.special)) values.push_back(r.special);
    if (std::is_integral_v<T>) {
        values.insert(values.end(), {r.min - 1, r.max + 1});
        std::erase_if(values, [](float v) { return v < 0; });
    } else {
        values.insert(values.end(), {std::nextafter(r.min, -inf), std::nextafter(r.max, inf), -1, 0});
        std::erase_if(values, [](float v) { return !std::isfinite(v); });
        values.insert(values.end(), {NAN, inf, -inf});
    }
    return values;
}

bool accepts(const std::function<void()>& body) {
    try {
        body();
        return true;
    } catch (const Error&) {
    } catch (const io::FileError&) {
    }
    return false;
}

class FieldRanges : public ::testing::Test {
  protected:
    // Each value that is tried of a field, set by the library; and by a scene, of which text() takes a line.
    template <class T>
    void expectSame(const std::string& name, const pel::FieldRange& range,
                    const std::function<bool(float)>& library,
                    const std::function<std::string(const std::string&)>& text = {}) {
        ++fields_;
        for (const float value : tried<T>(range)) {
            const bool right =
                range.holds(value) && !(name == "thicknessTaps" && (int(value) & (int(value) - 1)));
            EXPECT_EQ(library(value), right) << name << " = " << value << ": the library";
            if (!text) continue;
            const std::string scene = text(snake(name) + " = " + said<T>(value) + "\n");
            EXPECT_EQ(accepts([&] { io::parseScene("scene.toml", scene); }), right) << scene;
        }
    }
    // Whether the rows define a range for the type; other types are checked where they are read.
    static bool isChecked(std::string_view type) {
        return type == "FLOAT" || type == "UINT" || type == "COLOR";
    }

    const Device device_{""};
    int fields_ = 0;
};

}  // namespace

TEST_F(FieldRanges, LibraryAndSceneFileAgree) {
    const Profile profile =
        Profile::named("marble");  // one that knows its mean free path, which a curvature gain needs
    const auto material = [](const std::string& line) {
        return "version = 1\n[channels]\nposition = [\"x\", \"y\", \"z\"]\nnormal_shading = [\"a\", \"b\", "
               "\"c\"]\nmaterial = [\"i\"]\n[[material]]\nid = 1\n" +
               line;
    };
    ASSERT_TRUE(accepts([&] { io::parseScene("scene.toml", material("")); })) << "the scene around the field";
#define CHECK(type, field, ...)                                         \
    expectSame<decltype(PelMaterial::field)>(                           \
        #field, pel::range::material::field,                            \
        [&](float value) {                                              \
            PelMaterial m = pelMaterialDefaults();                      \
            m.profile = profile.get();                                  \
            fill(m.field, value);                                       \
            return accepts([&] { Shader(device_).setMaterial(1, m); }); \
        },                                                              \
        material);
    PEL_EACH_MATERIAL_FIELD(CHECK)
#undef CHECK
    EXPECT_GT(fields_, 20);
}

// Lights and options, which have other keys and conditions in files.
TEST_F(FieldRanges, TheLibraryChecksLightsAndOptions) {
    PelLight spot = pelLightDefaults();
    spot.type = PEL_LIGHT_SPOT;
    spot.spotCosInner = 1, spot.spotCosOuter = -1;
#define CHECK(type, name, ...)                                                          \
    if (isChecked(#type))                                                               \
        expectSame<std::remove_all_extents_t<decltype(PelLight::name)>>(                \
            #name, pel::range::light::name, [&](float value) {                          \
                PelLight l = spot;                                                      \
                fill(l.name, value);                                                    \
                return accepts([&] { Shader(device_).set(std::vector<PelLight>{l}); }); \
            });
    PEL_EACH_LIGHT_FIELD(CHECK)
    PEL_EACH_POSITIONAL_LIGHT_FIELD(CHECK)
    PEL_EACH_SPOT_LIGHT_FIELD(CHECK)
    PEL_EACH_SHADOW_MAP_FIELD(CHECK)
    spot.type = PEL_LIGHT_SPHERE;
    PEL_EACH_SPHERE_LIGHT_FIELD(CHECK)
#undef CHECK
#define CHECK(type, name, ...)                                                                            \
    if (isChecked(#type))                                                                                 \
        expectSame<decltype(PelShaderOptions::name)>(#name, pel::range::options::name, [&](float value) { \
            PelShaderOptions o = pelShaderOptionsDefaults();                                              \
            fill(o.name, value);                                                                          \
            return accepts([&] { Shader(device_).set(o); });                                              \
        });
    PEL_EACH_OPTION_FIELD(CHECK)
    EXPECT_GE(fields_, 13);
}

TEST(FieldRangeWords, EachRangeIsSaidInWords) {
    using pel::describe;
    EXPECT_EQ(describe(pel::range::material::f0), "from 0 to 1");
    EXPECT_EQ(describe(pel::range::material::normalBlend), "-1, or from 0 to 1");
    EXPECT_EQ(describe(pel::range::material::roughness), "0 or more, and at most 1e+18");
    EXPECT_EQ(describe(pel::range::material::diffusionRadius), "0, or 1e-06 or more, and at most 1e+18");
    EXPECT_EQ(describe(pel::range::curvatureLut::radiusMin), "0, or more than 0");
    EXPECT_EQ(describe(pel::range::any), "a finite number");
}
