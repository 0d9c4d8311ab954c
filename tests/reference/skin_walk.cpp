#include "reference/skin_walk.h"

#include "reference/eye.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>

namespace reference {

SkinWalk walkSkin(const std::vector<WalkLayer>& layers, double index, int walks, uint64_t seed, double edge) {
    std::mt19937_64 bits(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto random = [&] { return 1 - uniform(bits); };  // never 0
    std::vector<double> top{0};
    for (const WalkLayer& layer : layers) top.push_back(top.back() + layer.thickness);
    double sum = 0, squares = 0, distance = 0, beyond = 0;
    for (int w = 0; w < walks; ++w) {
        // Diffuse light: the square of the sine is uniform outside.
        const double sine = std::sqrt(random()) / index;
        double x = 0, y = 0, z = 0, dx = sine, dy = 0, dz = std::sqrt(1 - sine * sine);
        double weight = 1 - fresnel(dz, index, 1), left = 0;
        size_t layer = 0;
        double optical = -std::log(random());
        while (weight > 0) {
            const WalkLayer& in = layers[layer];
            const double extinction = in.absorption + in.scattering, step = optical / extinction;
            const bool last = layer + 1 == layers.size();
            const double border = dz < 0            ? (top[layer] - z) / dz
                                  : last || dz == 0 ? INFINITY
                                                    : (top[layer + 1] - z) / dz;
            const double go = std::min(step, border);
            x += dx * go;
            y += dy * go;
            z += dz * go;
            if (step <= border) {
                weight *= in.scattering / extinction;
                if (weight < 1e-3) weight = random() < 0.1 ? weight * 10 : 0;  // Russian roulette
                const double turn = 2 * std::numbers::pi * random();
                dz = 2 * random() - 1;
                dx = std::sqrt(1 - dz * dz) * std::cos(turn);
                dy = std::sqrt(1 - dz * dz) * std::sin(turn);
                optical = -std::log(random());
                continue;
            }
            optical -= border * extinction;
            if (dz > 0) {
                z = top[++layer];
            } else if (layer > 0) {
                z = top[layer--];
            } else {
                z = 0;
                if (random() < fresnel(-dz, index, 1)) {
                    dz = -dz;
                } else {
                    left = weight;
                    break;
                }
            }
        }
        sum += left;
        squares += left * left;
        const double away = std::hypot(x, y);
        distance += left * away;
        if (away > edge) beyond += left * std::acos(edge / away) / std::numbers::pi;
    }
    const double n = walks;
    return {sum / n, distance / n, std::sqrt(squares / n - sum / n * sum / n) / std::sqrt(n), beyond / n};
}

namespace {

// From 380 nm in steps of 10. Molar extinction of oxyhaemoglobin and haemoglobin, 1/(cm M): Prahl, OMLC 1998.
constexpr double extinction[][2] = {
    {109564, 145232}, {167748, 167780}, {266232, 223296}, {466840, 303956}, {480360, 407560},
    {246072, 528600}, {102580, 413280}, {62816, 103292},  {44480, 23389},   {33209, 16156},
    {26629, 14550},   {23684, 16684},   {20933, 20862},   {20035, 25774},   {24202, 31590},
    {39957, 39036},   {53236, 46592},   {43016, 53412},   {32613, 53788},   {44496, 45072},
    {50104, 37020},   {14401, 28324},   {3200, 14677},    {1506, 9444},     {942, 6510},
    {610, 5149},      {442, 4345},      {368, 3750},      {320, 3227},      {294, 2795},
    {278, 2408},      {276, 2052},      {290, 1794},      {314, 1540},      {348, 1326},
};
constexpr double daylight[] = {
    // CIE D65
    49.98, 54.65, 82.75, 91.49, 93.43, 86.68, 104.9, 117,   117.8, 114.9, 115.9, 108.8,
    109.4, 107.8, 104.8, 107.7, 104.4, 104,   100,   96.33, 95.79, 88.69, 90.01, 89.6,
    87.7,  83.29, 83.7,  80.03, 80.21, 82.28, 78.28, 69.72, 71.61, 74.35, 61.6,
};

// The CIE 1931 colour-matching functions as sums of Gaussians with two widths: Wyman, Sloan, Shirley, Simple
// Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2(2), 2013.
double lobe(double nm, double height, double centre, double below, double above) {
    const double t = (nm - centre) * (nm < centre ? below : above);
    return height * std::exp(-t * t / 2);
}

}  // namespace

std::vector<WalkLayer> layersOf(const WalkedSkin& skin, double nm) {
    const double* hb = extinction[int(nm - 380) / 10];
    const double scattering = skin.scattering * std::pow(nm / 500, -skin.scatteringPower);
    const double bare = (0.244 + 85.3 * std::exp((154 - nm) / 66.2)) / 10;
    const double pigment =
        skin.eumelanin * 51.9 * std::pow(500 / nm, 3) + (1 - skin.eumelanin) * 2.9e14 * std::pow(nm, -4.75);
    const double blood =
        std::log(10) / 10 * 150 / 64500 * (skin.oxygenation * hb[0] + (1 - skin.oxygenation) * hb[1]);
    return {{skin.epidermis, skin.melanin * pigment + (1 - skin.melanin) * bare, scattering},
            {0, skin.blood * blood + (1 - skin.blood) * bare, scattering}};
}

WalkedChannels walkChannels(const WalkedSkin& skin, int walks) {
    WalkedChannels out{};
    double white[3]{}, positive[3]{};
    for (int i = 0; i < int(std::size(daylight)); ++i) {
        const double nm = 380 + 10 * i;
        const double x = lobe(nm, 0.362, 442, 0.0624, 0.0374) + lobe(nm, 1.056, 599.8, 0.0264, 0.0323) -
                         lobe(nm, 0.065, 501.1, 0.049, 0.0382);
        const double y = lobe(nm, 0.821, 568.8, 0.0213, 0.0247) + lobe(nm, 0.286, 530.9, 0.0613, 0.0322);
        const double z = lobe(nm, 1.217, 437, 0.0845, 0.0278) + lobe(nm, 0.681, 459, 0.0385, 0.0725);
        const double weights[3] = {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
                                   -0.969266 * x + 1.8760108 * y + 0.041556 * z,
                                   0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
        const SkinWalk walk = walkSkin(layersOf(skin, nm), 1.4, walks, uint64_t(i) + 1);
        for (int c = 0; c < 3; ++c) {
            const double w = weights[c] * daylight[i], kept = std::max(0.0, w);
            white[c] += w;
            out.albedo[c] += w * walk.reflectance;
            positive[c] += kept * walk.reflectance;
            out.meanDistance[c] += kept * walk.distance;
        }
    }
    for (int c = 0; c < 3; ++c) {
        out.albedo[c] /= white[c];
        out.meanDistance[c] /= positive[c];
    }
    return out;
}

}  // namespace reference
