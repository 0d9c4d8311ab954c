// Writes docs/stability.md: for each operation the range of inputs tried and the worst error that a directed
// search found against the double-precision oracle. Run: build/release/bin/stability docs/stability.md
// [seconds per operation [name: only operations that have it in theirs]]. Simple (1+1) evolution: a point of the unit cube stands for the
// inputs; steps grow on success and shrink on failure [Rechenberg 1973].
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "stability.h"

using namespace stability;

namespace {

struct Found {
    double random = 0, worst = 0;  // after three tenths of the time, drawn blindly; after all
    int evaluations = 0;
    std::string where;
};

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Found search(const Operation& operation, double budget) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    Found found;  // a NaN is the worst of all, and stays
    const double start = seconds();
    Point at(operation.dimensions), best;
    double bestError = -1, step = 0.2;
    const auto evaluate = [&](const Point& p) {
        std::string where;
        const double e = operation.error(p, where);
        ++found.evaluations;
        if (std::isnan(e) || e > found.worst) found.worst = e, found.where = where;
        return e;
    };
    while (seconds() - start < 0.3 * budget || found.evaluations < 4) {
        for (double& x : at) x = uniform(random);
        const double e = evaluate(at);
        if (!(e <= bestError)) bestError = e, best = at;
    }
    found.random = found.worst;
    while (seconds() - start < budget) {
        at = best;
        for (double& x : at) x = std::clamp(x + step * normal(random), 0.0, 1.0);
        const double e = evaluate(at);
        if (!(e <= bestError))
            bestError = e, best = at, step = std::min(0.5, 1.5 * step);
        else
            step = std::max(1e-4, 0.9 * step);
    }
    return found;
}

constexpr const char* before = R"(# Numerical stability

Written by `bench/stability.cpp` (`build/release/bin/stability docs/stability.md`). The worst error that a directed search found against the
double-precision oracle of the tests: points of the range are drawn blindly for three tenths of the time, then the worst one is
moved about by an evolution strategy as long as the time lasts.

)";
constexpr const char* after = R"(
"Drawn" is the worst of the blind part: where the search gains much over it, random tests would have missed the place.

## What float32 allows

- **Meshes.** Edges are differences of positions. A mesh that lies D sizes away from the origin has positions with D times the rounding
  error, 6e-8 D of its size, and edges of 1/n of its size have lost n D of their digits before Pellucid sees them; the oracle above
  gets the same rounded positions, so that the figures are the library's own error, not that loss. Scale by itself costs nothing
  between 1e-6 and 1e6.
- **The quadric estimator** decides where to believe a normal and which points are too far; a vertex within 1e-4 of such a threshold may be
  decided otherwise in float, and is not compared.
- **Curvature from a G-buffer** is a ratio of differences between neighbouring pixels: the finer the pixels and the further the surface from
  the origin, the fewer digits are left. All its worst points lie at the far end of the range.
- **Wide shadows** divide small depth differences by the filter's width and the bias: the smallest of both are the worst.
- **Tables.** A texel is a sum of at most a few hundred terms of one sign each; errors stay within some units in the last place of 1, thirty for rings.
  What limits a look-up is the table's resolution, not its values.
- **Shading.** Sums of a few terms of order one: 1e-6. Sharp speculars multiply the error of the half vector by 1/m^2, so that relative
  error grows as roughness falls; thickness subtracts two depths, and inherits the shadow map's own steps.

## NaN and Inf

| operation | input | result |
|---|---|---|
| curvature, normals | position NaN or Inf | 0 at that vertex; edges and triangles to it are skipped, neighbours use what is left; counted in the report |
| curvature | normal NaN, Inf or zero | likewise |
| curvature, normals | zero-length edges, repeated indices, unreferenced vertices | skipped, 0 where nothing is left; counted |
| curvature from a G-buffer | normal or position NaN or Inf, id 0 | 0 at that pixel; no neighbour uses it |
| blurred normals, wide shadow | NaN or Inf in any image of a pixel | that pixel is `invalidColor`; blurred normals of its neighbours leave it out |
| wide shadow | shadow map texel NaN or Inf | throws no shadow |
| UV scale | triangles too small to measure | skipped; an error when none is left |
| tables, profiles | NaN, Inf or out of range in a description | refused with PEL_ERROR_INVALID_ARGUMENT, which names the field |
| shading | NaN or Inf in any image of a pixel | that pixel is `invalidColor` (0 by default) and counted; no neighbour changes |
| shading | shadow map texel NaN | no thickness from that tap |
| shading | NaN or Inf in a light, material, matrix or camera | refused, with the name of the field |
)";

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: stability OUT.md [SECONDS [NAME]]\n"), 2;
    const double budget = argc > 2 ? std::atof(argv[2]) : 20;
    std::vector<Operation> operations;
    for (const auto& some : {tableOperations(), meshOperations(), imageOperations()})
        operations.insert(operations.end(), some.begin(), some.end());
    const PelDeviceInfo info = device().info();
    std::string out = before;
    out += std::string("Device: ") + info.name + ", " + info.platform + " " + info.driver + "; " +
           text("%.0f", budget) +
           " seconds an operation.\n\n| operation | inputs tried | evaluations | drawn | found | error is | "
           "where |\n|---|---|---|---|---|---|---|\n";
    for (const Operation& operation : operations) {
        if (argc > 3 && operation.name.find(argv[3]) == std::string::npos) continue;
        const Found found = search(operation, budget);
        std::fprintf(stderr, "%s: %.2g, drawn %.2g, %d evaluations\n", operation.name.c_str(), found.worst,
                     found.random, found.evaluations);
        out += "| " + operation.name + " | " + operation.range + " | " + std::to_string(found.evaluations) +
               " | " + text("%.1e", found.random) + " | " + text("%.1e", found.worst) + " | " +
               operation.unit + " | " + found.where + " |\n";
    }
    out += after;
    FILE* file = std::fopen(argv[1], "w");
    if (!file || std::fputs(out.c_str(), file) < 0 || std::fclose(file) != 0) return std::perror(argv[1]), 1;
}
