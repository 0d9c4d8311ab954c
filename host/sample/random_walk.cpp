#include "sample/random_walk.h"

#include <omp.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>

namespace pellucid::sample {
namespace {

// Russian roulette: half of the walks end each time their weight falls below `faint`. Smaller values make
// walks longer, larger ones make results noisier. Variance times steps is smallest between 0.5 and 0.7.
constexpr double faint = 0.5;
// Per walk; bounds the reflections inside of a Fresnel boundary.
constexpr uint32_t maxEvents = 200'000;
constexpr double startDepth = 4e-7;  // of the scene's extent: what single precision needs
constexpr uint32_t pilotSamples = 16, pilotPoints = 2000;

uint64_t mixed(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

// SplitMix64 [Steele, Lea & Flood 2014].
class Random {
  public:
    explicit Random(uint64_t seed) : state_(mixed(seed)) {}
    double next() {  // in (0, 1)
        return (double(mixed(state_ += 0x9e3779b97f4a7c15) >> 11) + 0.5) * 0x1p-53;
    }
    Vec3 direction() {
        const double z = 2 * next() - 1, phi = 2 * pi * next(), r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

  private:
    uint64_t state_;
};

// Point i of the four-dimensional R sequence [Roberts 2018], shifted: evenly spread starts and wavelengths.
std::array<double, 4> spread(uint32_t i, const std::array<double, 4>& shift) {
    constexpr double root = 1.1673039782614187;  // of x^5 = x + 1
    std::array<double, 4> p;
    double step = 1;
    for (int k = 0; k < 4; ++k) {
        step /= root;
        p[k] = shift[k] + step * (i + 1);
        p[k] -= std::floor(p[k]);
    }
    return p;
}

// Unpolarised light that a smooth boundary reflects; `ratio`: far side's index over that of the near side.
double fresnel(double cosine, double ratio) {
    const double sine2 = (1 - cosine * cosine) / (ratio * ratio);
    if (sine2 >= 1) return 1;
    const double beyond = std::sqrt(1 - sine2), s = (cosine - ratio * beyond) / (cosine + ratio * beyond),
                 p = (ratio * cosine - beyond) / (ratio * cosine + beyond);
    return (s * s + p * p) / 2;
}

// Stops the threads when `progress` throws, which only the calling thread runs.
class Progress {
  public:
    Progress(const std::function<void(double)>& report, size_t total) : report_(report), total_(total) {}
    bool stopped() {
        if (stop_) return true;
        if (!report_ || omp_get_thread_num() != 0) return false;
        const auto now = std::chrono::steady_clock::now();
        if (now - last_ < std::chrono::milliseconds(100)) return false;
        last_ = now;
        try {
            report_(double(done_) / double(total_));
        } catch (...) {
            error_ = std::current_exception();
            stop_ = true;
        }
        return stop_;
    }
    void finishOne() { ++done_; }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    const std::function<void(double)>& report_;
    size_t total_;
    std::atomic<size_t> done_{0};
    std::atomic<bool> stop_{false};
    std::chrono::steady_clock::time_point last_{};
    std::exception_ptr error_;
};

struct Start {
    Vec3 position, normal, across, along;  // normal: of the triangle, outwards
};

class Walker {
  public:
    Walker(const WalkBody& body, const Lighting& lighting, const LayeredMedium& medium)
        : body_(body), lighting_(lighting), medium_(medium) {
        for (size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (const Wave& wave : medium.waves) shares_[c].push_back(sum += std::abs(wave.weight[c]));
        }
        const Bounds& b = body.body().bounds();
        low_ = b.low, high_ = b.high;
        const Vec3 size = b.high - b.low;
        depth_ = startDepth * std::max({size.x, size.y, size.z});
    }

    Start startAt(const SurfacePoint& point) const {
        // A little inside of the triangle: moving inwards from a corner may leave a sharp body.
        SurfacePoint inner = point;
        for (double& weight : inner.weights) weight += 1e-3 * (1 / 3. - weight);
        const Surface surface = surfaceAt(body_.lit().mesh(), inner);
        Start s;
        s.normal = surface.normal;
        s.position = surface.position - s.normal * depth_;
        s.across = perpendicular(s.normal, {0.3, 0.5, 0.8});
        s.along = cross(s.normal, s.across);
        return s;
    }

    // The mean of `samples` walks in one channel.
    double mean(const Start& start, int channel, uint32_t samples, uint64_t seed, Progress& progress,
                uint64_t& lost) const {
        Random random(seed);
        const std::array<double, 4> shift{random.next(), random.next(), random.next(), random.next()};
        const std::vector<double>& shares = shares_[size_t(channel)];
        double sum = 0;
        for (uint32_t i = 0; i < samples && !progress.stopped(); ++i) {
            SurfacePoint exit;
            const std::array<double, 4> first = spread(i, shift);
            const auto at = std::upper_bound(shares.begin(), shares.end() - 1, first[3] * shares.back());
            const Wave& wave = medium_.waves[size_t(at - shares.begin())];
            const double weight = walk(start, wave, first, random, exit, lost);
            if (weight > 0)
                sum += std::copysign(weight, wave.weight[channel]) *
                       irradianceAt(body_.lit(), lighting_, exit)[channel];
        }
        return sum * shares.back() / samples;
    }

  private:
    // Returns the weight with which the walk leaves at `exit`; 0 if it does not leave.
    double walk(const Start& start, const Wave& wave, const std::array<double, 4>& first, Random& random,
                SurfacePoint& exit, uint64_t& lost) const {
        // Delta tracking [Woodcock 1965]: paths of the more absorbing layer; some events change nothing.
        const double most = std::max(wave.outerAbsorption, wave.absorption),
                     path = 1 / (wave.scattering + most), index = medium_.refractiveIndex;
        double cosine = std::sqrt(first[0]), weight = 1;
        if (index != 1) {
            weight -= fresnel(cosine, index);
            cosine = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (index * index)));
        }
        const double sine = std::sqrt(1 - cosine * cosine), phi = 2 * pi * first[1];
        Vec3 p = start.position, d = start.across * (sine * std::cos(phi)) +
                                     start.along * (sine * std::sin(phi)) - start.normal * cosine;
        double step = -path * std::log(std::max(first[2], 1e-300));
        for (uint32_t event = 0; event < maxEvents; ++event) {
            Vec3 normal;
            const Hit hit = body_.body().firstHit({p, d}, step, normal);
            if (hit.triangle != Hit::none) {
                const double facing = std::abs(dot(normal, d));
                if (index == 1 || random.next() >= fresnel(facing, 1 / index)) {
                    exit = {body_.litTriangle(hit.triangle), hit.weights};
                    return weight;
                }
                const Vec3 inwards = dot(normal, d) > 0 ? -normal : normal;
                p = p + d * hit.distance + inwards * depth_;
                d = d + inwards * (2 * facing);
            } else {
                p = p + d * step;
                // Also true of NaN.
                if (!(p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y && p.z >= low_.z &&
                      p.z <= high_.z))
                    break;
                const double absorption =
                    wave.outerAbsorption != wave.absorption &&
                            body_.body().nearest(p, medium_.thickness).triangle != Hit::none
                        ? wave.outerAbsorption
                        : wave.absorption;
                weight *= 1 - path * absorption;
                if (weight < faint) {
                    if (weight == 0 || random.next() < 0.5) return 0;
                    weight *= 2;
                }
                if (absorption == most ||
                    random.next() * (wave.scattering + most - absorption) < wave.scattering)
                    d = random.direction();
            }
            step = -path * std::log(random.next());
        }
        ++lost;
        return 0;
    }

    const WalkBody& body_;
    const Lighting& lighting_;
    const LayeredMedium& medium_;
    std::array<std::vector<double>, 3>
        shares_;  // per channel: sums of the weights of wavelengths, without sign
    Vec3 low_, high_;
    double depth_ = 0;
};

WalkedLight walkPoints(const Walker& walker, std::span<const SurfacePoint> points, uint32_t samples,
                       uint64_t seed, const std::function<void(double)>& report) {
    WalkedLight result;
    result.samples = samples;
    result.first.resize(3 * points.size());
    result.second.resize(3 * points.size());
    Progress progress(report, points.size());
    uint64_t lost = 0;
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : lost)
    for (int64_t i = 0; i < int64_t(points.size()); ++i) {
        if (progress.stopped()) continue;
        const Start start = walker.startAt(points[i]);
        for (uint32_t k = 0; k < 6; ++k) {
            const uint64_t stream = mixed(seed * 0x9e3779b97f4a7c15 + 6 * uint64_t(i) + k + 1);
            (k < 3 ? result.first : result.second)[3 * i + k % 3] =
                float(walker.mean(start, int(k % 3), samples, stream, progress, lost));
        }
        progress.finishOne();
    }
    progress.rethrow();
    result.lost = lost;
    double square = 0;
    for (size_t i = 0; i < result.first.size(); ++i)
        square += std::pow((double(result.first[i]) - result.second[i]) / 2, 2);
    if (!points.empty()) result.noise = std::sqrt(square / double(result.first.size()));
    return result;
}

void check(const WalkBody& body, std::span<const SurfacePoint> points, const LayeredMedium& medium,
           const WalkOptions& options) {
    if (medium.waves.empty()) throw std::invalid_argument("walkLight: the medium has no wavelength");
    if (!(medium.thickness >= 0 && std::isfinite(medium.thickness)))
        throw std::invalid_argument(
            "walkLight: the thickness of the outer layer must be 0 or more, and finite");
    for (const Wave& w : medium.waves) {
        for (const double value : {w.scattering, w.outerAbsorption, w.absorption})
            if (!(value >= 0 && std::isfinite(value)))
                throw std::invalid_argument(
                    "walkLight: scattering and absorption must be 0 or more, and finite");
        if (w.scattering + std::max(w.outerAbsorption, w.absorption) == 0)
            throw std::invalid_argument("walkLight: a medium must scatter or absorb");
    }
    if (!(medium.refractiveIndex >= 1 && medium.refractiveIndex <= 3))
        throw std::invalid_argument("walkLight: the refractive index must be between 1 and 3");
    if (options.samples < 1 || options.samples > maxWalkSamples)
        throw std::invalid_argument("walkLight: between 1 and " + std::to_string(maxWalkSamples) +
                                    " samples are possible");
    if (!(options.noise >= 0 && std::isfinite(options.noise)))
        throw std::invalid_argument("walkLight: the noise must be 0 or more, and finite");
    const size_t triangles = body.lit().mesh().triangles.size() / 3;
    for (const SurfacePoint& p : points)
        if (p.triangle >= triangles || !body.encloses(p.triangle))
            throw std::invalid_argument("walkLight: a point is not on the surface of the medium");
}

// With s = sqrt(1 - albedo): reflectance = F (1 - s)(1 - c s) / (1 + b s), and mean free path over Burley's
// length is a polynomial of s.
struct Fit {
    double F, c, b;
    std::array<double, 5> polynomial;
};
// F, c and b of the first: van de Hulst, Multiple Light Scattering, 1980, for isotropic scattering. All
// others are least squares over walks of half-spaces with 12 and 11 albedos from 0.3 to 0.9995.
constexpr Fit indexMatchedFit{1, 0.139, 1.17, {0.6663, 4.7276, -4.9721, 7.2062, -3.3091}};
constexpr Fit fresnelFit{0.92964, 0.43956, 3.74894, {0.3441, 3.6519, -1.9133, 5.3307, 0}};

const Fit& fitOf(Boundary boundary) {
    return boundary == Boundary::Fresnel ? fresnelFit : indexMatchedFit;
}

}  // namespace

