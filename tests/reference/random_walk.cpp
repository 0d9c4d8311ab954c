#include "reference/random_walk.h"

#include "reference/vec.h"

namespace reference {
namespace {

// SplitMix64 [Steele, Lea & Flood 2014]: the same numbers on every machine.
class Random {
  public:
    explicit Random(uint64_t seed) : state_(seed) {}
    double next() {  // in (0, 1)
        uint64_t z = state_ += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return (double((z ^ (z >> 31)) >> 11) + 0.5) * 0x1p-53;
    }
    Vec3 direction() {
        const double z = 2 * next() - 1, phi = 2 * pi * next(), r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    // By the cosine to `normal`: a point of the unit sphere round its tip.
    Vec3 diffuse(Vec3 normal) {
        const Vec3 sum = normal + direction();
        const double l = length(sum);
        return l > 1e-12 ? sum / l : normal;
    }

  private:
    uint64_t state_;
};

constexpr double faint = 1e-3, survives = 0.1;  // Russian roulette: weights below `faint`, one of ten

// Walks until it is out: the weight left, at `p`. `exit(p, d)`: distance to the border along d.
template <class Exit>
double walk(const Medium& medium, Vec3& p, Vec3 d, Random& random, const Exit& exit) {
    double weight = 1;
    for (;;) {
        const double step = -medium.meanFreePath * std::log(random.next()), border = exit(p, d);
        if (step >= border) {
            p = p + border * d;
            return weight;
        }
        p = p + step * d;
        weight *= medium.albedo;
        if (weight < faint) {
            if (random.next() >= survives) return 0;
            weight /= survives;
        }
        d = random.direction();
    }
}

// one(place) walks a photon: its weight, and where in equally wide bins over [0, 1) it counts.
// perWeight(bin): radiance by the mean of weights.
template <class One, class PerWeight>
WalkResult walkMany(int bins, uint64_t photons, const One& one, const PerWeight& perWeight) {
    std::vector<double> sum(static_cast<size_t>(bins)), square(sum);
    WalkResult result;
    for (uint64_t i = 0; i < photons; ++i) {
        double place = -1;
        const double weight = one(place);
        result.reflected += weight / double(photons);
        if (!(place >= 0 && place < 1)) continue;
        sum[size_t(place * bins)] += weight;
        square[size_t(place * bins)] += weight * weight;
    }
    for (int i = 0; i < bins; ++i) {
        const double scale = perWeight(i) / double(photons);
        result.radiance.push_back(scale * sum[i]);
        result.error.push_back(scale * std::sqrt(square[i]));
    }
    return result;
}

}  // namespace

WalkResult walkBall(const Medium& medium, double radius, int bins, uint64_t photons, uint64_t seed) {
    Random random(seed);
    const auto exit = [&](Vec3 p, Vec3 d) {
        const double b = dot(p, d), c = dot(p, p) - radius * radius;
        return std::max(0.0, -b + std::sqrt(std::max(0.0, b * b - c)));
    };
    const auto one = [&](double& place) {
        // Evenly over the disk that the light sees, from +z.
        const double r = radius * std::sqrt(random.next()), phi = 2 * pi * random.next();
        Vec3 p{r * std::cos(phi), r * std::sin(phi), std::sqrt(radius * radius - r * r)};
        const double weight = walk(medium, p, random.diffuse(-1 * (p / radius)), random, exit);
        place = (p.z / radius + 1) / 2;
        return weight;
    };
    // Flux pi r^2 of irradiance 1 over the bin's share of the sphere. Diffuse: exitance / pi is radiance, and
    // a white Lambertian surface has irradiance / pi; in units of that.
    return walkMany(bins, photons, one, [&](int) { return bins / 4.0; });
}

WalkResult walkSlab(const Medium& medium, double thickness, double reach, int bins, uint64_t photons,
                    uint64_t seed) {
    Random random(seed);
    const auto exit = [&](Vec3 p, Vec3 d) {
        if (d.z > 0) return std::max(0.0, -p.z / d.z);
        return d.z < 0 ? std::max(0.0, (-thickness - p.z) / d.z) : INFINITY;
    };
    double through = 0, straight = 0;
    const auto one = [&](double& place) {
        Vec3 p{};
        const double weight = walk(medium, p, random.diffuse({0, 0, -1}), random, exit);
        if (p.z < -0.5 * thickness) {
            through += weight;
            if (std::hypot(p.x, p.y) < thickness) straight += weight;
            return 0.0;
        }
        place = std::hypot(p.x, p.y) / reach;
        return weight;
    };
    WalkResult result = walkMany(bins, photons, one, [&](int i) {
        return 1 / (pi * reach * reach * (2 * i + 1) / double(bins) / bins);
    });
    result.transmitted = through / double(photons);
    result.straight = straight / double(photons);
    return result;
}

}  // namespace reference
