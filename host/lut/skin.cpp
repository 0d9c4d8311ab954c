#include "lut/skin.h"

#include <bit>

#include "core/check_range.h"
#include "core/struct_size.h"
#include "fields/color_difference.h"
#include "fields/skin_spectra.h"
#include "lut/skin_transport.h"
#include "shared/skin_maps.h"
#include "system/threads.h"

namespace pel {
namespace {

// ---- skinReflected as a polynomial

// Evenly spaced nodes of a variable in which the logarithm of the reflectance is smooth.
struct Axis {
    int nodes;
    double low, high;
    double node(int i) const { return low + (high - low) * i / (nodes - 1); }
    // Cubic interpolation at x: the first of four nodes, and their weights.
    int weights(double x, double (&w)[4]) const {
        const double at = (std::clamp(x, low, high) - low) / (high - low) * (nodes - 1);
        const int first = std::clamp(int(at) - 1, 0, nodes - 4);
        const double p = at - first, q = p - 1, r = p - 2, s = p - 3;
        w[0] = -q * r * s / 6;
        w[1] = p * r * s / 2;
        w[2] = -p * q * s / 2;
        w[3] = p * q * r / 6;
        return first;
    }
};

// The variables are log(1 + x / unit) of the thickness and of the absorption along it, and the logarithm of
// the lower layer's absorption.
constexpr double thicknessUnit = 0.05, opticalUnit = 0.2;

constexpr double lowestFrequency = 0.01, highestFrequency = 80;
constexpr int frequencies = 16;  // the first is 0, the others are evenly spaced in the logarithm
double frequency(int i) {
    return i == 0 ? 0
                  : lowestFrequency *
                        std::pow(highestFrequency / lowestFrequency, (i - 1.0) / (frequencies - 2));
}
using Spectrum = std::array<float, frequencies>;  // the logarithm of skinReflected at each frequency

class Table {
  public:
    static const Table& get() {
        static const Table table;
        return table;
    }
    Spectrum at(const SkinLayers& layers) const {
        double t[4], u[4], l[4];
        const int first = thickness_.weights(std::log1p(layers.thickness / thicknessUnit), t),
                  second =
                      upper_.weights(std::log1p(layers.thickness * layers.upperAbsorption / opticalUnit), u),
                  third = lower_.weights(std::log(layers.lowerAbsorption), l);
        Spectrum sum{};
        for (int i = 0; i < 64; ++i) {  // in one loop, since compilers vectorise nested ones across rows
            const int a = i / 16, b = i / 4 % 4, c = i % 4;
            const float weight = float(t[a] * u[b] * l[c]);
            const Spectrum& row =
                rows_[(size_t(first + a) * upper_.nodes + second + b) * lower_.nodes + third + c];
            for (int k = 0; k < frequencies; ++k) sum[k] += weight * row[k];
        }
        return sum;
    }

