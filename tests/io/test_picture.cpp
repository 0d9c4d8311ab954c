// host/io: tone mapping, the colour map, and contact sheets.
#include "io/image/image_compare.h"
#include "io/image/image_file.h"
#include "io/image/picture.h"
#include "io/image/tone_map.h"
#include "io_files.h"

using namespace pellucid::io;

namespace {

Srgb8 at(const Picture& p, int x, int y) {
    const uint8_t* c = &p.rgb[3 * static_cast<size_t>(y * p.width + x)];
    return {c[0], c[1], c[2]};
}

// Lightness, hue (degrees) and chroma are those given, up to bytes; less chroma at the border of sRGB alone.
// OKLab [B. Ottosson, "A perceptual color space for image processing", 2020].
void expectOklab(Srgb8 color, double lightness, double hue, double chroma) {
    double x[3];
    for (size_t c = 0; c < 3; ++c) x[c] = decodeSrgb(color[c] / 255.0f);
    const double l = std::cbrt(0.4122214708 * x[0] + 0.5363325363 * x[1] + 0.0514459929 * x[2]),
                 m = std::cbrt(0.2119034982 * x[0] + 0.6806995451 * x[1] + 0.1073969566 * x[2]),
                 s = std::cbrt(0.0883024619 * x[0] + 0.2817188376 * x[1] + 0.6299787005 * x[2]);
    EXPECT_NEAR(0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s, lightness, 0.005);
    const double a = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
                 b = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s, angle = hue * M_PI / 180;
    EXPECT_NEAR(b * std::cos(angle) - a * std::sin(angle), 0, 0.005) << "across the hue";
    const double found = a * std::cos(angle) + b * std::sin(angle);
    const bool atBorder = std::ranges::min(color) <= 1 || std::ranges::max(color) >= 254;
    EXPECT_LT(found, chroma + 0.005);
    if (!atBorder) {
        EXPECT_GT(found, chroma - 0.005);
    }
}
std::vector<uint8_t> shown(const std::vector<float>& rgb, const ToneMap& map) {
    return toSrgb8(rgb, map);
}

}  // namespace

TEST(ToneMap, IsProportionalBelowTheShoulderAndSmoothAbove) {
    const ToneMap map{2.0f, 0.75f};
    const auto at = [&](float x) { return toneMapped(x, map); };
    EXPECT_FLOAT_EQ(at(0.25f), 0.5f);
    EXPECT_FLOAT_EQ(at(0.375f), 0.75f);
    EXPECT_FLOAT_EQ(at(0.5f), 0.75f + 0.25f * 0.5f);  // t = 1
    const float h = 1.0f / 4096;
    EXPECT_NEAR((at(0.375f + h) - at(0.375f)) / h, 2.0f, 8 * h * 2) << "the slope goes on";
    for (float x = 0; x < 100; x += 0.01f) EXPECT_LE(at(x), std::min(1.0f, at(x + 0.01f)));
    for (float bad : {-1.0f, std::nanf(""), -INFINITY}) EXPECT_EQ(toneMapped(bad, map), 0.0f);
    EXPECT_EQ(toneMapped(INFINITY, map), 1.0f);
}

TEST(ToneMap, CurvesRiseFromBlackToWhite) {
    for (const ToneCurve curve : {ToneCurve::none, ToneCurve::soft, ToneCurve::filmic, ToneCurve::agxLike}) {
        ToneMap map;
        map.curve = curve;
        uint8_t last = 0;
        for (float x = 0; x < 64; x = 1.1f * x + 1e-4f) {
            const std::vector<uint8_t> grey = shown({x, x, x}, map);
            EXPECT_EQ(grey[0], grey[1]);
            EXPECT_EQ(grey[1], grey[2]);
            EXPECT_GE(grey[0], last) << x;
            last = grey[0];
        }
        EXPECT_GT(last, 250) << int(curve);
        EXPECT_EQ(shown({INFINITY, INFINITY, INFINITY}, map)[0], 255) << int(curve);
        if (curve != ToneCurve::agxLike) {
            EXPECT_EQ(shown({NAN, -1, -INFINITY}, map), (std::vector<uint8_t>{0, 0, 0}));
        }
    }
}

// Figures of the sources: Hable's page maps its white, 11.2 after twice the exposure, to 1; middle grey
// gets half the code values of AgX.
TEST(ToneMap, CurvesHitTheirSourcesPoints) {
    ToneMap map;
    map.curve = ToneCurve::filmic;
    EXPECT_EQ(shown({5.6f}, map)[0], 255);
    EXPECT_LT(shown({4.0f}, map)[0], 255);
    map.curve = ToneCurve::agxLike;
    const float grey = 0.18f, white = 90.6f * grey;  // 6.5 stops above
    EXPECT_NEAR(shown({grey, grey, grey}, map)[0], 127.5, 0.6);
    EXPECT_EQ(shown({white, white, white}, map)[0], 255);
    // The formulas of both, in double precision and by another program.
    EXPECT_EQ(shown({0.8f, 0.2f, 0.05f}, map), (std::vector<uint8_t>{204, 134, 76}));
    std::vector<float> stops;
    for (const int k : {-8, -4, -2, -1, 1, 2, 4, 6})
        stops.insert(stops.end(), 3, 0.18f * std::exp2(float(k)));
    const std::vector<uint8_t> codes = shown(stops, map);
    for (size_t i = 0; i < 8; ++i)
        EXPECT_EQ(codes[3 * i], (std::vector{8, 41, 74, 98, 157, 183, 223, 250})[i]) << i;
    map.curve = ToneCurve::filmic;
    EXPECT_EQ(shown({0.02f, 0.18f, 0.5f, 1, 2, 4}, map), (std::vector<uint8_t>{33, 100, 150, 186, 220, 246}));
    map.curve = ToneCurve::agxLike;
    // A saturated light turns paler the brighter it is.
    const auto dim = shown({0.2f, 0, 0}, map), bright = shown({20, 0, 0}, map);
    EXPECT_GT(dim[0] - dim[1], bright[0] - bright[1]);
}

