#include "lut/profile.h"

#include <cstring>

#include "shared/choices.h"

namespace pel {

#define KEY(name, number, key) key,
static constexpr const char* kindNames[] = {PEL_EACH_PROFILE_KIND(KEY)};
#undef KEY

GaussianShape::GaussianShape(std::vector<GaussianTerm> terms) : terms_(std::move(terms)) {
    std::stable_sort(terms_.begin(), terms_.end(),
                     [](const auto& a, const auto& b) { return a.variance < b.variance; });
    for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (const GaussianTerm& term : terms_) sum += term.weight[c];
        if (!(sum > 0) || !std::isfinite(sum))
            invalidArgument("the ", channelNames[c], " weights of the profile add up to ", sum,
                            "; at least one above 0 is needed, and their sum must be finite");
        for (GaussianTerm& term : terms_) term.weight[c] /= sum;
    }
}

// Sum of weight times f(variance).
template <class F>
Rgb GaussianShape::sum(F&& f) const {
    Rgb sum{};
    for (const GaussianTerm& term : terms_) sum += f(term.variance) * term.weight;
    return sum;
}

Rgb GaussianShape::radial(double d) const {
    return sum([=](double v) { return std::exp(-d * d / (2 * v)) / (2 * pi * v); });
}

Rgb GaussianShape::lineSpread(double s) const {
    return sum([=](double v) { return std::exp(-s * s / (2 * v)) / std::sqrt(2 * pi * v); });
}

Rgb GaussianShape::width() const {
    Rgb width = sum([](double v) { return v; });
    for (double& w : width) w = std::sqrt(w);
    return width;
}

Rgb GaussianShape::transmission(double d) const {
    return sum([=](double v) { return std::exp(-d * d / (2 * v)); });
}

Profile::Profile(PelProfileKind profileKind, std::unique_ptr<ProfileShape> shape,
                 std::optional<double> radius)
    : Object(kind),
      profileKind_(profileKind),
      radius_(radius ? *radius : largest(shape->width())),
      shape_(std::move(shape)),
      terms_(shape_->gaussians()),
      name_(kindNames[profileKind]) {}

Ref<Profile> Profile::skin() {
    // d'Eon and Luebke, GPU Gems 3, chapter 14: the six-Gaussian fit to a three-layer skin model, with the
    // sigmas of FaceWorks in mm. (The published variances are the rounded squares, which changes tables by up
    // to 1.2e-4.) As in FaceWorks, the radius of the profile is 2.7 mm, not the widest sigma of 2.722 mm.
    std::vector<GaussianTerm> terms{
        {0.080 * 0.080, {0.233, 0.455, 0.649}}, {0.220 * 0.220, {0.100, 0.336, 0.344}},
        {0.432 * 0.432, {0.118, 0.198, 0.0}},   {0.753 * 0.753, {0.113, 0.007, 0.007}},
        {1.411 * 1.411, {0.358, 0.004, 0.0}},   {2.722 * 2.722, {0.078, 0.0, 0.0}}};
    return make<Profile>(PEL_PROFILE_SKIN, std::make_unique<GaussianShape>(std::move(terms)), 2.7);
}

Ref<Profile> Profile::gaussians(const PelGaussian* gaussians, uint32_t count) {
    constexpr uint32_t most = 256;
    if (!gaussians || count < 1 || count > most)
        invalidArgument("a profile of Gaussians needs 1 to ", most, " of them, not ", gaussians ? count : 0);
    std::vector<GaussianTerm> terms;
    double widest = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const PelGaussian& g = gaussians[i];
        if (!std::isfinite(g.variance) || g.variance <= 0)
            invalidArgument("the variance of Gaussian ", i, " is ", g.variance,
                            "; a finite length^2 above 0 is needed");
        bool used = false;
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(g.weight[c]) || g.weight[c] < 0)
                invalidArgument("the ", channelNames[c], " weight of Gaussian ", i, " is ", g.weight[c],
                                "; a finite value of 0 or more is needed");
            used = used || g.weight[c] > 0;
        }
        if (used) widest = std::max<double>(widest, g.variance);
        terms.push_back({g.variance, {g.weight[0], g.weight[1], g.weight[2]}});
    }
    Ref<Profile> profile = make<Profile>(
        PEL_PROFILE_GAUSSIANS, std::make_unique<GaussianShape>(std::move(terms)), std::sqrt(widest));
    for (uint32_t i = 0; i < count; ++i) {
        const auto& [variance, weight] = gaussians[i];
        profile->recipe_.rows.push_back({variance, weight[0], weight[1], weight[2]});
    }
    return profile;
}

PelProfileInfo Profile::info() const {
    PelProfileInfo info = pelProfileInfoDefaults();
    info.kind = profileKind_;
    info.radius = float(radius_);
    const Rgb width = shape_->width();
    const double widest = largest(width);
    for (int c = 0; c < 3; ++c) {
        info.width[c] = float(width[c]);
        info.normalBlend[c] = float(std::max(0.0, 1 - std::log2(widest / width[c]) / 3));
    }
    info.gaussians = uint32_t(terms_.size());
    info.singular = shape_->singular();
    std::strncpy(info.name, name().c_str(), sizeof info.name - 1);
    std::strncpy(info.source, source_, sizeof info.source - 1);
    std::ranges::copy(shape_->meanFreePath(), info.meanFreePath);
    info.reach = float(reach());
    return info;
}