  private:
    Table() {
        rows_.resize(size_t(thickness_.nodes) * upper_.nodes * lower_.nodes);
        inParts(rows_.size(), partsOf(rows_.size(), 16), [&](size_t, size_t begin, size_t end) {
            for (size_t r = begin; r < end; ++r) {
                const int a = int(r) / (upper_.nodes * lower_.nodes),
                          b = int(r) / lower_.nodes % upper_.nodes, c = int(r) % lower_.nodes;
                const double thickness = thicknessUnit * std::expm1(thickness_.node(a));
                const SkinLayers layers{thickness, opticalUnit * std::expm1(upper_.node(b)) / thickness,
                                        std::exp(lower_.node(c))};
                for (int k = 0; k < frequencies; ++k)
                    rows_[r][k] = float(std::log(skinReflected(layers, frequency(k))));
            }
        });
    }
    // The limits cover the ranges of PelSkin at the wavelengths of the table of spectra.
    const Axis thickness_{8, std::log1p(0.016 / thicknessUnit), std::log1p(10 / thicknessUnit)},
        upper_{16, 0, std::log1p(45 / opticalUnit)}, lower_{9, std::log(0.0025), std::log(32)};
    std::vector<Spectrum> rows_;
};

// ---- From spectra to channels

// Widths of the Gaussians, mm, and frequencies of the fit, 1/mm.
constexpr int terms = 14, fitted = 28;
double variance(int i) {
    return std::pow(0.003 * std::pow(12 / 0.003, i / (terms - 1.0)), 2);
}
double fittedFrequency(int j) {
    return 0.02 * std::pow(150 / 0.02, j / (fitted - 1.0));
}
using FittedSpectrum = std::array<float, fitted>;

struct Computed {
    Rgb albedo{}, freePath{}, scattered{};     // the latter two: means over the light that leaves
    std::array<FittedSpectrum, 3> spectrum{};  // of the profile, at fittedFrequency
    std::array<double, skinWavelengths> reflectance{};
};

Computed compute(const PelSkin& skin, bool radial) {
    constexpr double perLog = (frequencies - 2) / 8.9871968206619729;  // log(highest / lowest)
    static const auto logFrequency = [] {
        std::array<double, fitted> logs;
        for (int j = 0; j < fitted; ++j) logs[j] = std::log(fittedFrequency(j));
        return logs;
    }();
    Computed out;
    Rgb total{};
    for (int i = 0; i < skinWavelengths; ++i) {
        const SkinCoefficients c = skinCoefficients(skin, skinSpectra[i]);
        const SkinLayers layers{skin.epidermis * c.scattering, c.epidermis / c.scattering,
                                c.dermis / c.scattering};
        const Spectrum values = Table::get().at(layers);
        const Rgb& weight = skinChannels()[i];
        out.reflectance[i] = std::exp(values[0]);
        for (int n = 0; n < 3; ++n) {
            out.albedo[n] += weight[n] * out.reflectance[i];
            const double share = std::max(0.0, weight[n]) * out.reflectance[i];
            total[n] += share;
            out.freePath[n] += share / (c.dermis + c.scattering);
            out.scattered[n] += share * c.scattering / (c.dermis + c.scattering);
        }
        if (!radial) continue;
        const double shift = std::log(c.scattering * lowestFrequency);
        std::array<float, frequencies + 1> nodes;  // without that of 0, and the first and the last twice
        std::copy(&values[1], values.end(), &nodes[1]);
        nodes.front() = values[1], nodes.back() = values.back();
        FittedSpectrum light;
        for (int j = 0; j < fitted; ++j) {
            // Cubic [Catmull-Rom] in the logarithm of the frequency; below the first node quadratic in the
            // frequency, beyond the last a power of it.
            const float at = float((logFrequency[j] - shift) * perLog);
            float value;
            if (at > 0) {
                const int cell = std::min(int(at), frequencies - 3);
                const float x = std::min(at - float(cell), 1.0f), beyond = at - float(cell) - x;
                const float *node = &nodes[cell], p = node[0], q = node[1], r = node[2], s = node[3];
                value = q + x / 2 * (r - p + x * (2 * p - 5 * q + 4 * r - s + x * (3 * (q - r) + s - p))) +
                        beyond * (r - q);
            } else {
                value = values[0] + (values[1] - values[0]) * std::exp(2 * at / float(perLog));
            }
            light[j] = std::exp(value);
        }
        for (int n = 0; n < 3; ++n) {
            const float share = float(std::max(0.0, weight[n]));
            for (int j = 0; j < fitted; ++j) out.spectrum[n][j] += share * light[j];
        }
    }
    for (int n = 0; n < 3; ++n) {
        out.freePath[n] /= total[n];
        out.scattered[n] /= total[n];
        // Values outside the gamut of sRGB are clamped.
        out.albedo[n] = std::clamp(out.albedo[n], 1e-4, 1.0);
        for (float& value : out.spectrum[n]) value /= float(total[n]);
    }
    return out;
}

struct Fit {
    std::vector<GaussianTerm> gaussians;
    Rgb error{}, meanDistance{};
};

// exp(-k^2 v / 2) of each Gaussian at each frequency, and the products of two Gaussians over all.
struct Basis {
    std::array<double, terms> variances, distances;  // mm^2; the mean distance of each, mm
    std::array<std::array<double, fitted>, terms> at;
    std::array<std::array<double, terms>, terms> products{};
    Basis() {
        for (int i = 0; i < terms; ++i) {
            variances[i] = variance(i);
            distances[i] = std::sqrt(pi * variance(i) / 2);
            for (int j = 0; j < fitted; ++j)
                at[i][j] = std::exp(-std::pow(fittedFrequency(j), 2) * variance(i) / 2);
        }
        for (int i = 0; i < terms; ++i)
            for (int n = 0; n < terms; ++n)
                for (int j = 0; j < fitted; ++j) products[i][n] += at[i][j] * at[n][j];
    }
};

// The weights of 0 or more with the smallest squared error over the frequencies [LH74].
// The weights above 0 solve their normal equations; further ones join as long as the error falls.
std::array<double, terms> weightsOf(const Basis& basis, const std::array<double, terms>& wanted) {
    std::array<double, terms> weights{};
    std::array<int, terms> in{};  // the first `count`: those that are not 0
    const auto isIn = [&](int count, int i) { return std::find(&in[0], &in[count], i) != &in[count]; };
    for (int count = 0, round = 0; round < 3 * terms; ++round) {
        int best = -1;
        double steepest = 1e-9;
        for (int i = 0; i < terms; ++i) {
            double slope = wanted[i];
            for (int k = 0; k < count; ++k) slope -= basis.products[i][in[k]] * weights[in[k]];
            if (slope > steepest && !isIn(count, i)) best = i, steepest = slope;
        }
        if (best < 0) break;
        in[count++] = best;
        for (bool negative = true; negative && count > 0;) {
            // Cholesky's factors, and the solution.
            double l[terms][terms], x[terms];
            for (int a = 0; a < count; ++a) {
                for (int b = 0; b <= a; ++b) {
                    double sum = basis.products[in[a]][in[b]];
                    for (int k = 0; k < b; ++k) sum -= l[a][k] * l[b][k];
                    l[a][b] = a == b ? std::sqrt(std::max(sum, 1e-15)) : sum / l[b][b];
                }
                x[a] = wanted[in[a]];
                for (int k = 0; k < a; ++k) x[a] -= l[a][k] * x[k];
                x[a] /= l[a][a];
            }
            for (int a = count - 1; a >= 0; --a) {
                for (int k = a + 1; k < count; ++k) x[a] -= l[k][a] * x[k];
                x[a] /= l[a][a];
            }
            // Goes as far towards the solution as all weights remain 0 or more.
            double step = 1;
            for (int a = 0; a < count; ++a)
                if (x[a] <= 0) step = std::min(step, weights[in[a]] / (weights[in[a]] - x[a]));
            negative = step < 1;
            int kept = 0;
            for (int a = 0; a < count; ++a) {
                double& w = weights[in[a]];
                w += step * (x[a] - w);
                if (w > 1e-12)
                    in[kept++] = in[a];
                else
                    w = 0;
            }
            count = kept;
        }
    }
    return weights;
}

Fit fit(const Computed& computed) {
    static const Basis basis;
    Fit out;
    for (int i = 0; i < terms; ++i) out.gaussians.push_back({basis.variances[i], {}});
    for (int c = 0; c < 3; ++c) {
        std::array<double, terms> wanted{};
        for (int i = 0; i < terms; ++i)
            for (int j = 0; j < fitted; ++j) wanted[i] += basis.at[i][j] * computed.spectrum[c][j];
        const std::array<double, terms> weights = weightsOf(basis, wanted);
        double sum = 0;
        for (double w : weights) sum += w;
        for (int i = 0; i < terms; ++i) {
            const double w = weights[i] / sum;
            out.gaussians[i].weight[c] = w;
            out.meanDistance[c] += w * basis.distances[i];
        }
        for (int j = 0; j < fitted; ++j) {
            double value = 0;
            for (int i = 0; i < terms; ++i) value += out.gaussians[i].weight[c] * basis.at[i][j];
            out.error[c] = std::max(out.error[c], std::abs(value - computed.spectrum[c][j]));
        }
    }
    std::erase_if(out.gaussians, [](const GaussianTerm& term) { return term.weight == Rgb{}; });
    return out;
}

// ---- Maps

double logDistanceOf(const Fit& fit) {  // the mean over the channels
    const Rgb& d = fit.meanDistance;
    return (std::log(d[0]) + std::log(d[1]) + std::log(d[2])) / 3;
}

// Tables over the square roots of melanin and blood, over their ranges, for one set of other fields.
struct Maps {
    static constexpr size_t side = PEL_SKIN_SIDE, every = 4;  // between nodes for which lengths are computed
    PelSkin skin;
    std::vector<std::array<double, 4>> nodes;  // roots of the albedo, the logarithm of the mean distance
    std::vector<Rgb> lab;

