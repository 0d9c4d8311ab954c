#include "shading/material.h"

#include "core/handle_table.h"
#include "lut/luts.h"
#include "shading/features.h"

namespace pel {
namespace {

// How far before a surface an occluder counts, in standard deviations of the widest line spread:
// docs/guide/shading.md, "Materials", compares other values. Softness and slope are not lengths.
constexpr double biasWidths = 0.1;
constexpr float softness = 0.1f, coneSlope = 0.8f;
// Without a profile, mm.
constexpr double plainFilterWidth = 8, plainBias = 0.5;
constexpr float plainSoftness = 0.25f, plainConeSlope = 0.5f;
constexpr double pathOfBurley = 1.087;  // mean free path over Burley's d at a reflectance of 0.8 (section 12)
const double widthOfBurley = std::sqrt(7.0);  // over its d
constexpr float noBlend[3] = {1, 0.3f, 0};
constexpr uint32_t transmissionTexels = 256;

double widest(const PelProfileInfo& profile) {
    return std::max({profile.width[0], profile.width[1], profile.width[2]});
}

// A table's radius in the scene's unit. A description without one means the profile's, in mm.
float radiusOf(const Lut& lut, double unit) {
    return lut.hasOwnRadius() ? float(lut.diffusionRadius() / unit) : lut.diffusionRadius();
}

Ref<Lut> curvatureTable(const Ref<Device>& device, Profile& profile) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescDefaults();
    const LentHandle<PelProfile, Profile> lent{Ref<Profile>(&profile)};
    desc.profile = lent.get();
    return integrateCurvatureLut(device, desc);
}

Ref<Lut> shadowTable(const Ref<Device>& device, Profile& profile, float filterWidth) {
    PelShadowLutDesc desc = pelShadowLutDescDefaults();
    const LentHandle<PelProfile, Profile> lent{Ref<Profile>(&profile)};
    desc.profile = lent.get();
    desc.widthMin = filterWidth;
    return integrateShadowLut(device, desc);
}

// Linear in the root of thickness: fine where it falls steeply.
Ref<Lut> transmissionTable(const Ref<Device>& device, const Profile& profile) {
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SPECULAR;
    info.specular.width = transmissionTexels;
    info.specular.height = 1;
    std::vector<float> texels;
    const double reach = transmissionReach(profile);
    for (uint32_t i = 0; i < transmissionTexels; ++i) {
        const double t = double(i) / (transmissionTexels - 1);
        const Rgb through = profile.shape().transmission(reach * t * t);
        for (double value : through) texels.push_back(i + 1 < transmissionTexels ? float(value) : 0.0f);
    }
    return uploadLut(device, info, texels.data(), texels.size() * sizeof(float));
}

}  // namespace

double meanFreePath(const Profile& profile, int channel) {
    const double path = profile.shape().mediumPath()[channel];
    if (path > 0) return path;
    const PelProfileInfo info = profile.info();
    return info.kind == PEL_PROFILE_BURLEY ? pathOfBurley * info.width[channel] / widthOfBurley : 0;
}

double mediumAbsorption(double lengths) {
    double least = 0.02, most = 0.95;
    for (int i = 0; i < 24; ++i) {
        const double s = (least + most) / 2;
        const bool below = mediumPathOver(s) < lengths;
        (below ? least : most) = s;
    }
    return least;
}

double mediumAbsorption(const Profile& profile, int channel) {
    return mediumAbsorption(widthOfBurley * meanFreePath(profile, channel) / profile.info().width[channel]);
}

// Fitted to random walks in balls of 3.5 to 24 mean free paths with reflectances from 0.15 to 0.95; at 0.8
// also to a head.
void describeGain(const Profile& profile, float (&slope)[3], float (&saturation)[3]) {
    for (int c = 0; c < 3; ++c) {
        if (!(meanFreePath(profile, c) > 0)) continue;
        const double s = mediumAbsorption(profile, c);
        slope[c] = float(1.3 + 0.6 * s);
        saturation[c] = float(0.072 * std::pow(s, -1.6));
    }
}