LayeredMedium::LayeredMedium(const Medium& medium) : refractiveIndex(medium.refractiveIndex) {
    for (size_t c = 0; c < 3; ++c) {
        const double extinction = 1 / medium.meanFreePath[c],
                     absorption = (1 - medium.albedo[c]) * extinction;
        waves.push_back({medium.albedo[c] * extinction, absorption, absorption});
        waves.back().weight[c] = 1;
    }
}

WalkBody::WalkBody(const Scene& scene, uint32_t material) : lit_(scene), material_(material) {
    const Mesh& mesh = scene.mesh();
    const auto count = uint32_t(mesh.triangles.size() / 3);
    for (uint32_t t = 0; t < count; ++t)
        if (encloses(t)) triangles_.push_back(t);
    if (triangles_.empty())
        throw std::invalid_argument("no triangle of the mesh has the id " + std::to_string(material));
    if (triangles_.size() == count) return;
    std::vector<uint32_t> indices;
    for (const uint32_t t : triangles_)
        indices.insert(indices.end(), &mesh.triangles[3 * size_t(t)], &mesh.triangles[3 * size_t(t)] + 3);
    own_ = std::make_unique<Scene>(MeshView{mesh.positions, {}, {}, {}, indices, {}});
}

bool WalkBody::encloses(uint32_t triangle) const {
    const std::vector<uint32_t>& materials = lit_.mesh().materials;
    return material_ == 0 || (materials.empty() ? 1 : materials[triangle]) == material_;
}

