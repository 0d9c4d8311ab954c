// The figures of docs/guide/luts.md and docs/guide/shading.md that follow from the definitions alone, in double precision
// by the oracle: prints the blocks between <!-- figures: NAME --> and <!-- figures end --> there, which bench/doc_figures puts
// in place and checks. Nothing of a device or of this library's own code is in them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "reference/cube.h"
#include "reference/lut.h"

using namespace reference;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::pair<Form, const char*> forms[] = {{Form::arc, "arc"},
                                                  {Form::ring, "ring"},
                                                  {Form::halfRing, "half-ring"},
                                                  {Form::pennerRing, "penner-ring"},
                                                  {Form::sphere, "sphere"}};

std::string shown(double value, double least = 1e-6) {
    char text[32];
    if (std::abs(value) < least)
        std::snprintf(text, sizeof text, "below %.0e", least);
    else
        std::snprintf(text, sizeof text, "%.2g", value);
    return text;
}

// u = s |s|: dense at the terminator.
std::vector<double> cosines(int count) {
    std::vector<double> all;
    for (int i = 0; i < count; ++i) {
        const double s = -1 + 2 * (i + 0.5) / count;
        all.push_back(s * std::abs(s));
    }
    return all;
}

void formsTable() {
    std::puts("<!-- figures: forms -->");
    std::puts(
        "| r, mm | form | from a sphere | from a cylinder by chords | from a cylinder by arcs | energy, red "
        "| green | blue |");
    std::puts("|---|---|---|---|---|---|---|---|");
    const auto skin = skinProfile();
    constexpr int count = 400;
    for (double r : {1.0, 3.0, 10.0, 100.0})
        for (const auto& [form, name] : forms) {
            double sphere = 0, chords = 0, arcs = 0, energy[3] = {};
            for (double u : cosines(count)) {
                const Rgb d = curvatureD(form, *skin, u, r);
                sphere = std::max(sphere, std::abs(d.x - curvatureD(Form::sphere, *skin, u, r).x));
                chords = std::max(chords, std::abs(d.x - curvatureD(Form::pennerRing, *skin, u, r).x));
                arcs = std::max(arcs, std::abs(d.x - curvatureD(Form::arc, *skin, u, r, 1e9).x));
                for (int c = 0; c < 3; ++c) energy[c] += d[c] * 2 * std::sqrt(std::abs(u)) / count;
            }
            std::printf("| %g | `%s` | %s | %s | %s |", r, name, shown(sphere).c_str(), shown(chords).c_str(),
                        shown(arcs).c_str());
            for (double e : energy) std::printf(" %s |", shown(e - 0.25, 5e-6).c_str());
            std::puts("");
        }
    std::puts("<!-- figures end -->");
}

// A root table of 64x64 for 2.7 mm and r = 1 to 100 mm, read for another radius: what clamping at its end
// costs at r = 1 mm.
void clampTable() {
    std::puts("<!-- figures: clamp -->");
    std::puts(
        "| radius of the material | the table ends at r = | largest error at r = 1 mm, `arc` | `sphere` |");
    std::puts("|---|---|---|---|");
    for (double radius : {4.05, 5.4}) {
        const auto stretched = profileForRadius(skinProfile(), radius), skin = skinProfile();
        double worst[2] = {};
        for (double u : cosines(400))
            for (int f = 0; f < 2; ++f) {
                const Form form = f ? Form::sphere : Form::arc;
                const Rgb truth = curvatureD(form, *stretched, u, 1), read = curvatureD(form, *skin, u, 1);
                for (int c = 0; c < 3; ++c) worst[f] = std::max(worst[f], std::abs(truth[c] - read[c]));
            }
        std::printf("| %g mm | %g mm | %.3f | %.3f |\n", radius, radius / 2.7, worst[0], worst[1]);
    }
    std::puts("<!-- figures end -->");
}