double transmissionReach(const Profile& profile) {
    return 2 * profile.reach();
}

ProfileTables::Tables& ProfileTables::get(const Ref<Device>& device, Profile& profile, float filterWidth) {
    for (Tables& known : all_)
        if (known.profile.get() == &profile && known.filterWidth == filterWidth) return known;
    all_.push_back({Ref<Profile>(&profile), filterWidth, transmissionTable(device, profile), {}, {}});
    return all_.back();
}

void ProfileTables::keepOnly(const std::map<uint32_t, ShaderMaterial>& materials) {
    std::erase_if(all_, [&](const Tables& t) {
        return std::none_of(materials.begin(), materials.end(), [&](const auto& m) {
            return m.second.transmission.get() == t.transmission.get();
        });
    });
}

void resolveMaterial(ShaderMaterial& material, const Ref<Device>& device, const PelShaderOptions& options,
                     ProfileTables& tables) {
    PelMaterial m = material.given;
    const double unit = options.millimetresPerUnit;
    Profile* profile = material.profile.get();
    const PelProfileInfo info = profile ? profile->info() : pelProfileInfoDefaults();
    material.curvatureLut = material.givenCurvatureLut;
    material.shadowLut = material.givenShadowLut;
    material.transmission = {};
    if (m.shadowFilterWidth == 0)
        m.shadowFilterWidth =
            float((profile ? double(pelShadowFilterWidthOf(&info)) : plainFilterWidth) / unit);
    material.shadowBias = float((profile ? biasWidths * widest(info) : plainBias) / unit);
    material.shadowSoftness = profile ? softness : plainSoftness;
    material.shadowConeSlope = profile ? coneSlope : plainConeSlope;
    if (profile)
        material.transmission = tables.get(device, *profile, float(m.shadowFilterWidth * unit)).transmission;
    if (m.diffusionRadius == 0)
        m.diffusionRadius = profile                 ? float(profile->radius() / unit)
                            : material.curvatureLut ? radiusOf(*material.curvatureLut, unit)
                            : material.shadowLut    ? radiusOf(*material.shadowLut, unit)
                                                    : float(Profile::skin()->radius() / unit);
    for (int c = 0; c < 3; ++c)
        if (m.normalBlend[c] < 0) m.normalBlend[c] = profile ? info.normalBlend[c] : noBlend[c];
    if (!profile) m.transmission = 0;
    const double stretch =
        profile ? m.diffusionRadius / profile->radius() : 1;  // of its lengths, in the scene's unit
    material.gainWindow = 0;
    for (int c = 0; c < 3; ++c) {
        const double path = profile ? meanFreePath(*profile, c) * stretch : 0;
        material.gain[c] = m.scattering == PEL_SCATTERING_NONE ? 0 : float(m.curvatureGain * path);
        material.absorption[c] = profile && path > 0 ? float(mediumAbsorption(*profile, c)) : 0;
        material.gainWindow = std::max(material.gainWindow, float(windowOfPath * path));
    }
    if (profile) describeGain(*profile, material.gainSlope, material.gainSaturation);
    const Rgb through =
        profile && m.thinThickness > 0 ? profile->shape().transmission(m.thinThickness / stretch) : Rgb{};
    for (int c = 0; c < 3; ++c) material.through[c] = float(m.transmission * through[c]);
    material.params = m;
}

void withTables(ShaderState& state, const Ref<Device>& device, ProfileTables& tables) {
    const double unit = state.options.millimetresPerUnit;
    for (auto& [id, material] : state.materials) {
        if (!material.profile || readsIrradiance(material)) continue;
        Profile& profile = *material.profile;
        const auto width = float(material.params.shadowFilterWidth * unit);
        ProfileTables::Tables& made = tables.get(device, profile, width);
        if (!material.curvatureLut) {
            if (!made.curvature) made.curvature = curvatureTable(device, profile);
            material.curvatureLut = made.curvature;
        }
        if (!material.shadowLut) {
            if (!made.shadow) made.shadow = shadowTable(device, profile, width);
            material.shadowLut = made.shadow;
        }
    }
}

}  // namespace pel