TEST(ToneMap, BytesAreSrgb) {
    const float rgb[] = {0.0f, 0.0031308f, 0.18f, 0.5f, 0.8f, INFINITY};
    // 0.18 is sRGB 0.4614, 0.5 is 0.7354, 0.8 is 0.9063 (IEC 61966-2-1).
    EXPECT_EQ(toSrgb8(rgb), (std::vector<uint8_t>{0, 10, 118, 188, 231, 255}));
    for (int i = 0; i < 256; ++i) {
        EXPECT_EQ(std::lround(255 * encodeSrgb(decodeSrgb(i / 255.0f))), i);
    }
}

TEST(ColorMap, IsEvenInOklab) {
    for (int i = 0; i <= 64; ++i) {
        const float t = float(i) / 64;
        SCOPED_TRACE(t);
        expectOklab(sequentialColor(t), 0.28 + 0.57 * t, 264 + 166 * t, 0.19);
        expectOklab(divergingColor(t), 0.95 - 0.45 * t, 29, 0.19 * t);
        expectOklab(divergingColor(-t), 0.95 - 0.45 * t, 264, 0.19 * t);
    }
    EXPECT_EQ(sequentialColor(-5), sequentialColor(0));
    EXPECT_EQ(sequentialColor(INFINITY), sequentialColor(1));
    EXPECT_EQ(sequentialColor(NAN), (Srgb8{128, 128, 128}));
    EXPECT_EQ(scaleColor(-3, -3, 6), divergingColor(-0.5f));
    EXPECT_EQ(scaleColor(0, -3, 6), divergingColor(0));
    EXPECT_EQ(scaleColor(3, 0, 6), sequentialColor(0.5f));
}

TEST(Picture, TextIsWrittenInsideItsBox) {
    const Srgb8 white = {255, 255, 255};
    for (const int scale : {1, 2, 3}) {
        Picture p(200 * scale, 40 * scale);
        const int end = p.write(20 * scale, 10 * scale, "Nägel, N·L = g", white, scale);
        ASSERT_GT(*std::ranges::max_element(p.rgb), 128) << "install fonts-dejavu-core";
        EXPECT_EQ(end, 20 * scale + textWidth("Nägel, N·L = g", scale));
        // A dot over a letter may reach higher than a capital.
        for (int y = 0; y < p.height; ++y)
            for (int x = 0; x < p.width; ++x)
                EXPECT_TRUE(at(p, x, y)[0] <= 128 || (x >= 19 * scale && x <= end + scale && y >= 9 * scale &&
                                                      y < (11 + textHeight(1)) * scale))
                    << x << ", " << y << " at scale " << scale;
    }
    // A capital stands seven rows below the top.
    for (const int scale : {1, 2, 4}) {
        Picture p(40 * scale, 40 * scale);
        p.write(10 * scale, 10 * scale, "H", white, scale);
        int last = 0;
        for (int y = 0; y < p.height; ++y)
            for (int x = 0; x < p.width; ++x)
                if (at(p, x, y)[0] > 128) last = y;
        EXPECT_EQ(last, 17 * scale - 1) << "at scale " << scale;
    }
    EXPECT_NE(textWidth("abcdefg"), textWidth("ABCDEFG")) << "letters keep their case";
    Picture clipped(10, 10);
    clipped.write(-3, -3, "XXXX", white, 4);  // sticks out on all sides
    EXPECT_GT(textWidth("ab"), textWidth("a"));
    EXPECT_EQ(textWidth(""), 0);
}

TEST(Picture, PastingIsCutAtEachBorder) {
    const Srgb8 paper{9, 9, 9};
    for (int y : {-5, -2, -1, 0, 3, 4, 7})
        for (int x : {-5, -2, -1, 0, 4, 5, 8}) {
            Picture sheet(6, 5, paper), stamp(3, 2, paper);
            for (int j = 0; j < 2; ++j)
                for (int i = 0; i < 3; ++i) stamp.paint(i, j, {uint8_t(100 + i), uint8_t(200 + j), 0});
            sheet.paste(x, y, stamp);
            for (int j = 0; j < 5; ++j)
                for (int i = 0; i < 6; ++i) {
                    const bool on = i >= x && i < x + 3 && j >= y && j < y + 2;
                    EXPECT_EQ(at(sheet, i, j), on ? at(stamp, i - x, j - y) : paper)
                        << i << ", " << j << " pasted at " << x << ", " << y;
                }
        }
}
