#include "reference/profile.h"

#include <numbers>
#include <stdexcept>
#include <unordered_map>

#include "reference/quadrature.h"

namespace reference {
namespace {

constexpr double pi = std::numbers::pi;

class GaussiansProfile : public Profile {
  public:
    GaussiansProfile(std::vector<Gaussian> gaussians, double radius)
        : gaussians_(std::move(gaussians)), radius_(radius) {
        Rgb sum;
        for (const Gaussian& g : gaussians_) {
            if (!(g.variance > 0)) throw std::invalid_argument("a Gaussian's variance must be above 0");
            sum = sum + g.weight;
        }
        for (int c = 0; c < 3; ++c)
            if (!(sum[c] > 0)) throw std::invalid_argument("a channel's weights must add up to more than 0");
        for (Gaussian& g : gaussians_)
            for (int c = 0; c < 3; ++c) g.weight[c] /= sum[c];
    }
    Rgb radial(double d) const override {
        Rgb sum;
        for (const Gaussian& g : gaussians_)
            sum = sum + std::exp(-d * d / (2 * g.variance)) / (2 * pi * g.variance) * g.weight;
        return sum;
    }
    Rgb lineSpread(double s) const override {
        Rgb sum;
        for (const Gaussian& g : gaussians_)
            sum = sum + std::exp(-s * s / (2 * g.variance)) / std::sqrt(2 * pi * g.variance) * g.weight;
        return sum;
    }
    std::vector<double> lengths() const override {
        std::vector<double> all;
        for (const Gaussian& g : gaussians_)
            for (double k : {1.0, 3.0, 6.0, 12.0}) all.push_back(k * std::sqrt(g.variance));
        std::sort(all.begin(), all.end());
        return all;
    }
    double radius() const override { return radius_; }

  private:
    std::vector<Gaussian> gaussians_;
    double radius_;
};

class TableProfile : public Profile {
  public:
    TableProfile(std::vector<double> distances, std::vector<Rgb> values)
        : distances_(std::move(distances)), values_(std::move(values)) {
        if (distances_.empty() || distances_.size() != values_.size())
            throw std::invalid_argument("a table needs as many values as distances, at least one");
        for (size_t i = 0; i < distances_.size(); ++i)
            if (distances_[i] < 0 || (i > 0 && distances_[i] <= distances_[i - 1]))
                throw std::invalid_argument("distances must be non-negative and rise");
        const Rgb energy = enclosedEnergy(*this, distances_.back());
        for (int c = 0; c < 3; ++c)
            if (!(energy[c] > 0)) throw std::invalid_argument("a channel of the table holds no energy");
        for (Rgb& value : values_)
            for (int c = 0; c < 3; ++c) value[c] /= energy[c];
        radius_ = magnitude(rmsWidth(*this));
    }
    Rgb radial(double d) const override {
        if (d <= distances_.front()) return values_.front();
        if (d > distances_.back()) return {};
        size_t i = 1;
        while (distances_[i] < d) ++i;
        return mix(values_[i - 1], values_[i], (d - distances_[i - 1]) / (distances_[i] - distances_[i - 1]));
    }
    // Along the line d = sqrt(s^2 + t^2), and int d dt = (t d + s^2 asinh(t/s)) / 2: no quadrature inside of
    // others.
    Rgb lineSpread(double offset) const override {
        const double s = std::abs(offset);
        Rgb sum;
        double a = 0;  // pieces [a, b]: constant up to the first distance, then linear
        for (size_t i = 0; i < distances_.size(); ++i) {
            const double b = distances_[i];
            if (b > s && b > a) {
                const Rgb slope = i ? (1 / (b - a)) * (values_[i] - values_[i - 1]) : Rgb{};
                const double from = a > s ? std::sqrt((a - s) * (a + s)) : 0,
                             to = std::sqrt((b - s) * (b + s));
                auto meanDistance = [&](double t) {
                    return 0.5 * (t * std::hypot(s, t) + (s > 0 ? s * s * std::asinh(t / s) : 0));
                };
                sum = sum + 2 * (to - from) * (values_[i] - b * slope) +
                      2 * (meanDistance(to) - meanDistance(from)) * slope;
            }
            a = b;
        }
        return sum;
    }
    std::vector<double> lengths() const override { return distances_; }
    double radius() const override { return radius_; }

  private:
    std::vector<double> distances_;
    std::vector<Rgb> values_;
    double radius_ = 0;
};

class ScaledProfile : public Profile {
  public:
    ScaledProfile(ProfilePtr profile, double factor) : profile_(std::move(profile)), factor_(factor) {
        if (!(factor > 0)) throw std::invalid_argument("a profile is scaled by a factor above 0");
    }
    Rgb radial(double d) const override { return profile_->radial(d / factor_) / (factor_ * factor_); }
    Rgb lineSpread(double s) const override { return profile_->lineSpread(s / factor_) / factor_; }
    std::vector<double> lengths() const override {
        auto all = profile_->lengths();
        for (double& l : all) l *= factor_;
        return all;
    }
    bool singularAtZero() const override { return profile_->singularAtZero(); }
    double radius() const override { return profile_->radius() * factor_; }

