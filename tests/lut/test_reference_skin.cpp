// Skin from its pigments, against random walks in its layers and against measured colours of skin.
#include "test.h"

#include "fields/field_ranges.h"
#include "fields/skin_spectra.h"
#include "lut/measured_skin.h"
#include "reference/skin_walk.h"

namespace {

using pellucid::skinInfo;

PelSkin skinOf(const reference::WalkedSkin& s) {
    PelSkin skin = pelSkinDefaults();
    skin.melanin = float(s.melanin);
    skin.eumelanin = float(s.eumelanin);
    skin.blood = float(s.blood);
    skin.oxygenation = float(s.oxygenation);
    skin.epidermis = float(s.epidermis);
    skin.scattering = float(s.scattering);
    skin.scatteringPower = float(s.scatteringPower);
    skin.water = 0;
    return skin;
}

float reflectanceAt(const PelSkin& skin, float nanometres) {
    float value = -1;
    pellucid::check(pelSkinReflectance(&skin, &nanometres, 1, &value));
    return value;
}

// Pale, brown and very dark; bloodless and as bloody as can be; thin and thick; two for which a table of
// coarse nodes has its largest errors.
constexpr reference::WalkedSkin skins[] = {
    {0.01, 1, 0.002, 0.75, 0.06, 4.6, 1.421}, {0.1, 0.5, 0.02, 0.75, 0.06, 4.6, 1.421},
    {0.4, 1, 0.02, 0.5, 0.06, 4.6, 1.421},    {0, 1, 0.2, 1, 0.02, 2, 0.5},
    {0.02, 0, 0.05, 0.9, 0.4, 7, 1.5},        {0.5, 1, 0, 0, 0.5, 10, 2.5},
    {0.4, 1, 0.05, 0.75, 0.14, 3.8, 0.85},    {0, 1, 0, 0.75, 0.05, 10, 0.7}};

TEST(Skin, ReflectsWhatARandomWalkDoes) {
    for (const auto& s : skins)
        for (const int nm : {390, 420, 540, 630}) {
            const auto walk = reference::walkSkin(reference::layersOf(s, nm), 1.4, 20000, 7);
            EXPECT_NEAR(reflectanceAt(skinOf(s), float(nm)), walk.reflectance,
                        tolerance::skinReflectance + 3 * walk.error)
                << nm << " nm, melanin " << s.melanin << ", blood " << s.blood;
        }
}

TEST(Skin, ChannelsAndDistancesAreThoseOfARandomWalk) {
    for (const auto& s : skins) {
        if (s.blood == 0.2) continue;  // its bands are narrower than the steps of the oracle
        const auto walk = reference::walkChannels(s, s.melanin > 0.2 ? 20000 : 6000);
        const PelSkinInfo info = skinInfo(skinOf(s));
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(info.albedo[c], walk.albedo[c], tolerance::skinAlbedo) << c << ", " << s.melanin;
            EXPECT_NEAR(info.meanDistance[c] / walk.meanDistance[c], 1, tolerance::skinDistance)
                << c << ", melanin " << s.melanin;
            EXPECT_LT(info.profileError[c], tolerance::skinProfile);
        }
    }
}

// At each wavelength, whatever the other fields are. Channels of linear sRGB have negative weights as well.
TEST(Skin, MorePigmentReflectsLessOverTheWholeRange) {
    std::mt19937 random(1);
    std::vector<float> nanometres, before, now;
    for (int nm = 380; nm <= 720; nm += 5) nanometres.push_back(float(nm));
    now.resize(nanometres.size());
    for (int i = 0; i < sized(60, 6); ++i) {
        PelSkin skin = pelSkinDefaults();
#define DRAW(type, name, value, min, max, ...) \
    skin.name = std::uniform_real_distribution<float>(min, max)(random);
        PEL_EACH_SKIN_FIELD(DRAW)
#undef DRAW
        float& pigment = i % 2 ? skin.blood : skin.melanin;
        const float most = i % 2 ? pel::range::skin::blood.max : pel::range::skin::melanin.max;
        before.assign(now.size(), 1);
        for (int step = 0; step <= 40; ++step) {
            pigment = most * float(step * step) / 1600;
            pellucid::check(pelSkinReflectance(&skin, nanometres.data(), uint32_t(now.size()), now.data()));
            for (size_t k = 0; k < now.size(); ++k)
                EXPECT_LE(now[k], before[k] + 1e-6f) << nanometres[k] << " nm, " << pigment;
            before = now;
        }
    }
}

// Without pigment, skin reflects most of the light that enters it (94 %), and more if it scatters more.
TEST(Skin, NoLightIsMade) {
    PelSkin skin = pelSkinDefaults();
    skin.melanin = skin.blood = skin.water = 0;
    float before = 0;
    for (const float scattering : {2.0f, 4.0f, 7.0f, 10.0f}) {
        skin.scattering = scattering;
        const float r = reflectanceAt(skin, 720);
        EXPECT_GT(r, before);
        EXPECT_LT(r, 0.94f);
        before = r;
    }
    EXPECT_GT(before, 0.6f);  // what bare tissue absorbs is missing
}