    static PelSkin at(PelSkin skin, double x, double y) {
        skin.melanin = float(range::skin::melanin.max * x * x);
        skin.blood = float(range::skin::blood.max * y * y);
        return skin;
    }
    explicit Maps(const PelSkin& from) : skin(from), nodes(side * side), lab(side * side) {
        inParts(nodes.size(), partsOf(nodes.size(), 64), [&](size_t, size_t i, size_t end) {
            for (const double last = side - 1; i < end; ++i) {
                const size_t x = i % side, y = i / side;
                const bool radial = x % every == 0 && y % every == 0;
                const Computed here = compute(at(skin, double(x) / last, double(y) / last), radial);
                lab[i] = labFromLinear(here.albedo);
                for (int c = 0; c < 3; ++c) nodes[i][c] = std::sqrt(here.albedo[c]);
                if (radial) nodes[i][3] = logDistanceOf(fit(here));
            }
        });
        for (size_t i = 0; i < nodes.size(); ++i) {
            const size_t x = i % side, y = i / side, left = std::min(x, side - 2) / every * every,
                         up = std::min(y, side - 2) / every * every;
            const double s = double(x - left) / every, t = double(y - up) / every;
            const auto* a = &nodes[up * side + left];
            const auto* b = a + every * side;
            nodes[i][3] =
                (1 - t) * ((1 - s) * a[0][3] + s * a[every][3]) + t * ((1 - s) * b[0][3] + s * b[every][3]);
        }
    }
    // The maps of the last skin are kept: callers convert one picture in many pieces.
    static std::shared_ptr<const Maps> of(PelSkin skin) {
        static std::mutex mutex;
        static std::shared_ptr<const Maps> last;
        skin.melanin = skin.blood = 0;
        const std::lock_guard lock(mutex);
        if (!last || std::memcmp(&last->skin, &skin, sizeof skin) != 0) last = std::make_shared<Maps>(skin);
        return last;
    }
};

// Interpolates linearly at (u, v), from 0 to 1.
template <size_t n>
std::array<double, n> between(const std::vector<std::array<double, n>>& table, double u, double v) {
    constexpr size_t side = Maps::side;
    const double a = u * (side - 1), b = v * (side - 1);
    const size_t i = std::min(size_t(a), side - 2), j = std::min(size_t(b), side - 2);
    const double x = a - double(i), y = b - double(j);
    const auto* low = &table[j * side + i];
    const auto* high = low + side;
    std::array<double, n> mixed;
    for (size_t c = 0; c < n; ++c)
        mixed[c] =
            (1 - y) * ((1 - x) * low[0][c] + x * low[1][c]) + y * ((1 - x) * high[0][c] + x * high[1][c]);
    return mixed;
}

double inside(double x) {
    return std::clamp(x, 0.0, 1.0);
}

double squaredDistance(const Lab& a, const Lab& b) {
    return std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2);
}

// A place in the maps, and how far its colour is from the wanted one.
struct Match {
    double u = 0, v = 0, difference = INFINITY;
};

// The nearest of every second node of some rows, by the squared distance in L*a*b*.
Match nearestNode(const std::vector<Lab>& table, const Lab& lab, int firstRow, int lastRow) {
    constexpr int last = Maps::side - 1, every = 2;
    Match match;
    for (int y = firstRow; y <= lastRow; y += every)
        for (int x = 0; x <= last; x += every)
            if (const double e = squaredDistance(table[size_t(y) * Maps::side + x], lab);
                e < match.difference)
                match = {double(x) / last, double(y) / last, e};
    return match;
}

// Damped Gauss-Newton steps in L*a*b*, which follow narrow valleys of colours that are nearly alike.
void followValley(const std::vector<Lab>& table, const Lab& lab, Match& match) {
    constexpr double slopeStep = 0.25 / (Maps::side - 1);
    double damping = 1;
    for (int k = 0; k < 24; ++k) {
        const auto [u, v, least] = match;
        const double u0 = inside(u - slopeStep), u1 = inside(u + slopeStep), v0 = inside(v - slopeStep),
                     v1 = inside(v + slopeStep);
        const Lab at = between(table, u, v), left = between(table, u0, v), right = between(table, u1, v),
                  low = between(table, u, v0), high = between(table, u, v1);
        double uu = damping, uv = 0, vv = damping, toU = 0, toV = 0;
        for (int c = 0; c < 3; ++c) {
            const double byU = (right[c] - left[c]) / (u1 - u0), byV = (high[c] - low[c]) / (v1 - v0),
                         off = lab[c] - at[c];
            uu += byU * byU, uv += byU * byV, vv += byV * byV, toU += byU * off, toV += byV * off;
        }
        const double area = uu * vv - uv * uv, x = inside(u + (vv * toU - uv * toV) / area),
                     y = inside(v + (uu * toV - uv * toU) / area),
                     e = squaredDistance(between(table, x, y), lab);
        // Less damping would leave nothing of `area` where both slopes have one direction.
        if (e < least)
            match = {x, y, e}, damping = std::max(damping / 10, 1e-6);
        else
            damping *= 10;
    }
}

// Ever smaller steps in eight directions, by CIEDE2000.
void refine(const std::vector<Lab>& table, const Lab& lab, Match& match) {
    match.difference = INFINITY;
    for (double step = 1.0 / (Maps::side - 1); step > 1e-4; step /= 2)
        for (bool moved = true; moved;) {
            moved = false;
            const Match from = match;
            for (int d = 0; d < 9; ++d) {
                const double x = inside(from.u + (d % 3 - 1) * step), y = inside(from.v + (d / 3 - 1) * step),
                             e = deltaE2000(lab, between(table, x, y));
                if (e < match.difference) match = {x, y, e}, moved = true;
            }
        }
}

}  // namespace

