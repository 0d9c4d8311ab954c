// Descriptions of look-up tables, and their comparison with the oracle's numbers, for tests.
#pragma once
#include "test.h"

#include "npy.h"
#include "reference/lut.h"

namespace fixture {

// Every form, and what the oracle calls it.
inline constexpr std::pair<PelCurvatureForm, reference::Form> forms[] = {
    {PEL_FORM_ARC, reference::Form::arc},
    {PEL_FORM_RING, reference::Form::ring},
    {PEL_FORM_HALF_RING, reference::Form::halfRing},
    {PEL_FORM_SPHERE, reference::Form::sphere},
    {PEL_FORM_PENNER_RING, reference::Form::pennerRing}};

// Of the profile as it is, on the axis of roots; `least`, `most`: radii of curvature in units of the
// profile's.
inline PelCurvatureLutDesc curvatureTable(const pellucid::Profile& profile, PelCurvatureForm form,
                                          uint32_t width, uint32_t height, double least, double most) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = width;
    desc.height = height;
    desc.form = form;
    desc.axis = PEL_AXIS_ROOT;
    desc.diffusionRadius = 0;
    desc.profile = profile.get();
    desc.radiusMin = float(least * profile.info().radius);
    desc.radiusMax = float(most * profile.info().radius);
    return desc;
}

// `least`, `most`: widths of the penumbra in units of the profile's radius.
inline PelShadowLutDesc shadowTable(const pellucid::Profile& profile, uint32_t width, uint32_t height,
                                    double least, double most, float sharpening) {
    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
    desc.width = width;
    desc.height = height;
    desc.profile = profile.get();
    desc.diffusionRadius = 0;
    desc.widthMin = float(least * profile.info().radius);
    desc.widthMax = float(most * profile.info().radius);
    desc.sharpening = sharpening;
    return desc;
}

// The same profile in the library and in the oracle.
struct ProfileCase {
    std::string name;
    pellucid::Profile ours;
    reference::ProfilePtr truth;
    double tolerance;  // of texels
};

// A measured profile: distances, and R, G, B for each.
inline ProfileCase tableCase(const char* name, const std::vector<float>& distances,
                             const std::vector<float>& values) {
    std::vector<reference::Rgb> R;
    for (size_t i = 0; i < values.size(); i += 3) R.push_back({values[i], values[i + 1], values[i + 2]});
    return {name, pellucid::Profile::table(distances, values),
            reference::tableProfile(std::vector<double>(distances.begin(), distances.end()), R),
            tolerance::lutTexelOther};
}

inline ProfileCase gaussiansCase(const std::string& name, const std::vector<PelGaussian>& gaussians) {
    std::vector<reference::Gaussian> same;
    for (const PelGaussian& g : gaussians)
        same.push_back({g.variance, {g.weight[0], g.weight[1], g.weight[2]}});
    return {name, pellucid::Profile::gaussians(gaussians), reference::gaussiansProfile(same),
            tolerance::lutTexelGaussians};
}

inline std::vector<ProfileCase> tables() {
    std::mt19937 random(17);
    std::uniform_real_distribution<float> even(0, 1);
    std::vector<float> at, noise, logarithmic, measured;
    for (int i = 0; i < 20; ++i) {
        at.push_back(float(i) + 0.5f * even(random));
        for (int c = 0; c < 3; ++c) noise.push_back(even(random));
    }
    // Like a measurement of Burley's profile: logarithmic distances, three decades of R.
    for (int i = 0; i < 40; ++i) {
        const float d = 0.01f * std::pow(10.0f, 3.2f * float(i) / 39);
        logarithmic.push_back(d);
        for (float decay : {1.0f, 0.6f, 0.3f}) measured.push_back(std::exp(-d / decay) / d);
    }
    const std::vector<float> falling{9, 8, 7, 4, 3, 2, 1, .5f, .2f, .2f, .05f, .01f, 0, 0, 0};
    return {tableCase("smooth", {0, 0.5f, 1, 2, 4}, falling),
            tableCase("ends in a step", {0.3f, 1, 3}, {3, 1, 1, 2, 1, 0.5f, 1, 1, 0.1f}),
            tableCase("disk", {1, 2}, {1, 1, 1, 1, 1, 1}),
            tableCase("hollow", {0, 0.9f, 1, 1.2f, 3},
                      {0.1f, 0.01f, 1, 0.1f, 0.02f, 1, 5, 1, 0.2f, 0, 0.1f, 0, 0, 0, 0}),
            tableCase("noise", at, noise),
            tableCase("measured", logarithmic, measured)};
}

// Every kind of profile.
inline std::vector<ProfileCase> profiles() {
    using reference::Rgb;
    using Three = float[3];
    const auto rgb = [](const Three& v) { return Rgb{v[0], v[1], v[2]}; };
    const auto dipole = [&](const char* name, const Three& absorption, const Three& scattering, float eta) {
        return ProfileCase{name, pellucid::Profile::dipole(absorption, scattering, eta),
                           reference::dipoleProfile(rgb(absorption), rgb(scattering), eta),
                           tolerance::lutTexelOther};
    };
    const Three path = {3.67f, 1.37f, 0.68f}, albedo = {0.9f, 0.6f, 0.45f};
    std::vector<ProfileCase> all{
        {"skin", pellucid::Profile::skin(), reference::skinProfile(), tolerance::lutTexelGaussians},
        gaussiansCase("three Gaussians", {{0.01f, {1, 2, 3}}, {0.5f, {2, 0, 1}}, {9, {1, 1, 0}}}),
        gaussiansCase("one Gaussian", {{4, {1, 1, 1}}}),
        {"burley", pellucid::Profile::burley(path, albedo), reference::burleyProfile(rgb(path), rgb(albedo)),
         tolerance::lutTexelOther},
        // Jensen et al. 2001, 1/mm.
        dipole("marble", {0.0021f, 0.0041f, 0.0071f}, {2.19f, 2.62f, 3.00f}, 1.5f),
        dipole("ketchup", {0.061f, 0.97f, 1.45f}, {0.18f, 0.07f, 0.03f}, 1.3f)};
    std::mt19937 random(100);
    const auto logUniform = [&](double min, double max) {
        return float(min * std::pow(max / min, std::uniform_real_distribution<>(0, 1)(random)));
    };
    for (int i = 0; i < 8; ++i) {
        std::vector<PelGaussian> gaussians(1 + random() % 6);
        for (PelGaussian& g : gaussians) {
            g.variance = logUniform(1e-4, 100);
            for (float& w : g.weight) w = logUniform(1e-3, 1);
        }
        all.push_back(gaussiansCase("random Gaussians " + std::to_string(i), gaussians));
    }
    for (ProfileCase& table : tables()) all.push_back(std::move(table));
    return all;
}

}  // namespace fixture
