// Every description of a table within the ranges of its fields is integrated in bounded time, or refused.
#include "test.h"

#include "fields/field_ranges.h"

using namespace pellucid;

namespace {

// Five seconds on two cores. Time of the processor, so that a busy machine fails no test.
constexpr double maxSeconds = 10;

struct Extents {
    uint32_t width, height, depth;
};
template <class Desc>
struct Field {
    const char* name;
    void (*set)(Desc&, float);
    float ends[2];
};

#define PEL_FIELD(type, name, value, min, max, ...)                               \
    {#name,                                                                       \
     [](Desc& d, float v) { d.name = std::remove_cvref_t<decltype(d.name)>(v); }, \
     {float(min), float(max)}},

#define PEL_FIELDS(type, each)                            \
    [] {                                                  \
        using Desc = type;                                \
        return std::vector<Field<Desc>>{each(PEL_FIELD)}; \
    }()

// Returns false for a description that is refused.
template <class Desc>
bool finishes(const Desc& desc, const std::string& what) {
    const std::clock_t start = std::clock();
    bool made = false;
    try {
        const Lut lut(device(), desc);
        made = true;
    } catch (const Error& e) {
        EXPECT_TRUE(e.code() == PEL_ERROR_INVALID_ARGUMENT || e.code() == PEL_ERROR_OUT_OF_MEMORY)
            << what << ": " << e.what();
    }
    EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, maxSeconds) << what;
    return made;
}

template <class Desc>
void setExtents(Desc& desc, const Extents& e) {
    desc.width = e.width, desc.height = e.height;
    if constexpr (std::is_same_v<Desc, PelEyeLutDesc>) desc.depth = e.depth;
}

// Each field at both ends of its range with all extents; `pairs`: and two fields in the first of these.
template <class Desc>
void expectBounded(const Desc& usual, const std::vector<Field<Desc>>& fields,
                   const std::vector<Extents>& extents, bool pairs) {
    size_t made = 0;
    for (size_t i = 0; i < fields.size(); ++i)
        for (const float end : fields[i].ends) {
            const std::string what = std::string(fields[i].name) + " " + std::to_string(end);
            for (const Extents& e : extents) {
                Desc desc = usual;
                setExtents(desc, e);
                fields[i].set(desc, end);
                made +=
                    finishes(desc, what + " in " + std::to_string(e.width) + "x" + std::to_string(e.height));
            }
            for (size_t j = i + 1; pairs && j < fields.size(); ++j)
                for (const float otherEnd : fields[j].ends) {
                    Desc desc = usual;
                    setExtents(desc, extents[0]);
                    fields[i].set(desc, end);
                    fields[j].set(desc, otherEnd);
                    made += finishes(desc, what + ", " + fields[j].name + " " + std::to_string(otherEnd));
                }
        }
    EXPECT_GT(made, fields.size());
}

// Profiles with as many terms as the library accepts.
std::vector<std::pair<const char*, Profile>> largeProfiles() {
    std::vector<PelGaussian> gaussians;
    for (int i = 0; i < 256; ++i) gaussians.push_back({std::pow(10.0f, float(i - 128) / 16), {1, 1, 1}});
    std::vector<float> distances, values;
    for (int i = 0; i < 4096; ++i) {
        distances.push_back(float(i));
        for (int c = 0; c < 3; ++c) values.push_back(float(i % 7 + c));
    }
    const float path[3] = {1e-30f, 1, 1e30f}, albedo[3] = {0, 0.5f, 1}, scattering[3] = {1e30f, 1, 1e-30f},
                absorption[3] = {1e-30f, 1, 1e30f};
    return {{"256 Gaussians", Profile::gaussians(gaussians)},
            {"table of 4096", Profile::table(distances, values)},
            {"burley", Profile::burley(path, albedo)},
            {"dipole", Profile::dipole(absorption, scattering, 1.3f)}};
}

}  // namespace

TEST(TableBounds, OfCurvatureAndShadowTables) {
    const std::vector<Extents> extents{{16, 8, 1}, {16384, 1, 1}, {1, 16384, 1}, {16384, 16384, 1}};
    expectBounded(pelCurvatureLutDescDefaults(),
                  PEL_FIELDS(PelCurvatureLutDesc, PEL_EACH_CURVATURE_LUT_FIELD), extents, true);
    expectBounded(pelShadowLutDescDefaults(), PEL_FIELDS(PelShadowLutDesc, PEL_EACH_SHADOW_LUT_FIELD),
                  extents, true);
}