PelSkin readSkin(const PelSkin* skin) {
    constexpr const char* structure = "PelSkin";
    const PelSkin fields = readStructOr(skin, pelSkinDefaults());
    PEL_EACH_SKIN_FIELD(PEL_CHECK_RANGE)
    return fields;
}

PelSkinInfo skinInfo(const PelSkin& skin) {
    PelSkinInfo info = pelSkinInfoDefaults();
    const Computed computed = compute(skin, true);
    const Fit gaussians = fit(computed);
    const Lab lab = labFromLinear(computed.albedo);
    for (int c = 0; c < 3; ++c) {
        info.albedo[c] = float(computed.albedo[c]);
        info.meanFreePath[c] = float(computed.freePath[c]);
        info.singleScatteringAlbedo[c] = float(computed.scattered[c]);
        info.meanDistance[c] = float(gaussians.meanDistance[c]);
        info.profileError[c] = float(gaussians.error[c]);
        info.lab[c] = float(lab[c]);
    }
    info.typologyAngle = float(std::atan2(lab[0] - 50, lab[2]) * 180 / pi);
    return info;
}

void skinReflectance(const PelSkin& skin, std::span<const float> nanometres, float* reflectance) {
    const auto values = compute(skin, false).reflectance;
    const float first = skinSpectra[0].nanometres, step = skinSpectra[1].nanometres - first;
    const auto place = [&](size_t i) { return double((nanometres[i] - first) / step); };
    for (size_t i = 0; i < nanometres.size(); ++i)
        if (!(place(i) >= 0 && place(i) <= skinWavelengths - 1))
            invalidArgument("wavelength ", i, " is ", nanometres[i], " nm; it must be from ", first, " to ",
                            skinSpectra[skinWavelengths - 1].nanometres);
    for (size_t i = 0; i < nanometres.size(); ++i) {
        const double at = place(i);
        const int cell = std::min(int(at), skinWavelengths - 2);
        reflectance[i] = float(values[cell] + (values[cell + 1] - values[cell]) * (at - cell));
    }
}