  private:
    ProfilePtr profile_;
    double factor_;
};

class MemoisedProfile : public Profile {
  public:
    explicit MemoisedProfile(ProfilePtr profile) : profile_(std::move(profile)) {}
    Rgb radial(double d) const override { return profile_->radial(d); }
    Rgb lineSpread(double s) const override {
        const auto [at, added] = known_.try_emplace(std::abs(s));
        if (added) at->second = profile_->lineSpread(s);
        return at->second;
    }
    std::vector<double> lengths() const override { return profile_->lengths(); }
    bool singularAtZero() const override { return profile_->singularAtZero(); }
    double radius() const override { return profile_->radius(); }

  private:
    ProfilePtr profile_;
    mutable std::unordered_map<double, Rgb> known_;
};

}  // namespace

Rgb Profile::lineSpread(double offset) const {
    const double s = std::abs(offset);
    if (s == 0 && singularAtZero())
        throw std::domain_error("the line spread of this profile is infinite at 0");
    const auto all = lengths();
    if (s >= all.back()) return {};  // the last length is where a profile ends
    // t = stretch sinh(y) spreads many scales evenly and takes the 1/d of a singular profile away.
    const double stretch = singularAtZero() ? s : std::max(s, all.front() > 0 ? all.front() : all.back());
    std::vector<double> borders;
    for (double l : all)
        if (l > s) borders.push_back(std::asinh(std::sqrt((l - s) * (l + s)) / stretch));
    const double end = borders.back();
    auto integrand = [&](double y) {
        const double t = stretch * std::sinh(y);
        return stretch * std::cosh(y) * radial(std::hypot(s, t));
    };
    Rgb peak;  // channels may differ by orders of magnitude: integrate each against its own size
    for (double y : panelPoints(0, end, borders)) {
        const Rgb sample = integrand(y);
        for (int c = 0; c < 3; ++c) peak[c] = std::max(peak[c], sample[c]);
    }
    Rgb scale;  // a channel that has all but underflown stays 0
    for (int c = 0; c < 3; ++c) scale[c] = peak[c] > 1e-290 ? 1 / peak[c] : 0;
    return 2 * peak *
           integrate<Rgb>([&](double y) { return scale * integrand(y); }, panelPoints(0, end, borders),
                          1e-15 * end, 1e-13);
}

ProfilePtr skinProfile() {
    // d'Eon & Luebke, GPU Gems 3, ch. 14: the six-Gaussian fit of three-layer skin, by its sigmas in mm as
    // FaceWorks takes them. (The variances printed beside them are their squares, rounded; the difference is
    // 3e-5 in a LUT.)
    const double sigma[6] = {0.080, 0.220, 0.432, 0.753, 1.411, 2.722};
    const Rgb weight[6] = {{0.233, 0.455, 0.649}, {0.100, 0.336, 0.344}, {0.118, 0.198, 0},
                           {0.113, 0.007, 0.007}, {0.358, 0.004, 0},     {0.078, 0, 0}};
    std::vector<Gaussian> gaussians;
    for (int i = 0; i < 6; ++i) gaussians.push_back({sigma[i] * sigma[i], weight[i]});
    return std::make_shared<GaussiansProfile>(std::move(gaussians), 2.7);
}

ProfilePtr gaussiansProfile(std::vector<Gaussian> gaussians) {
    double widest = 0;
    for (const Gaussian& g : gaussians)
        if (magnitude(g.weight) > 0) widest = std::max(widest, g.variance);
    return std::make_shared<GaussiansProfile>(std::move(gaussians), std::sqrt(widest));
}

ProfilePtr tableProfile(std::vector<double> distances, std::vector<Rgb> values) {
    return std::make_shared<TableProfile>(std::move(distances), std::move(values));
}

ProfilePtr scaledProfile(ProfilePtr profile, double factor) {
    return std::make_shared<ScaledProfile>(std::move(profile), factor);
}

ProfilePtr memoisedProfile(ProfilePtr profile) {
    return std::make_shared<MemoisedProfile>(std::move(profile));
}

ProfilePtr profileForRadius(ProfilePtr profile, double diffusionRadius) {
    const double factor = diffusionRadius / profile->radius();
    return scaledProfile(std::move(profile), factor);
}

namespace {

Rgb diskIntegral(const Profile& profile, double discRadius, bool secondMoment) {
    auto integrand = [&](double d) { return 2 * pi * d * (secondMoment ? d * d : 1.0) * profile.radial(d); };
    const auto borders = panelPoints(0, discRadius, profile.lengths());
    Rgb result;
    for (int c = 0; c < 3; ++c)
        result[c] = integrate<double>([&](double d) { return integrand(d)[c]; }, borders, 0, 1e-12);
    return result;
}

}  // namespace

Rgb rmsWidth(const Profile& profile) {
    Rgb width = diskIntegral(profile, profile.lengths().back(), true);
    for (int c = 0; c < 3; ++c) width[c] = std::sqrt(0.5 * width[c]);
    return width;
}

Rgb enclosedEnergy(const Profile& profile, double discRadius) {
    return diskIntegral(profile, discRadius, false);
}

}  // namespace reference