WalkedLight walkLight(const WalkBody& body, const Lighting& lighting, std::span<const SurfacePoint> points,
                      const LayeredMedium& medium, const WalkOptions& options) {
    check(body, points, medium, options);
    const Walker walker(body, lighting, medium);
    uint32_t samples = options.samples;
    if (options.noise > 0 && !points.empty()) {
        // The noise of a few points determines how many samples all points need.
        std::vector<SurfacePoint> some;
        const size_t stride = (points.size() + pilotPoints - 1) / pilotPoints;
        for (size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
        const WalkedLight pilot = walkPoints(walker, some, pilotSamples, options.seed + 1, [&](double) {
            if (options.progress) options.progress(0);
        });
        samples = uint32_t(std::clamp(std::ceil(pilotSamples * std::pow(pilot.noise / options.noise, 2)), 1.0,
                                      double(maxWalkSamples)));
    }
    return walkPoints(walker, points, samples, options.seed, options.progress);
}

double mostReflectance(Boundary boundary) {
    return 0.999 * fitOf(boundary).F;
}

Medium burleyMedium(const std::array<double, 3>& burleyLength, const std::array<double, 3>& reflectance,
                    Boundary boundary) {
    const Fit& fit = fitOf(boundary);
    Medium medium;
    medium.refractiveIndex = boundary == Boundary::Fresnel ? fresnelIndex : 1;
    for (int i = 0; i < 3; ++i) {
        const double A = std::clamp(reflectance[i], 0.001, mostReflectance(boundary)), p = fit.F * fit.c,
                     q = fit.F * (1 + fit.c) + A * fit.b;
        const double s = (q - std::sqrt(q * q - 4 * p * (fit.F - A))) / (2 * p);
        medium.albedo[i] = std::clamp(1 - s * s, 0.0, 1.0);
        double ratio = 0;
        for (int k = 4; k >= 0; --k) ratio = ratio * s + fit.polynomial[k];
        medium.meanFreePath[i] = ratio * burleyLength[i];
    }
    return medium;
}

}  // namespace pellucid::sample
