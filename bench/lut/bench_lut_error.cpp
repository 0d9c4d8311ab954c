// What matters to a picture: the error after the bilinear look-up anywhere between texels, for table sizes,
// axes and encodings. The times of these cases mean nothing; their counters do:
//   max, rms   of D over 4000 points of (N.L, 1/r), against the oracle
//   dE2000     largest colour difference of lit skin of albedo 0.8, 0.55, 0.45 under white light
//   KiB        of the table in that encoding with four channels
#include <benchmark/benchmark.h>

#include <pellucid/pellucid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "half_bits.h"
#include "io/image/color_difference.h"
#include "reference/lut.h"

using namespace pellucid;

namespace {

using Rgb = std::array<double, 3>;

struct Point {
    double u, c;  // N.L; 1/r, 1/mm
    Rgb truth;
};

const Device& device() {
    static const Device device("");
    return device;
}

constexpr double radiusMin = 1, radiusMax = 100;  // mm

// Half of the points even in N.L and curvature, half near the terminator, where tables are worst.
const std::vector<Point>& points() {
    static const std::vector<Point> all = [] {
        std::vector<Point> result;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> even(0, 1);
        const auto skin = reference::skinProfile();
        for (int i = 0; i < 4000; ++i) {
            Point p;
            p.c = 1 / radiusMax + even(random) * (1 / radiusMin - 1 / radiusMax);
            if (i % 4 == 1) p.c = std::pow(10, -2 + 2 * even(random));
            p.u = 2 * even(random) - 1;
            if (i % 2) p.u = std::clamp(p.u * 4 * p.c, -1.0, 1.0);
            const reference::Rgb truth = reference::curvatureD(reference::Form::arc, *skin, p.u, 1 / p.c);
            p.truth = {truth[0], truth[1], truth[2]};
            result.push_back(p);
        }
        return result;
    }();
    return all;
}

// RGB per texel as a host would hold them: D, or for 8 bits the residual D - max0(u).
std::vector<float> texelsOf(const Lut& lut, PelLutEncoding encoding) {
    if (encoding == PEL_LUT_FLOAT) return lut.read<float>(encoding);
    std::vector<float> texels;
    if (encoding == PEL_LUT_HALF) {
        for (uint16_t bits : lut.read<uint16_t>(encoding)) texels.push_back(float(fromHalf(bits)));
        return texels;
    }
    const auto bytes = lut.read<uint8_t>(encoding);
    for (size_t i = 0; i < bytes.size(); ++i)
        if (i % 4 < 3) texels.push_back((float(bytes[i]) / 255 - 0.5f) / 2);
    return texels;
}

Rgb lookUp(const std::vector<float>& texels, int width, int height, double column, double row) {
    column = std::clamp(column, 0.0, width - 1.0);
    row = std::clamp(row, 0.0, height - 1.0);
    const int x = std::min(int(column), std::max(0, width - 2)), y = std::min(int(row), std::max(0, height - 2));
    const int x1 = std::min(x + 1, width - 1), y1 = std::min(y + 1, height - 1);
    const double fx = column - x, fy = row - y;
    Rgb value;
    for (int k = 0; k < 3; ++k) {
        auto at = [&](int i, int j) { return double(texels[(size_t(j) * width + i) * 3 + k]); };
        value[k] =
            (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x1, y)) + fy * ((1 - fx) * at(x, y1) + fx * at(x1, y1));
    }
    return value;
}

