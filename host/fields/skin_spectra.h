// Absorption spectra of skin, matching functions and daylight. No other file holds such data.
//
// Haemoglobin: molar extinction, 1/(cm M), per molecule of 64500 g/mol; S. Prahl, Tabulated Molar Extinction
// Coefficient for Hemoglobin in Water, OMLC 1998, from Gratzer and Kollias.
// Beta-carotene in hexane (537 g/mol), bilirubin in chloroform (585 g/mol): the same unit, means over 5 nm;
// PhotochemCAD, Du, Fuh, Li, Corkan, Lindsey 1998, as Prahl keeps them at OMLC.
// Water: 1/m; Hale and Querry, Optical Constants of Water, Applied Optics 12, 1973, linear between values.
// x, y, z: colour-matching functions of the CIE 1931 standard observer. D65: CIE standard illuminant.
#pragma once
#include <pellucid/pellucid.h>

#include <array>
#include <cmath>
#include <numbers>

namespace pel {

struct SkinSpectrum {
    float nanometres, oxyhaemoglobin, haemoglobin, carotene, bilirubin, water, x, y, z, d65;
};
inline constexpr int skinWavelengths = 69;
// clang-format off
inline constexpr SkinSpectrum skinSpectra[skinWavelengths] = {
    {380, 109564, 145232, 30292, 11601, 0.105, 0.001368, 3.9e-05, 0.00645, 49.98},
    {385, 130276, 151288, 35628, 13803, 0.0934, 0.002236, 6.4e-05, 0.01055, 52.31},
    {390, 167748, 167780, 42139, 16399, 0.0816, 0.004243, 0.00012, 0.02005, 54.65},
    {395, 221836, 196832, 51282, 19616, 0.0698, 0.00765, 0.000217, 0.03621, 68.7},
    {400, 266232, 223296, 59543, 23198, 0.058, 0.01431, 0.000396, 0.06785, 82.75},
    {405, 331462, 261958, 65540, 26890, 0.054, 0.02319, 0.00064, 0.1102, 87.12},
    {410, 466840, 303956, 73297, 30879, 0.05, 0.04351, 0.00121, 0.2074, 91.49},
    {415, 523080, 353222, 84117, 34902, 0.046, 0.07763, 0.00218, 0.3713, 92.46},
    {420, 480360, 407560, 96664, 39310, 0.042, 0.1344, 0.004, 0.6456, 93.43},
    {425, 351134, 471520, 104933, 43432, 0.038, 0.2148, 0.0073, 1.039, 90.06},
    {430, 246072, 528600, 107774, 46812, 0.036, 0.2839, 0.0116, 1.386, 86.68},
    {435, 149076, 549600, 111636, 49667, 0.034, 0.3285, 0.01684, 1.623, 95.77},
    {440, 102580, 413280, 121062, 52017, 0.032, 0.3483, 0.023, 1.747, 104.9},
    {445, 78884, 259974, 132060, 53583, 0.03, 0.3481, 0.0298, 1.783, 110.9},
    {450, 62816, 103292, 138042, 54670, 0.028, 0.3362, 0.038, 1.772, 117},
    {455, 51524, 33434, 133269, 54805, 0.0273, 0.3187, 0.048, 1.744, 117.4},
    {460, 44480, 23389, 120834, 53808, 0.0267, 0.2908, 0.06, 1.669, 117.8},
    {465, 38440, 18702, 110534, 50990, 0.026, 0.2511, 0.0739, 1.528, 116.3},
    {470, 33209, 16156, 108581, 45979, 0.0254, 0.1954, 0.09098, 1.288, 114.9},
    {475, 29482, 14921, 111562, 38643, 0.0247, 0.1421, 0.1126, 1.042, 115.4},
    {480, 26629, 14550, 109329, 29741, 0.0248, 0.09564, 0.139, 0.813, 115.9},
    {485, 24925, 15378, 96676, 21342, 0.0248, 0.05795, 0.1693, 0.6162, 112.4},
    {490, 23684, 16684, 75696, 14159, 0.0249, 0.03201, 0.208, 0.4652, 108.8},
    {495, 22154, 18648, 52845, 8724, 0.0249, 0.0147, 0.2586, 0.3533, 109.1},
    {500, 20933, 20862, 32799, 4804, 0.025, 0.0049, 0.323, 0.272, 109.4},
    {505, 20182, 23289, 18864, 2512, 0.0264, 0.0024, 0.4073, 0.2123, 108.6},
    {510, 20035, 25774, 10521, 1314, 0.0278, 0.0093, 0.503, 0.1582, 107.8},
    {515, 20715, 28682, 5983, 670, 0.0292, 0.0291, 0.6082, 0.1117, 106.3},
    {520, 24202, 31590, 3710, 341, 0.0306, 0.06327, 0.71, 0.07825, 104.8},
    {525, 30883, 35171, 2323, 199, 0.032, 0.1096, 0.7932, 0.05725, 106.2},
    {530, 39957, 39036, 1751, 132, 0.0346, 0.1655, 0.862, 0.04216, 107.7},
    {535, 48338, 42840, 1208, 88, 0.0372, 0.2257, 0.9149, 0.02984, 106},
    {540, 53236, 46592, 1056, 66, 0.0398, 0.2904, 0.954, 0.0203, 104.4},
    {545, 50982, 50488, 858, 73, 0.0424, 0.3597, 0.9803, 0.0134, 104.2},
    {550, 43016, 53412, 965, 58, 0.045, 0.4334, 0.995, 0.00875, 104},
    {555, 35646, 54530, 828, 48, 0.0518, 0.5121, 1, 0.00575, 102},
    {560, 32613, 53788, 553, 40, 0.0586, 0.5945, 0.995, 0.0039, 100},
    {565, 35205, 49700, 0, 0, 0.0654, 0.6784, 0.9786, 0.00275, 98.17},
    {570, 44496, 45072, 0, 0, 0.0722, 0.7621, 0.952, 0.0021, 96.33},
    {575, 54424, 40904, 0, 0, 0.079, 0.8425, 0.9154, 0.0018, 96.06},
    {580, 50104, 37020, 0, 0, 0.109, 0.9163, 0.87, 0.00165, 95.79},
    {585, 30620, 33592, 0, 0, 0.139, 0.9786, 0.8163, 0.0014, 92.24},
    {590, 14401, 28324, 0, 0, 0.17, 1.026, 0.757, 0.0011, 88.69},
    {595, 6681, 21187, 0, 0, 0.2, 1.057, 0.6949, 0.001, 89.35},
    {600, 3200, 14677, 0, 0, 0.23, 1.062, 0.631, 0.0008, 90.01},
    {605, 1959, 12040, 0, 0, 0.24, 1.046, 0.5668, 0.0006, 89.8},
    {610, 1506, 9444, 0, 0, 0.25, 1.003, 0.503, 0.00034, 89.6},
    {615, 1166, 7553, 0, 0, 0.26, 0.9384, 0.4412, 0.00024, 88.65},
    {620, 942, 6510, 0, 0, 0.27, 0.8544, 0.381, 0.00019, 87.7},
    {625, 741, 5763, 0, 0, 0.28, 0.7514, 0.321, 0.0001, 85.49},
    {630, 610, 5149, 0, 0, 0.288, 0.6424, 0.265, 5e-05, 83.29},
    {635, 496, 4667, 0, 0, 0.296, 0.5419, 0.217, 3e-05, 83.49},
    {640, 442, 4345, 0, 0, 0.304, 0.4479, 0.175, 2e-05, 83.7},
    {645, 398, 4027, 0, 0, 0.312, 0.3608, 0.1382, 1e-05, 81.86},
    {650, 368, 3750, 0, 0, 0.32, 0.2835, 0.107, -1.906e-21, 80.03},
    {655, 340, 3481, 0, 0, 0.339, 0.2187, 0.0816, 0, 80.12},
    {660, 320, 3227, 0, 0, 0.358, 0.1649, 0.061, 0, 80.21},
    {665, 306, 3011, 0, 0, 0.377, 0.1212, 0.04458, 0, 81.25},
    {670, 294, 2795, 0, 0, 0.396, 0.0874, 0.032, 0, 82.28},
    {675, 284, 2591, 0, 0, 0.415, 0.0636, 0.0232, 0, 80.28},
    {680, 278, 2408, 0, 0, 0.452, 0.04677, 0.017, 0, 78.28},
    {685, 274, 2225, 0, 0, 0.489, 0.0329, 0.01192, 0, 74},
    {690, 276, 2052, 0, 0, 0.526, 0.0227, 0.00821, 0, 69.72},
    {695, 281, 1923, 0, 0, 0.563, 0.01584, 0.005723, 0, 70.67},
    {700, 290, 1794, 0, 0, 0.6, 0.01136, 0.004102, 0, 71.61},
    {705, 300, 1661, 0, 0, 0.798, 0.008111, 0.002929, 0, 72.98},
    {710, 314, 1540, 0, 0, 0.996, 0.00579, 0.002091, 0, 74.35},
    {715, 329, 1433, 0, 0, 1.19, 0.004109, 0.001484, 0, 67.98},
    {720, 348, 1326, 0, 0, 1.39, 0.002899, 0.001047, 0, 61.6},
};
// clang-format on

// Absorption and scattering, 1/mm.
struct SkinCoefficients {
    double epidermis, dermis, scattering;
};

// Jacques, Optical properties of biological tissues: a review, 2013: melanosomes, scattering. Skin without
// blood and melanin: Jacques, Skin Optics, OMLC News, January 1998, after Saidi 1992. Pheomelanin: Donner and
// Jensen, A Spectral BSSRDF for Shading Human Skin, 2006. Blood holds 150 g of haemoglobin a litre (Prahl).
inline SkinCoefficients skinCoefficients(const PelSkin& skin, const SkinSpectrum& at) {
    const double nm = at.nanometres, ratio = nm / 500, perCm = 0.1, ln10 = std::numbers::ln10;
    const double eumelanin = perCm * 519 * std::pow(ratio, -3.0), pheomelanin = 2.9e14 * std::pow(nm, -4.75);
    const double bare = perCm * (0.244 + 85.3 * std::exp(-(nm - 154) / 66.2));
    const double haemoglobin =
        at.oxyhaemoglobin * double(skin.oxygenation) + at.haemoglobin * (1 - double(skin.oxygenation));
    const double melanin = skin.melanin, blood = skin.blood;
    return {melanin * (skin.eumelanin * eumelanin + (1 - double(skin.eumelanin)) * pheomelanin) +
                (1 - melanin) * bare + perCm * ln10 * at.carotene * skin.carotene * 1e-3 / 537,
            perCm * ln10 * (blood * haemoglobin * 150 / 64500 + at.bilirubin * skin.bilirubin * 1e-3 / 585) +
                (1 - blood) * bare + skin.water * double(at.water) * 1e-3,
            skin.scattering * std::pow(ratio, -double(skin.scatteringPower))};
}

// Share of a wavelength in each channel of linear sRGB (IEC 61966-2-1) under D65; a channel adds up to 1.
inline const std::array<std::array<double, 3>, skinWavelengths>& skinChannels() {
    static const auto all = [] {
        std::array<std::array<double, 3>, skinWavelengths> w{};
        std::array<double, 3> sum{};
        for (int i = 0; i < skinWavelengths; ++i) {
            const SkinSpectrum& s = skinSpectra[i];
            w[i] = {3.2404542 * s.x - 1.5371385 * s.y - 0.4985314 * s.z,
                    -0.9692660 * s.x + 1.8760108 * s.y + 0.0415560 * s.z,
                    0.0556434 * s.x - 0.2040259 * s.y + 1.0572252 * s.z};
            for (int c = 0; c < 3; ++c) sum[c] += w[i][c] *= s.d65;
        }
        for (auto& row : w)
            for (int c = 0; c < 3; ++c) row[c] /= sum[c];
        return w;
    }();
    return all;
}

}  // namespace pel
