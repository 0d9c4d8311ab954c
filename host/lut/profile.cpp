#include "lut/profile.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "shared/choices.h"

namespace pel {
namespace {

constexpr double pi = std::numbers::pi;
#define KEY(name, number, key) key,
constexpr const char* kindNames[] = {PEL_EACH_PROFILE_KIND(KEY)};
#undef KEY

}  // namespace

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
    for (const GaussianTerm& term : terms_) {
        const double value = f(term.variance);
        for (int c = 0; c < 3; ++c) sum[c] += term.weight[c] * value;
    }
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

Profile::Profile(PelProfileKind profileKind, double radius, std::unique_ptr<ProfileShape> shape)
    : Object(kind),
      profileKind_(profileKind),
      radius_(radius),
      shape_(std::move(shape)),
      terms_(shape_->gaussians()),
      name_(kindNames[profileKind]) {}

Ref<Profile> Profile::skin() {
    // d'Eon and Luebke, GPU Gems 3, chapter 14: the six-Gaussian fit to a three-layer skin model, with the
    // sigmas of FaceWorks in mm. (The published variances are the rounded squares, which changes tables by
    // 3e-5.) As in FaceWorks, the radius of the profile is 2.7 mm, not the widest sigma of 2.722 mm.
    std::vector<GaussianTerm> terms{
        {0.080 * 0.080, {0.233, 0.455, 0.649}}, {0.220 * 0.220, {0.100, 0.336, 0.344}},
        {0.432 * 0.432, {0.118, 0.198, 0.0}},   {0.753 * 0.753, {0.113, 0.007, 0.007}},
        {1.411 * 1.411, {0.358, 0.004, 0.0}},   {2.722 * 2.722, {0.078, 0.0, 0.0}}};
    return make<Profile>(PEL_PROFILE_SKIN, 2.7, std::make_unique<GaussianShape>(std::move(terms)));
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
                                "; 0 or more, finite, is needed");
            used = used || g.weight[c] > 0;
        }
        if (used) widest = std::max<double>(widest, g.variance);
        terms.push_back({g.variance, {g.weight[0], g.weight[1], g.weight[2]}});
    }
    auto shape = std::make_unique<GaussianShape>(std::move(terms));
    return make<Profile>(PEL_PROFILE_GAUSSIANS, std::sqrt(widest), std::move(shape));
}

PelProfileInfo Profile::info() const {
    PelProfileInfo info = pelProfileInfoDefaults();
    info.kind = profileKind_;
    info.radius = float(radius_);
    const Rgb width = shape_->width();
    const double widest = std::max({width[0], width[1], width[2]});
    for (int c = 0; c < 3; ++c) {
        info.width[c] = float(width[c]);
        info.normalBlend[c] = float(std::max(0.0, 1 - std::log2(widest / width[c]) / 3));
    }
    info.gaussians = uint32_t(terms_.size());
    info.singular = shape_->singular();
    std::strncpy(info.name, name().c_str(), sizeof info.name - 1);
    std::strncpy(info.source, source_, sizeof info.source - 1);
    const Rgb path = shape_->meanFreePath();
    for (int c = 0; c < 3; ++c) info.meanFreePath[c] = float(path[c]);
    info.reach = float(reach());
    return info;
}

double Profile::reach() const {
    const auto most = [&](double distance) {
        const Rgb t = shape_->transmission(distance);
        return std::max({t[0], t[1], t[2]});
    };
    constexpr double left = 1e-3;
    double inside = 0, outside = radius_;
    while (most(outside) > left) inside = outside, outside *= 2;
    for (int i = 0; i < 40; ++i) {
        const double middle = (inside + outside) / 2;
        (most(middle) > left ? inside : outside) = middle;
    }
    return outside;
}

void Profile::setName(const char* name) {
    if (!name || !*name || std::strlen(name) > 63) invalidArgument("a profile's name has 1 to 63 bytes");
    std::lock_guard lock(nameMutex_);
    name_ = name;
}

}  // namespace pel