void lookUpError(benchmark::State& state) {
    const int side = int(state.range(0));
    const auto axis = PelLutAxis(state.range(1));
    const auto encoding = PelLutEncoding(state.range(2));
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = uint32_t(side);
    desc.axis = axis;
    desc.radiusMin = float(radiusMin);
    desc.radiusMax = float(radiusMax);
    const std::vector<float> texels = texelsOf(Lut(device(), desc), encoding);
    double worst = 0, squares = 0, color = 0;
    for (auto _ : state)
        for (const Point& p : points()) {
            const bool root = axis == PEL_AXIS_ROOT;
            const double s = root ? std::copysign(std::sqrt(std::abs(p.u)), p.u) : p.u;
            auto t = [&](double c) { return root ? std::sqrt(c) : c; };
            const double v = (t(p.c) - t(1 / radiusMax)) / (t(1 / radiusMin) - t(1 / radiusMax));
            const double column = root ? (s + 1) / 2 * (side - 1) : (s + 1) / 2 * side - 0.5;
            Rgb value = lookUp(texels, side, side, column, root ? v * (side - 1) : v * side - 0.5);
            Rgb lit, exact;
            constexpr Rgb albedo{0.8, 0.55, 0.45};
            for (int k = 0; k < 3; ++k) {
                if (encoding == PEL_LUT_FACEWORKS8) value[k] += std::max(0.0, p.u);
                const double error = std::abs(value[k] - p.truth[k]);
                worst = std::max(worst, error);
                squares += error * error;
                lit[k] = albedo[k] * value[k];
                exact[k] = albedo[k] * p.truth[k];
            }
            color = std::max(color, pellucid::io::deltaE2000(pellucid::io::labFromLinear(lit),
                                                             pellucid::io::labFromLinear(exact)));
        }
    state.counters["max"] = worst;
    state.counters["rms"] = std::sqrt(squares / double(points().size() * 3 * state.iterations()));
    state.counters["dE2000"] = color;
    state.counters["KiB"] = side * side *
                            (encoding == PEL_LUT_FLOAT  ? 16
                             : encoding == PEL_LUT_HALF ? 8
                                                        : 4) /
                            1024.0;
}

// A root table of 64x64 for 2.7 mm and r = 1 to 100 mm, read for a material of another radius at curvature
// times the ratio (section 6), against that material's own integral: over the curvatures that the table
// holds, and, `beyond`, up to r = 1 mm and 100 mm where it is clamped.
void runtimeRadius(benchmark::State& state) {
    constexpr int side = 64;
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = side;
    desc.axis = PEL_AXIS_ROOT;
    const double ratio = double(state.range(1)) / 100;
    desc.form = PelCurvatureForm(state.range(0));
    constexpr reference::Form trueForms[] = {reference::Form::arc, reference::Form::ring,
                                             reference::Form::halfRing, reference::Form::sphere};
    const auto profile = reference::profileForRadius(reference::skinProfile(), 2.7 * ratio);
    double within = 0, beyond = 0;
    for (auto _ : state) {
        const auto texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
        std::mt19937 random(9);
        std::uniform_real_distribution<double> even(0, 1);
        for (int i = 0; i < 1500; ++i) {
            const double c = std::pow(10, -2 + 2 * even(random)), at = c * ratio;
            double u = 2 * even(random) - 1;
            if (i % 2) u = std::clamp(u * 4 * at, -1.0, 1.0);
            const double s = std::copysign(std::sqrt(std::abs(u)), u), v = (std::sqrt(at) - 0.1) / 0.9;
            const Rgb value = lookUp(texels, side, side, (s + 1) / 2 * (side - 1), v * (side - 1));
            const auto truth = reference::curvatureD(trueForms[desc.form], *profile, u, 1 / c);
            for (int k = 0; k < 3; ++k) {
                double& worst = at >= 0.01 && at <= 1 ? within : beyond;
                worst = std::max(worst, std::abs(value[size_t(k)] - truth[k]));
            }
        }
    }
    state.counters["within"] = within;
    state.counters["beyond"] = beyond;
}

BENCHMARK(lookUpError)
    ->ArgNames({"side", "axis", "encoding"})
    ->ArgsProduct({{32, 63, 64, 89, 127, 128, 256, 512, 1024}, {0, 1}, {0, 1, 2}})
    ->Iterations(1);
BENCHMARK(runtimeRadius)->ArgNames({"form", "percent"})->ArgsProduct({{0, 3}, {37, 50, 100, 150, 200}})->Iterations(1);

}  // namespace

BENCHMARK_MAIN();