// Equal energy is white of equal coordinates, and daylight has its place in the standard's diagram.
TEST(Skin, MatchingFunctionsAndDaylightAreTheStandards) {
    double even[3]{}, day[3]{};
    for (const pel::SkinSpectrum& s : pel::skinSpectra)
        for (int c = 0; c < 3; ++c) {
            const double value = (&s.x)[c];
            even[c] += value, day[c] += value * double(s.d65);
        }
    for (double sum : even) EXPECT_NEAR(sum, 21.371, 0.015);
    const double all = day[0] + day[1] + day[2];
    EXPECT_NEAR(day[0] / all, 0.3127, 2e-4);
    EXPECT_NEAR(day[1] / all, 0.3290, 2e-4);
}

// The sums of the columns as they were when they were compared with their sources.
TEST(Skin, SpectraAddUp) {
    constexpr double sums[] = {37950,       4675218,     5580497,    2254754,    845315,
                               14.28130005, 21.36548603, 21.3689721, 21.3722901, 6323.180008};
    for (size_t column = 0; column < std::size(sums); ++column) {
        double sum = 0;
        for (const pel::SkinSpectrum& s : pel::skinSpectra) sum += double((&s.nanometres)[column]);
        EXPECT_NEAR(sum / sums[column], 1, 1e-7) << column;
    }
}

TEST(Skin, OxygenatedBloodShowsItsTwoBands) {
    PelSkin skin = pelSkinDefaults();
    skin.oxygenation = 1;
    EXPECT_LT(reflectanceAt(skin, 540), reflectanceAt(skin, 520));
    EXPECT_LT(reflectanceAt(skin, 540), reflectanceAt(skin, 560));
    EXPECT_LT(reflectanceAt(skin, 575), reflectanceAt(skin, 560));
    EXPECT_LT(reflectanceAt(skin, 575), reflectanceAt(skin, 600));
    skin.oxygenation = 0;  // one band, at 555 nm
    EXPECT_LT(reflectanceAt(skin, 555), reflectanceAt(skin, 540));
    EXPECT_LT(reflectanceAt(skin, 555), reflectanceAt(skin, 575));
}

TEST(Skin, MapsComeBack) {
    std::vector<float> melanin, blood;
    for (int i = 0; i <= 12; ++i)
        for (int j = 0; j <= 12; ++j) {
            melanin.push_back(0.5f * float(i * i) / 144);
            blood.push_back(0.2f * float(j * j) / 144);
        }
    const PelSkin skin = pelSkinDefaults();
    const size_t n = melanin.size();
    std::vector<float> albedo(3 * n), radius(n), m(n), b(n), difference(n);
    pellucid::check(pelSkinAlbedo(&skin, melanin.data(), blood.data(), n, albedo.data(), radius.data()));
    pellucid::check(pelSkinFromAlbedo(&skin, albedo.data(), n, m.data(), b.data(), difference.data()));
    for (size_t i = 0; i < n; ++i) {
        EXPECT_LT(difference[i], tolerance::skinRoundTrip) << melanin[i] << ' ' << blood[i];
        // Between its nodes, the table agrees with the exact value.
        PelSkin exact = skin;
        exact.melanin = melanin[i];
        exact.blood = blood[i];
        const PelSkinInfo info = skinInfo(exact);
        const auto lab = [](const float* rgb) { return pel::labFromLinear({rgb[0], rgb[1], rgb[2]}); };
        EXPECT_LT(pel::deltaE2000(lab(info.albedo), lab(&albedo[3 * i])), tolerance::skinRoundTrip);
        EXPECT_GT(radius[i], 0);
    }
    // With less oxygen, blood looks like melanin, and several pigments have nearly the same colour.
    for (const float oxygenation : {0.0f, 0.3f}) {
        PelSkin pale = skin;
        pale.oxygenation = oxygenation;
        for (size_t i = 0; i < n; ++i) melanin[i] *= 0.2f, blood[i] *= 0.2f;
        pellucid::check(pelSkinAlbedo(&pale, melanin.data(), blood.data(), n, albedo.data(), nullptr));
        pellucid::check(pelSkinFromAlbedo(&pale, albedo.data(), n, m.data(), b.data(), difference.data()));
        EXPECT_LT(*std::ranges::max_element(difference), tolerance::skinSearch) << oxygenation;
    }
    const float green[] = {0.1f, 0.6f, 0.1f}, nothing[] = {NAN, -1, 2};
    pellucid::check(pelSkinFromAlbedo(&skin, green, 1, m.data(), b.data(), difference.data()));
    EXPECT_GT(difference[0], 10);  // no such skin
    pellucid::check(pelSkinFromAlbedo(&skin, nothing, 1, m.data(), b.data(), difference.data()));
    EXPECT_TRUE(std::isfinite(m[0]) && std::isfinite(b[0]) && std::isfinite(difference[0]));
}