// Bilinear look-ups at even random points of (N.L, curvature) within what look-ups reach, and with the half
// texel beyond it.
void linearTable() {
    std::puts("<!-- figures: linear -->");
    std::puts(
        "| texels | points between the first and the last texel's centre: RMS, largest | points everywhere: "
        "RMS, largest |");
    std::puts("|---|---|---|");
    const auto skin = skinProfile();
    for (int side : {64, 512}) {
        double squares[2] = {}, worst[2] = {};
        int counted[2] = {};
        const CurvatureLutSpec spec{Form::arc, side, side, 1, 100};
        std::mt19937 random(5);
        std::uniform_real_distribution<double> even(0, 1);
        for (int i = 0; i < 1500; ++i) {
            const double x = even(random) * side - 0.5, y = even(random) * side - 0.5;
            const double cx = std::clamp(x, 0.0, side - 1.0), cy = std::clamp(y, 0.0, side - 1.0);
            const int x0 = std::min(int(cx), side - 2), y0 = std::min(int(cy), side - 2);
            const double fx = cx - x0, fy = cy - y0;
            const double least = 1 / spec.radiusMax, most = 1 / spec.radiusMin;
            const Rgb truth = curvatureD(Form::arc, *skin, -1 + (x + 0.5) * 2 / side,
                                         1 / (least + (y + 0.5) * (most - least) / side));
            const auto texel = [&](int a, int b) { return curvatureTexel(spec, *skin, x0 + a, y0 + b); };
            const Rgb value = (1 - fy) * ((1 - fx) * texel(0, 0) + fx * texel(1, 0)) +
                              fy * ((1 - fx) * texel(0, 1) + fx * texel(1, 1));
            const bool inside = cx == x && cy == y;
            for (int set = inside ? 0 : 1; set < 2; ++set)
                for (int c = 0; c < 3; ++c) {
                    const double error = std::abs(value[c] - truth[c]);
                    squares[set] += error * error;
                    worst[set] = std::max(worst[set], error);
                    ++counted[set];
                }
        }
        std::printf("| %dx%d | %.1e, %.1e | %.1e, %.1e |\n", side, side, std::sqrt(squares[0] / counted[0]),
                    worst[0], std::sqrt(squares[1] / counted[1]), worst[1]);
    }
    std::puts("<!-- figures end -->");
}

// The polynomial of the nine harmonics' shapes, scaled to a range of 1 over the sphere.
double harmonic(const std::array<double, 9>& h, Vec3 n) {
    return h[0] + h[1] * n.y + h[2] * n.z + h[3] * n.x + h[4] * n.x * n.y + h[5] * n.y * n.z +
           h[6] * (3 * n.z * n.z - 1) + h[7] * n.x * n.z + h[8] * (n.x * n.x - n.y * n.y);
}

void cubeTable() {
    std::puts("<!-- figures: cubes -->");
    std::puts("| texels along an edge | largest error of 20 functions of range 1 |");
    std::puts("|---|---|");
    std::vector<Vec3> directions;
    for (int i = 0; i < 20000; ++i) {  // a Fibonacci spiral: even over the sphere
        const double z = 1 - 2 * (i + 0.5) / 20000, angle = i * pi * (3 - std::sqrt(5.0)),
                     q = std::sqrt(1 - z * z);
        directions.push_back({q * std::cos(angle), q * std::sin(angle), z});
    }
    for (int size : {8, 16, 32}) {
        double worst = 0;
        std::mt19937 random(3);
        for (int k = 0; k < 20; ++k) {
            std::array<double, 9> h;
            for (double& v : h) v = std::uniform_real_distribution<double>(-1, 1)(random);
            double low = 1e9, high = -1e9;
            for (const Vec3& n : directions)
                low = std::min(low, harmonic(h, n)), high = std::max(high, harmonic(h, n));
            const auto value = [&](Vec3 n) { return (harmonic(h, n) - low) / (high - low); };
            CubeMap cube{size, {}};
            for (int face = 0; face < 6; ++face)
                for (int y = 0; y < size; ++y)
                    for (int x = 0; x < size; ++x) {
                        const Vec3 n = normalized(
                            cubeDirection(face, -1 + (x + 0.5) * 2 / size, -1 + (y + 0.5) * 2 / size));
                        cube.texels.push_back(value(n) * Rgb{1, 1, 1});
                    }
            for (const Vec3& n : directions)
                worst = std::max(worst, std::abs(sampleCube(cube, n).x - value(n)));
        }
        std::printf("| %d | %.2g |\n", size, worst);
    }
    std::puts("<!-- figures end -->");
}

}  // namespace

int main() {
    formsTable();
    clampTable();
    linearTable();
    cubeTable();
}
