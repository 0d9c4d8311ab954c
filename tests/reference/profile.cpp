#include "reference/profile.h"

#include "reference/quadrature.h"

namespace reference {
namespace {

class GaussiansProfile : public Profile {
  public:
    GaussiansProfile(std::vector<Gaussian> gaussians, double radius) : gaussians_(std::move(gaussians)) {
        radius_ = radius;
        Rgb sum;
        for (const Gaussian& g : gaussians_) sum = sum + g.weight;
        for (Gaussian& g : gaussians_) g.weight = g.weight / sum;
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

  private:
    std::vector<Gaussian> gaussians_;
};

class TableProfile : public Profile {
  public:
    TableProfile(std::vector<double> distances, std::vector<Rgb> values)
        : distances_(std::move(distances)), values_(std::move(values)) {
        const Rgb energy = enclosedEnergy(*this, distances_.back());
        for (Rgb& value : values_) value = value / energy;
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

  private:
    std::vector<double> distances_;
    std::vector<Rgb> values_;
};

class ScaledProfile : public Profile {
  public:
    ScaledProfile(ProfilePtr profile, double factor) : profile_(std::move(profile)), factor_(factor) {
        radius_ = profile_->radius() * factor;
    }
    Rgb radial(double d) const override { return profile_->radial(d / factor_) / (factor_ * factor_); }
    Rgb lineSpread(double s) const override { return profile_->lineSpread(s / factor_) / factor_; }
    std::vector<double> lengths() const override {
        auto all = profile_->lengths();
        for (double& l : all) l *= factor_;
        return all;
    }
    bool singularAtZero() const override { return profile_->singularAtZero(); }

  private:
    ProfilePtr profile_;
    double factor_;
};

// exp(-45) is 3e-20: what lies beyond so many decay lengths is below double precision.
constexpr double negligibleDecay = 45;

std::vector<double> geometric(double first, double last, double ratio) {
    std::vector<double> all;
    for (double l = first; l < last; l *= ratio) all.push_back(l);
    all.push_back(last);
    return all;
}

class BurleyProfile : public Profile {
  public:
    explicit BurleyProfile(Rgb decay) : decay_(decay) { radius_ = magnitude(rmsWidth(*this)); }
    Rgb radial(double d) const override {
        Rgb value;
        for (int c = 0; c < 3; ++c)
            value[c] = (std::exp(-d / decay_[c]) + std::exp(-d / (3 * decay_[c]))) / (8 * pi * decay_[c] * d);
        return value;
    }
    std::vector<double> lengths() const override {
        const double narrow = std::min({decay_.x, decay_.y, decay_.z});
        return geometric(0.1 * narrow, 3 * negligibleDecay * magnitude(decay_), 3);
    }
    bool singularAtZero() const override { return true; }

  private:
    Rgb decay_;  // d = l/s, the shorter of the two decay lengths
};

class DipoleProfile : public Profile {
  public:
    DipoleProfile(Rgb absorption, Rgb reducedScattering, double eta) {
        // Fit of the average diffuse Fresnel reflectance from inside, for eta > 1: Jensen et al. 2001,
        // section 2.
        const double fresnel = -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
        const double mismatch = (1 + fresnel) / (1 - fresnel);  // A of the boundary condition
        for (int c = 0; c < 3; ++c) {
            const double extinction = absorption[c] + reducedScattering[c], depth = 1 / extinction;
            Dipole& p = dipoles_[c];
            p.transport = std::sqrt(3 * absorption[c] * extinction);
            p.depths[0] = depth;
            p.depths[1] = depth + 4 * mismatch / (3 * extinction);
            p.energy = 0.5 * (std::exp(-p.transport * p.depths[0]) + std::exp(-p.transport * p.depths[1]));
        }
        radius_ = magnitude(rmsWidth(*this));
    }
    Rgb radial(double d) const override {
        Rgb value;
        for (int c = 0; c < 3; ++c)
            for (const Dipole& p = dipoles_[c]; double depth : p.depths) {
                const double s = std::hypot(depth, d);
                value[c] += depth * (1 + p.transport * s) * std::exp(-p.transport * s) /
                            (4 * pi * s * s * s) / p.energy;
            }
        return value;
    }
    std::vector<double> lengths() const override {
        double first = dipoles_[0].depths[0], last = 0;
        for (const Dipole& p : dipoles_) {
            first = std::min(first, p.depths[0]);
            last = std::max(last, p.depths[1] + negligibleDecay / p.transport);
        }
        return geometric(0.3 * first, last, 3);
    }