TEST(TableBounds, OfCausticTables) {
    const auto fields = PEL_FIELDS(PelEyeLutDesc, PEL_EACH_EYE_LUT_FIELD);
    expectBounded(pelEyeLutDescDefaults(), fields,
                  {{16, 8, 4}, {1024, 2, 2}, {2, 1024, 2}, {2, 2, 256}, {1024, 1024, 256}}, false);
    const Profile skin = Profile::skin();
    PelEyeLutDesc scattering = pelEyeLutDescDefaults();
    scattering.profile = skin.get();
    expectBounded(scattering, fields, {{16, 8, 4}}, true);
}

TEST(TableBounds, OfTheLargestProfiles) {
    const uint32_t longest = sized(16384u, 64u);
    for (const auto& [name, profile] : largeProfiles()) {
        for (int form = PEL_FORM_ARC; form <= PEL_FORM_PENNER_RING; ++form)
            for (const Extents& e : {Extents{4, longest, 1}, Extents{longest, 4, 1}}) {
                PelCurvatureLutDesc desc = pelCurvatureLutDescDefaults();
                setExtents(desc, e);
                desc.form = PelCurvatureForm(form);
                desc.profile = profile.get();
                EXPECT_TRUE(finishes(desc, name + std::string(", form ") + std::to_string(form)));
            }
        for (const float sharpening : {1.0f, 1e6f})
            for (const Extents& e :
                 {Extents{4, longest, 1}, Extents{longest, 4, 1}, Extents{longest / 8, 256, 1}}) {
                PelShadowLutDesc desc = pelShadowLutDescDefaults();
                setExtents(desc, e);
                desc.sharpening = sharpening;
                desc.profile = profile.get();
                EXPECT_TRUE(finishes(desc, name + std::string(", shadow")));
            }
        for (const float unit : {1.0f, 1e-4f, 1e4f}) {
            PelEyeLutDesc desc = pelEyeLutDescDefaults();
            desc.profile = profile.get();
            desc.millimetresPerUnit = unit;
            EXPECT_TRUE(finishes(desc, name + std::string(", caustic")));
        }
    }
}

TEST(TableBounds, RefusalsNameTheField) {
    PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    specular.width = 1 << 14, specular.height = 1 << 13;
    EXPECT_FALSE(finishes(specular, "2^27 texels"));
    EXPECT_NE(std::string(pelGetErrorMessage()).find("PelSpecularLutDesc.width"), std::string::npos);
    // An iris far smaller than the limbus, which takes many cells.
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    for (const float radius : {0.05f, 1e-6f}) {
        desc.irisRadius = radius;
        expectRefused("PelEyeLutDesc.irisRadius", [&] { Lut(device(), desc); });
    }
    // Each texel takes light of nearly each other one of its slice.
    const Profile skin = Profile::skin();
    desc = pelEyeLutDescDefaults();
    desc.profile = skin.get();
    desc.width = desc.height = 128, desc.depth = 64;
    expectRefused("products", [&] { Lut(device(), desc); });
    Shader shader(device());
    shader.setMaterial(1, pelMaterialDefaults());
    PelEye eye = pelEyeDefaults();
    eye.irisRadius = 0.05f, eye.pupilRadius = 0.01f;
    expectRefused("PelEye.irisRadius", [&] { shader.setEye(1, eye); });
}

// A long table is cancelled between its parts; blocking calls only.
TEST(TableBounds, CausticTablesAreCancelled) {
    const Device device("");
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    desc.irisRadius = 1;
    struct Calls {
        int count = 0, cancelAt = 0;
    } calls;
    device.setProgress(
        [](void* user, double fraction, const char*) {
            EXPECT_TRUE(fraction > 0 && fraction < 1) << fraction;
            Calls& c = *static_cast<Calls*>(user);
            return int(++c.count != c.cancelAt);
        },
        &calls);
    const std::vector<float> whole = Lut(device, desc).read<float>(PEL_LUT_FLOAT);
    EXPECT_GT(calls.count, 2);
    calls = {0, 2};
    expectRefused(PEL_ERROR_CANCELLED, {}, [&] { Lut(device, desc); });
    EXPECT_EQ(calls.count, 2);
    // In one part the texels are the same.
    calls = {};
    PelEvent made = nullptr;
    const PelSubmit submit{nullptr, 0, &made};
    const Lut lut(device, desc, &submit);
    Event(made).wait();
    EXPECT_EQ(calls.count, 0);
    EXPECT_EQ(lut.read<float>(PEL_LUT_FLOAT), whole);
}