// The linear sRGB of a colour.
std::array<float, 3> linearOf(const pel::Lab& lab) {
    const double y = (lab[0] + 16) / 116, all[] = {y + lab[1] / 500, y, y - lab[2] / 200},
                 white[] = {0.95047, 1, 1.08883};
    double xyz[3];
    for (int i = 0; i < 3; ++i)
        xyz[i] = white[i] * (all[i] > 6.0 / 29 ? std::pow(all[i], 3) : 108.0 / 841 * (all[i] - 4.0 / 29));
    return {float(3.2404542 * xyz[0] - 1.5371385 * xyz[1] - 0.4985314 * xyz[2]),
            float(-0.969266 * xyz[0] + 1.8760108 * xyz[1] + 0.041556 * xyz[2]),
            float(0.0556434 * xyz[0] - 0.2040259 * xyz[1] + 1.0572252 * xyz[2])};
}

// The difference of each colour from the nearest skin, in ascending order.
std::vector<float> differencesOf(std::span<const pel::Lab> colors) {
    const PelSkin skin = pelSkinDefaults();
    std::vector<float> all;
    for (const pel::Lab& lab : colors) {
        float melanin, blood, difference;
        pellucid::check(pelSkinFromAlbedo(&skin, linearOf(lab).data(), 1, &melanin, &blood, &difference));
        all.push_back(difference);
    }
    std::ranges::sort(all);
    return all;
}

TEST(Skin, HasTheColoursOfMeasuredSkin) {
    EXPECT_LT(differencesOf(measured_skin::groups).back(), tolerance::skinMeasured);
    const std::vector<float> people = differencesOf(measured_skin::people);
    ASSERT_EQ(people.size(), 100u);
    EXPECT_LT(people[50], 0.5 * tolerance::skinMeasured);
    EXPECT_LT(people[90], tolerance::skinMeasured);
    EXPECT_LT(people[99], 1.3 * tolerance::skinMeasured);
}

// The classes of skin colour by their angles: Chardon, Cretois, Hourseau 1991.
TEST(Skin, ReachesAllClassesOfColour) {
    PelSkin skin = pelSkinDefaults();
    skin.blood = 0.005f;
    skin.melanin = 0.005f;
    EXPECT_GT(skinInfo(skin).typologyAngle, 55);  // very light
    skin.melanin = 0.4f;
    EXPECT_LT(skinInfo(skin).typologyAngle, -30);  // dark
}

TEST(Skin, RefusesWhatIsOutOfRangeByName) {
    PelSkinInfo info = pelSkinInfoDefaults();
    const auto refused = [&](PelSkin skin, const char* name) {
        EXPECT_EQ(pelSkinGetInfo(&skin, &info), PEL_ERROR_INVALID_ARGUMENT) << name;
        EXPECT_NE(std::string(pelGetErrorMessage()).find("PelSkin." + std::string(name)), std::string::npos)
            << pelGetErrorMessage();
    };
#define CHECK(type, name, value, min, max, ...)                                                     \
    for (const float bad : {std::nextafter(float(min), -1.0f), std::nextafter(float(max), 1e9f),    \
                            std::numeric_limits<float>::quiet_NaN(), INFINITY}) {                   \
        PelSkin skin = pelSkinDefaults();                                                           \
        skin.name = bad;                                                                            \
        refused(skin, #name);                                                                       \
    }                                                                                               \
    for (const float extreme : {float(min), float(max)}) {                                          \
        PelSkin skin = pelSkinDefaults();                                                           \
        skin.name = extreme;                                                                        \
        const PelSkinInfo finite = skinInfo(skin);                                                  \
        for (int c = 0; c < 3; ++c)                                                                 \
            EXPECT_TRUE(finite.albedo[c] > 0 && finite.albedo[c] < 1 && finite.meanDistance[c] > 0) \
                << #name;                                                                           \
    }
    PEL_EACH_SKIN_FIELD(CHECK)
#undef CHECK
    const PelSkin skin = pelSkinDefaults();
    const float beyond[] = {500, 721};
    float values[] = {-1, -1};
    EXPECT_EQ(pelSkinReflectance(&skin, beyond, 2, values), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(values[0], -1);
}

TEST(Skin, IsAProfile) {
    const pellucid::Profile profile = pellucid::Profile::skinLayers(pelSkinDefaults());
    const PelProfileInfo info = profile.info();
    EXPECT_EQ(info.kind, PEL_PROFILE_SKIN_LAYERS);
    EXPECT_GT(info.width[0], info.width[1]);
    EXPECT_GT(info.width[1], info.width[2]);
    for (const double value : profile.radial({0.01, 0.1, 1, 5})) EXPECT_GE(value, 0);
}

}  // namespace