  private:
    struct Dipole {
        double depths[2];  // of the source below and of its mirror image above the surface
        double transport;  // effective transport coefficient sigma_tr, 1/length
        double energy;     // integral over the plane for reduced albedo 1
    } dipoles_[3];
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

double burleyScale(BurleyFit fit, double albedo) {
    switch (fit) {
        case BurleyFit::searchlight:
            return 1.85 - albedo + 7 * std::pow(std::abs(albedo - 0.8), 3);
        case BurleyFit::diffuseTransmission:
            return 1.9 - albedo + 3.5 * std::pow(albedo - 0.8, 2);
        case BurleyFit::diffuseMeanFreePath:
            return 3.5 + 100 * std::pow(albedo - 0.33, 4);
    }
    throw std::invalid_argument("unknown fit of s(A)");
}

namespace {

// Mean free path over Burley's length of the medium with s = sqrt(1 - albedo).
double pathOverLengthOf(double s) {
    return 0.6663 + 4.7276 * s - 4.9721 * s * s + 7.2062 * std::pow(s, 3) - 3.3091 * std::pow(s, 4);
}

// Where a monotonic function takes a value.
template <class F>
double inverse(double value, bool rises, const F& f) {
    double least = 0, most = 1;
    for (int i = 0; i < 60; ++i) {
        const double middle = (least + most) / 2;
        ((f(middle) < value) == rises ? least : most) = middle;
    }
    return least;
}

}  // namespace

double mediumPath(double burleyLength, double reflectance) {
    const double s =
        inverse(reflectance, false, [](double v) { return (1 - v) * (1 - 0.139 * v) / (1 + 1.17 * v); });
    return pathOverLengthOf(s) * burleyLength;
}

double curvatureGain(double x, double pathOverLength) {
    if (x == 0) return 1;
    const double s = inverse(pathOverLength, true, pathOverLengthOf);
    double saturation = 0.072 * std::pow(s, -1.6);
    if (x < 0) saturation = std::max(saturation, 3.0);
    return std::max(0.0, 1 + (1.3 + 0.6 * s) * x / (1 + saturation * std::abs(x)));
}

ProfilePtr burleyProfile(Rgb meanFreePath, Rgb albedo, BurleyFit fit) {
    Rgb decay;
    for (int c = 0; c < 3; ++c) decay[c] = meanFreePath[c] / burleyScale(fit, albedo[c]);
    return std::make_shared<BurleyProfile>(decay);
}

ProfilePtr dipoleProfile(Rgb absorption, Rgb reducedScattering, double eta) {
    return std::make_shared<DipoleProfile>(absorption, reducedScattering, eta);
}

ProfilePtr tableProfile(std::vector<double> distances, std::vector<Rgb> values) {
    return std::make_shared<TableProfile>(std::move(distances), std::move(values));
}

ProfilePtr profileForRadius(ProfilePtr profile, double diffusionRadius) {
    const double factor = diffusionRadius / profile->radius();
    return std::make_shared<ScaledProfile>(std::move(profile), factor);
}

namespace {

Rgb diskIntegral(const Profile& profile, double discRadius, int power) {
    const auto borders = panelPoints(0, discRadius, profile.lengths());
    Rgb result;
    for (int c = 0; c < 3; ++c)
        result[c] = integrate<double>(
            [&](double d) { return 2 * pi * std::pow(d, power) * profile.radial(d)[c]; }, borders, 0, 1e-12);
    return result;
}

}  // namespace

Rgb rmsWidth(const Profile& profile) {
    Rgb width = diskIntegral(profile, profile.lengths().back(), 3);
    for (int c = 0; c < 3; ++c) width[c] = std::sqrt(0.5 * width[c]);
    return width;
}

Rgb enclosedEnergy(const Profile& profile, double discRadius) {
    return diskIntegral(profile, discRadius, 1);
}

}  // namespace reference