ProfileRecipe Profile::recipe() const {
    ProfileRecipe recipe = recipe_;
    recipe.kind = profileKind_;
    recipe.name = name();
    if (pigments_) recipe.skin = *pigments_;
    return recipe;
}

double Profile::reach() const {
    const auto most = [&](double distance) { return largest(shape_->transmission(distance)); };
    if (const double known = reach_; known > 0) return known;
    constexpr double left = 1e-3;
    double inside = 0, outside = radius_;
    while (most(outside) > left) inside = outside, outside *= 2;
    for (int i = 0; i < 40; ++i) {
        const double middle = (inside + outside) / 2;
        (most(middle) > left ? inside : outside) = middle;
    }
    reach_ = outside;
    return outside;
}

void Profile::setName(const char* name) {
    if (!name || !*name || std::strlen(name) > 63) invalidArgument("a profile's name has 1 to 63 bytes");
    std::lock_guard lock(nameMutex_);
    name_ = name;
}

namespace {

constexpr const char* jensen = "Jensen et al. 2001, figure 5";
constexpr const char* jensenSkin1 = "Jensen et al. 2001, figure 5: skin1";
constexpr const char* jensenSkin2 = "Jensen et al. 2001, figure 5: skin2";
constexpr const char* jensenChicken = "Jensen et al. 2001, figure 5: chicken1";
constexpr const char* gems =
    "d'Eon and Luebke, GPU Gems 3, chapter 14 (six Gaussians); FaceWorks 1.0 (sigmas)";
constexpr const char* look = "chosen for its look, not measured; shape of Christensen and Burley 2015";
constexpr const char* skin1ByBurley =
    "mean free paths 1/(absorption + reduced scattering) of skin1 of Jensen et al. 2001, its diffuse "
    "reflectance there as albedo; shape of Christensen and Burley 2015";
constexpr PelProfileKind dipole = PEL_PROFILE_DIPOLE, burley = PEL_PROFILE_BURLEY;

// Dipoles: coefficients of Jensen, Marschner, Levoy, Hanrahan, A Practical Model for Subsurface Light
// Transport, SIGGRAPH 2001, figure 5, in 1/mm, with eta as there. Burley: mean free path in mm, and albedo.
constexpr LibraryProfile library[] = {
    {"skin", PEL_PROFILE_SKIN, gems, {}, {}, 0},
    {"skin-pale", dipole, jensenSkin2, {0.013f, 0.070f, 0.145f}, {1.09f, 1.59f, 1.79f}, 1.3f},
    {"skin-dark", dipole, jensenSkin1, {0.032f, 0.17f, 0.48f}, {0.74f, 0.88f, 1.01f}, 1.3f},
    {"marble", dipole, jensen, {0.0021f, 0.0041f, 0.0071f}, {2.19f, 2.62f, 3.00f}, 1.5f},
    {"whole-milk", dipole, jensen, {0.0011f, 0.0024f, 0.014f}, {2.55f, 3.21f, 3.77f}, 1.3f},
    {"skim-milk", dipole, jensen, {0.0014f, 0.0025f, 0.0142f}, {0.70f, 1.22f, 1.90f}, 1.3f},
    {"cream", dipole, jensen, {0.0002f, 0.0028f, 0.0163f}, {7.38f, 5.47f, 3.15f}, 1.3f},
    {"ketchup", dipole, jensen, {0.061f, 0.97f, 1.45f}, {0.18f, 0.07f, 0.03f}, 1.3f},
    {"apple", dipole, jensen, {0.0030f, 0.0034f, 0.046f}, {2.29f, 2.39f, 1.97f}, 1.3f},
    {"potato", dipole, jensen, {0.0024f, 0.0090f, 0.12f}, {0.68f, 0.70f, 0.55f}, 1.3f},
    {"chicken", dipole, jensenChicken, {0.015f, 0.077f, 0.19f}, {0.15f, 0.21f, 0.38f}, 1.3f},
    {"skin-burley", burley, skin1ByBurley, {1.295f, 0.952f, 0.671f}, {0.44f, 0.22f, 0.13f}, 0},
    {"paraffin", burley, look, {4.0f, 3.2f, 2.2f}, {0.92f, 0.89f, 0.80f}, 0},
    {"jade", burley, look, {1.2f, 2.6f, 1.5f}, {0.35f, 0.70f, 0.42f}, 0},
};

}  // namespace

std::span<const LibraryProfile> profileLibrary() {
    return library;
}

Ref<Profile> namedProfile(const char* name) {
    if (!name) invalidArgument("a name is needed, not NULL");
    std::string known;
    for (const LibraryProfile& entry : library) {
        known.append(known.empty() ? "" : ", ").append(entry.name);
        if (std::string_view(entry.name) != name) continue;
        constexpr PelBurleyFit fit = PEL_BURLEY_DIFFUSE_TRANSMISSION;
        Ref<Profile> profile = entry.kind == PEL_PROFILE_SKIN ? Profile::skin()
                               : entry.kind == dipole ? Profile::dipole(entry.first, entry.second, entry.eta)
                                                      : Profile::burley(entry.first, entry.second, fit);
        profile->setName(entry.name);
        profile->setSource(entry.source);
        return profile;
    }
    invalidArgument("'", name, "' is not a material of the library (", known, ")");
}

}  // namespace pel
