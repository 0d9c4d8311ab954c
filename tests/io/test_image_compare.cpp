// Numbers of `pellucid compare`: colour differences as published, errors summed by hand, sub-sets.
#include "io/image/image_compare.h"
#include "io/image/image_file.h"
#include "io_files.h"

namespace io = pellucid::io;

// Sharma, Wu & Dalal, The CIEDE2000 Color-Difference Formula: Implementation Notes, Supplementary Test Data,
// and Mathematical Observations, Color Research and Application 30 (2005), table 1.
TEST(ColorDifference, PublishedPairs) {
    const struct {
        io::Lab one, two;
        double difference;
    } pairs[] = {
        {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
        {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
        {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
        {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
        {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
        {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
        {{50, 0, 0}, {50, -1, 2}, 2.3669},
        {{50, -1, 2}, {50, 0, 0}, 2.3669},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0009}, 7.1792},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0010}, 7.1792},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0011}, 7.2195},
        {{50, 2.4900, -0.0010}, {50, -2.4900, 0.0012}, 7.2195},
        {{50, -0.0010, 2.4900}, {50, 0.0009, -2.4900}, 4.8045},
        {{50, -0.0010, 2.4900}, {50, 0.0010, -2.4900}, 4.8045},
        {{50, -0.0010, 2.4900}, {50, 0.0011, -2.4900}, 4.7461},
        {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
        {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
        {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
        {{50, 2.5, 0}, {56, -27, -3}, 31.9030},
        {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
        {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1.0000},
        {{50, 2.5, 0}, {50, 3.2972, 0}, 1.0000},
        {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1.0000},
        {{50, 2.5, 0}, {50, 3.2592, 0.3350}, 1.0000},
        {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
        {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.2630},
        {{61.2901, 3.7196, -5.3901}, {61.4292, 2.2480, -4.9620}, 1.8731},
        {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
        {{22.7233, 20.0904, -46.6940}, {23.0331, 14.9730, -42.5619}, 2.0373},
        {{36.4612, 47.8580, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
        {{90.8027, -2.0831, 1.4410}, {91.1528, -1.6435, 0.0447}, 1.4441},
        {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
        {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
        {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082},
    };
    int number = 0;
    for (const auto& p : pairs)
        EXPECT_NEAR(io::deltaE2000(p.one, p.two), p.difference, tolerance::publishedDeltaE)
            << "pair " << ++number;
}

// The corners of sRGB and its greys, as published for its matrix and D65 [B. Lindbloom, CIE calculator].
TEST(ColorDifference, LabOfKnownColours) {
    const std::pair<std::array<double, 3>, io::Lab> known[] = {
        {{1, 0, 0}, {53.2408, 80.0925, 67.2032}},
        {{0, 1, 0}, {87.7347, -86.1827, 83.1793}},
        {{0, 0, 1}, {32.2970, 79.1875, -107.8602}},
        {{1, 1, 1}, {100, 0, 0}},
        {{0, 0, 0}, {0, 0, 0}},
        {{0.18418651, 0.18418651, 0.18418651}, {50, 0, 0}},
        {{-1, 1, -1}, {87.7347, -86.1827, 83.1793}}};
    for (const auto& [rgb, lab] : known)
        for (size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(io::labFromLinear(rgb)[i], lab[i], 0.02) << rgb[0] << rgb[1] << rgb[2] << i;
}

TEST(CompareImages, SumsByHand) {
    std::vector<float> a(300, 0.5f), b = a;
    a[0] += 0.3f, a[4] -= 0.4f;
    const io::ImageDifference d = io::compareImages(a, b);
    EXPECT_EQ(d.pixels, 100u);
    EXPECT_NEAR(d.rmse[0], 0.03, 1e-7);
    EXPECT_NEAR(d.rmse[1], 0.04, 1e-7);
    EXPECT_EQ(d.rmse[2], 0);
    EXPECT_NEAR(d.rmseAll, 0.05 / std::sqrt(3), 1e-7);
    EXPECT_NEAR(d.psnr, -20 * std::log10(0.05 / std::sqrt(3)), 1e-5);
    EXPECT_NEAR(d.mean[0], 0.003, 1e-7);
    EXPECT_NEAR(d.mean[1], -0.004, 1e-7);
    EXPECT_NEAR(d.max[0], 0.3, 1e-6);
    EXPECT_EQ(d.p99[0], 0) << "99 of 100 have none";
    a[3] += 0.1f;
    EXPECT_NEAR(io::compareImages(a, b).p99[0], 0.1, 1e-6);
    EXPECT_EQ(io::compareImages(b, b).psnr, std::numeric_limits<double>::infinity());
}

TEST(CompareImages, MaskAndPixelsThatAreNoNumbers) {
    std::vector<float> a(12, 1.0f), b = a;
    a[0] = std::numeric_limits<float>::quiet_NaN();
    b[5] = -std::numeric_limits<float>::infinity();
    a[11] = 2;
    size_t invalid = 0;
    io::ImageDifference d = io::compareImages(a, b, {}, &invalid);
    EXPECT_EQ(invalid, 2u);
    EXPECT_EQ(d.pixels, 2u);
    EXPECT_NEAR(d.rmse[2], std::sqrt(0.5), 1e-7);
    const std::vector<uint8_t> mask{1, 1, 1, 0};
    d = io::compareImages(a, b, mask);
    EXPECT_EQ(d.pixels, 1u);
    EXPECT_EQ(d.rmseAll, 0);
    const io::ImageDifference none = io::compareImages(a, b, std::vector<uint8_t>(4));
    EXPECT_EQ(none.pixels, 0u);
    for (double value : {none.rmse[0], none.mean[1], none.p99[2], none.max[0], none.noise[1], none.rmseAll,
                         none.psnr, none.deltaEMean, none.deltaE99, none.deltaEMax})
        EXPECT_TRUE(std::isnan(value)) << value;
    EXPECT_EQ(io::compareImages({}, {}).pixels, 0u);
    EXPECT_THROW(io::compareImages(a, b, {}, nullptr, std::vector<float>(9)), std::invalid_argument);
    EXPECT_THROW(io::compareImages(a, std::vector<float>(9)), std::invalid_argument);
    EXPECT_THROW(io::compareImages(a, b, std::vector<uint8_t>(3)), std::invalid_argument);
}

// Two noisy estimates of 0.5: their noise is much larger than the difference of the pictures.
TEST(CompareImages, NoiseOfTwoHalvesIsNotInTheError) {
    constexpr size_t count = 3 * 40000;
    constexpr double difference = 0.02, noise = 0.1;
    const std::vector<float> a(count, float(0.5 + difference));
    std::vector<float> first, second;
    std::mt19937 random(3);
    std::normal_distribution<float> normal(0.5f, float(noise));
    for (size_t i = 0; i < count; ++i) first.push_back(normal(random)), second.push_back(normal(random));
    const io::ImageDifference d = io::compareImages(a, first, {}, nullptr, second);
    for (size_t c = 0; c < 3; ++c) {
        // The squared error's standard deviation is noise^2 / sqrt(pixels) = 5e-5; four are allowed.
        EXPECT_NEAR(d.rmse[c] * d.rmse[c], difference * difference, 2e-4);
        EXPECT_NEAR(d.noise[c], noise / std::sqrt(2), 0.002);
        EXPECT_NEAR(d.mean[c], difference, 0.002);
    }
    EXPECT_GT(io::compareImages(a, first).rmse[0], noise);
    EXPECT_EQ(io::compareImages(a, first).noise[0], 0);
}

// A row that turns away from the light, with a cast shadow over two pixels of its lit part.
TEST(Subsets, OfARow) {
    const int width = 40;
    std::vector<float> positions, normals, light, visible;
    for (int i = 0; i < width; ++i) {
        const float cosine = 1.01f - 0.05f * float(i);  // below 0 from pixel 21 on
        positions.insert(positions.end(), {0.1f * float(i), 0, 0});
        normals.insert(normals.end(), {std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine});
        light.insert(light.end(), {0, 0, 1});
        visible.push_back(i != 5 && i != 6);
    }
    std::vector<uint8_t> covered(width, 1), expected(width);
    covered[8] = covered[39] = 0;
    for (int i = 0; i < 39; ++i) {
        if (!covered[size_t(i)]) continue;
        int in = i > 20 ? io::SUBSET_UNLIT : 0;
        if (i > 16 && i < 25) in |= io::SUBSET_TERMINATOR;
        if (i >= 2 && i <= 9) in |= io::SUBSET_PENUMBRA;
        expected[size_t(i)] = uint8_t(in ? in : io::SUBSET_REST);
    }
    EXPECT_EQ(io::subsetsOf({width, 1, positions, normals, light, visible, covered, 0.25f}), expected);
    EXPECT_FALSE(io::subsetsOf({width, 1, positions, normals, light, {}, covered, 0.25f})[5] &
                 io::SUBSET_PENUMBRA);
}

TEST(Subsets, HollowsAndThinParts) {
    const std::vector<float> positions(15), normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1},
        light = normals, curvature{-0.4f, -0.1f, 0.4f, -0.4f, -0.4f}, thickness{9, 1.9f, 2.1f, 1, 1},
        path{0.5f, 0.5f, 0.5f, 0.5f, 0.1f};
    const std::vector<uint8_t> covered{1, 1, 1, 0, 1};
    const auto subsets =
        io::subsetsOf({5, 1, positions, normals, light, {}, covered, 1, curvature, thickness, path});
    uint32_t bits = 0, sum = 0;
    for (const auto bit : {io::SUBSET_UNLIT, io::SUBSET_TERMINATOR, io::SUBSET_PENUMBRA, io::SUBSET_REST,
                           io::SUBSET_HOLLOWS, io::SUBSET_THIN})
        bits |= bit, sum += bit;
    EXPECT_EQ(sum, bits) << "each has a bit of its own";
    EXPECT_EQ(subsets, (std::vector<uint8_t>{io::SUBSET_HOLLOWS, io::SUBSET_THIN, io::SUBSET_REST, 0,
                                             io::SUBSET_REST}));
}

using NpyRead = FolderTest;

TEST_F(NpyRead, WhatWasWritten) {
    const std::vector<float> values{0, 0.5f, -2, 1024, 3, 0.25f};
    const size_t shape[] = {2, 3};
    io::writeNpy(path("f.npy"), shape, values);
    io::writeNpy(path("h.npy"), shape, values, io::ChannelType::Half);
    io::writeNpy(path("b.npy"), shape, std::vector<uint8_t>{0, 1, 2, 3, 254, 255});
    for (const char* name : {"f.npy", "h.npy"}) {
        EXPECT_EQ(io::readNpy(path(name)).values, values);
        EXPECT_EQ(io::readNpy(path(name)).shape, (std::vector<size_t>{2, 3}));
    }
    EXPECT_EQ(io::readNpy(path("b.npy")).values, (std::vector<float>{0, 1, 2, 3, 254, 255}));
    const std::string file = read(path("f.npy"));
    EXPECT_EQ(file.size() % 64, values.size() * 4) << "data start on a multiple of 64";
    EXPECT_TRUE(contains(file, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, ), }"));
    EXPECT_THROW(io::writeNpy(path("c.npy"), shape, std::vector<float>(3)), std::invalid_argument);
}

TEST_F(NpyRead, DamagedFilesAreRefused) {
    const size_t shape[] = {4};
    io::writeNpy(path("f.npy"), shape, std::vector<float>{1, 2, 3, 4});
    const std::string good = read(path("f.npy"));
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        return text.replace(text.find(from), from.size(), to);
    };
    for (const auto& [bytes, message] : {std::pair{std::string(), "is not an .npy file"},
                                         {good.substr(0, 40), "cut off in its header"},
                                         {good.substr(0, good.size() - 1), "holds 15 bytes"},
                                         {good + "x", "holds 17 bytes"},
                                         {with("<f4", ">f4"), "type '>f4'"},
                                         {with("False", "True "), "not in C order"},
                                         {with("(4, ", "(-4,"), "shape"},
                                         {with("\x01", "\x07"), "version 7"}}) {
        write("bad.npy", bytes);
        EXPECT_TRUE(contains(messageOf<io::FileError>([&] { io::readNpy(path("bad.npy")); }), message));
    }
    EXPECT_THROW(io::readNpy(path("none.npy")), io::FileError);
}
