// FLIP against the authors' program, on pictures that a formula gives.
#include "io/image/flip.h"
#include "io_files.h"

namespace {

constexpr int width = 40, height = 32;
using Pixels = std::vector<float>;

// `change`: of a value, its column and channel.
template <class Change>
Pixels waves(const Change& change) {
    Pixels rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                rgb.push_back(float(change(0.5 + 0.4 * std::sin(0.3 * x + 0.2 * y + c), x, c)));
    return rgb;
}

}  // namespace

TEST(Flip, AsTheAuthorsProgram) {
    const Pixels plain = waves([](double v, int, int) { return v; });
    const struct {
        const char* what;
        Pixels other;
        double mean;  // of flip-evaluator 1.7, evaluate(..., "LDR", inputsRGB=False)
    } rows[] = {
        {"hues", waves([](double v, int, int c) { return v * (1 + 0.1 * (c - 1)); }), 0.1959030},
        {"an edge", waves([](double v, int x, int) { return x > 20 && x < 23 ? 1 - v : v; }), 0.1239942},
        {"colours far apart", waves([](double v, int, int c) { return c == 2 ? 0.2 : v + 0.3; }), 0.9274812},
        {"a little darker", waves([](double v, int, int) { return 0.98 * v; }), 0.0631269},
    };
    for (const auto& row : rows) {
        EXPECT_NEAR(pellucid::io::flip(plain, row.other, width), row.mean, tolerance::flip) << row.what;
        EXPECT_NEAR(pellucid::io::flip(row.other, plain, width), row.mean, tolerance::flip) << row.what;
    }
    EXPECT_EQ(pellucid::io::flip(plain, plain, width), 0);
    Pixels broken = plain;
    broken[100] = NAN;
    EXPECT_TRUE(std::isnan(pellucid::io::flip(plain, broken, width)));
    EXPECT_THROW(pellucid::io::flip(plain, plain, 7), std::invalid_argument);
    EXPECT_THROW(pellucid::io::flip(plain, Pixels(3), 1), std::invalid_argument);
}