Ref<Profile> skinLayersProfile(const PelSkin& skin) {
    auto profile = make<Profile>(PEL_PROFILE_SKIN_LAYERS,
                                 std::make_unique<GaussianShape>(fit(compute(skin, true)).gaussians));
    profile->setPigments(skin);
    return profile;
}

void skinAlbedo(const PelSkin& skin, const float* melanin, const float* blood, size_t count, float* albedo,
                float* radius) {
    const auto maps = Maps::of(skin);
    const double own = radius ? logDistanceOf(fit(compute(skin, true))) : 0;
    const auto root = [](float value, float instead, const FieldRange& range) {
        return std::sqrt(std::clamp(std::isnan(value) ? instead : value, range.min, range.max) / range.max);
    };
    for (size_t i = 0; i < count; ++i) {
        const double u = root(melanin[i], skin.melanin, range::skin::melanin),
                     v = root(blood[i], skin.blood, range::skin::blood);
        const auto node = between(maps->nodes, u, v);
        for (int c = 0; albedo && c < 3; ++c) albedo[3 * i + c] = float(node[c] * node[c]);
        if (radius) radius[i] = float(std::exp(node[3] - own));
    }
}

std::vector<float> skinTable(const PelSkin& skin, int oxygenations) {
    const double own = logDistanceOf(fit(compute(skin, true)));
    std::vector<float> table;
    for (int o = 0; o < oxygenations; ++o) {
        PelSkin at = skin;
        if (oxygenations > 1) at.oxygenation = float(o) / float(oxygenations - 1);
        const Maps maps(at);
        for (const auto& node : maps.nodes)
            table.insert(table.end(),
                         {float(node[0]), float(node[1]), float(node[2]), float(std::exp(node[3] - own))});
    }
    return table;
}

