#include "demo/dress_gbuffer.h"

#include <algorithm>

namespace pellucid::demo {
namespace {

using sample::GBuffer, sample::Vec3, sample::LinearColor;

// From the line where an eye meets a lid, mm.
constexpr double wetReach = 0.9, lidReach = 1.4;
constexpr int window = 11;  // pixels; of a head in 2160 lines they are 0.13 mm wide

bool isEye(uint32_t id) {
    return id == DEMO_EYES || id == DEMO_RIGHT_EYE;
}

// The distance of a pixel from the lids, mostly across the view: lids are in front of the ball.
double apart(Vec3 way) {
    return length(Vec3{way.x, way.y, 0.3 * way.z});
}

void multiply(GBuffer& g, int x, int y, LinearColor factor, double share) {
    for (int c = 0; c < 3; ++c) g.albedo.at(c, x, y) *= float(1 + share * (factor[size_t(c)] - 1));
}

// The pixels around the place (x, y).
template <class Use>
void around(const GBuffer& g, int x, int y, Use&& use) {
    for (int v = std::max(y - window, 0); v <= std::min(y + window, g.height - 1); ++v)
        for (int u = std::max(x - window, 0); u <= std::min(x + window, g.width - 1); ++u) use(u, v);
}

// `way`: to the eye.
void setMargin(GBuffer& g, int x, int y, Vec3 way, Vec3 up, double share) {
    const bool upperLid = dot(way, up) < -0.3 * apart(way);
    multiply(g, x, y, upperLid ? LinearColor{0.45, 0.35, 0.33} : LinearColor{0.97, 0.72, 0.71}, share);
    g.specular.at(0, x, y) *= float(1 + share);
    g.roughness.at(0, x, y) *= float(1 - 0.5 * share);
}

}  // namespace

std::vector<float> dressEyes(GBuffer& g, Vec3 up) {
    std::vector<float> wet(g.material.size());
    const std::vector<uint32_t> ids = g.material;
    const auto index = [&](int x, int y) { return size_t(y) * size_t(g.width) + size_t(x); };
    std::vector<char> near(ids.size());
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x)
            if (isEye(ids[index(x, y)])) around(g, x, y, [&](int u, int v) { near[index(u, v)] = 1; });
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            const size_t i = index(x, y);
            const bool eye = isEye(ids[i]);
            if (!near[i] || !(eye || ids[i] == DEMO_SKIN)) continue;
            // The way to the nearest of skin, or of the eye.
            const Vec3 from = sample::vectorAt(g.position, x, y);
            Vec3 way{INFINITY, 0, 0};
            around(g, x, y, [&](int u, int v) {
                const uint32_t other = ids[index(u, v)];
                if (eye ? other != DEMO_SKIN : !isEye(other)) return;
                const Vec3 d = sample::vectorAt(g.position, u, v) - from;
                if (apart(d) < apart(way)) way = d;
            });
            const double distance = apart(way), share = 1 - distance / lidReach;
            if (share <= 0) continue;
            wet[i] = float(eye ? std::max(0.0, 1 - distance / wetReach) : std::min(1.0, 1.5 * share));
            if (!eye) setMargin(g, x, y, way, up, wet[i]);
        }
    return wet;
}

void darkenFolds(GBuffer& g, const sample::Image& occlusion, const std::vector<float>& wetness) {
    constexpr double open = 0.9, reach = 1.2;  // of the sky; mm, over which the edges of folds are soft
    sample::Image dark(g.width, g.height, 1);
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            const double seen = std::min(1.0, occlusion.at(0, x, y) / open);
            dark.at(0, x, y) = float(1 - seen * seen * (3 - 2 * seen));
        }
    const auto spread = [&](int x, int y, int fromX, int fromY) {
        if (fromX < 0 || fromY < 0 || fromX >= g.width || fromY >= g.height) return;
        const Vec3 way = sample::vectorAt(g.position, x, y) - sample::vectorAt(g.position, fromX, fromY);
        dark.at(0, x, y) = std::max(dark.at(0, x, y), dark.at(0, fromX, fromY) - float(length(way) / reach));
    };
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) spread(x, y, x - 1, y), spread(x, y, x, y - 1);
    for (int y = g.height - 1; y >= 0; --y)
        for (int x = g.width - 1; x >= 0; --x) spread(x, y, x + 1, y), spread(x, y, x, y + 1);
    for (int y = 0; y < g.height; ++y)
        for (int x = 0; x < g.width; ++x) {
            const size_t i = size_t(y) * size_t(g.width) + size_t(x);
            if (isEye(g.material[i])) continue;
            const float share = dark.at(0, x, y) * (1 - 0.5f * wetness[i]);
            multiply(g, x, y, {0.05, 0.05, 0.06}, share);
            g.specular.at(0, x, y) *= 1 - share;
        }
}

}  // namespace pellucid::demo