void skinFromAlbedo(const PelSkin& skin, const float* albedo, size_t count, float* melanin, float* blood,
                    float* difference) {
    const auto maps = Maps::of(skin);
    const auto find = [&](size_t i) {
        Rgb wanted;
        for (int c = 0; c < 3; ++c) wanted[c] = std::clamp(albedo[3 * i + c], 0.0f, 1.0f);
        for (double& value : wanted) value = std::isnan(value) ? 0 : value;
        const Lab lab = labFromLinear(wanted);
        // Skin of little oxygen has a valley of colours that are nearly alike along no blood, and another
        // beside it, so that the nearest node may belong to the wrong one.
        constexpr int last = Maps::side - 1;
        Match best;
        for (const auto& [firstRow, lastRow] : {std::pair{0, last}, {0, 0}, {1, last}, {3, last}}) {
            Match match = nearestNode(maps->lab, lab, firstRow, lastRow);
            followValley(maps->lab, lab, match);
            match.difference = deltaE2000(lab, between(maps->lab, match.u, match.v));
            if (match.difference < best.difference) best = match;
            if (best.difference < 0.005) break;
        }
        refine(maps->lab, lab, best);
        const PelSkin found = Maps::at(skin, best.u, best.v);
        melanin[i] = found.melanin;
        blood[i] = found.blood;
        if (difference) difference[i] = float(best.difference);
    };
    inParts(count, partsOf(count, 1024), [&](size_t, size_t i, size_t end) {
        // Pictures of 8 bits repeat their colours: the last pixel of each hash.
        std::vector<size_t> found(4096, count);
        for (; i < end; ++i) {
            const float* rgb = albedo + 3 * i;
            size_t& same = found[(std::bit_cast<uint32_t>(rgb[0]) * 0x9e3779b1u +
                                  std::bit_cast<uint32_t>(rgb[1]) * 0x85ebca6bu +
                                  std::bit_cast<uint32_t>(rgb[2]) * 0xc2b2ae35u) >>
                                 20];
            if (same == count || std::memcmp(albedo + 3 * same, rgb, 3 * sizeof(float)) != 0) {
                find(i);
            } else {
                melanin[i] = melanin[same], blood[i] = blood[same];
                if (difference) difference[i] = difference[same];
            }
            same = i;
        }
    });
}

}  // namespace pel
