#include "reference/diffusion_light.h"

namespace reference {
namespace {

// Constants of the definition.
constexpr double ownWindow = 2, ownCosine = 0.4;       // width in quarters of a texel; smallest cosine
constexpr double shownWindow = 1, shownCosine = 0.35;  // width in texels; smallest cosine
constexpr double leastCosine = 0.1;                    // smallest cosine to the light
constexpr double stepOverTexel = 2;                    // weight of the squared step between pixels
// Deviation of the accumulated weight of the pixels from its window; three times as much: pixels do not
// count.
constexpr double weightOff = 0.1;
// Difference that does not matter, relative to light at normal incidence; twice as much matters fully.
constexpr double agree = 0.02;
// Relative deviation of the weight from that of a plane that is corrected; twice as much is not.
constexpr double nearlyPlane = 0.03;
constexpr double longestSlope = 10;  // largest area of a texel's surface over its area across the light
constexpr double pointsWithin = 3;   // nearer than this many lengths, a texel is several points
constexpr int pointsAcross = 4;

Vec3 rowOf(const Matrix4& m, int r) {
    return {m[size_t(r)][0], m[size_t(r)][1], m[size_t(r)][2]};
}

// The point that is seen at (u, v, depth).
Vec3 pointAt(const LightDepths& map, const MappedLight& light, double u, double v, double depth) {
    if (map.face >= 0) {
        const Vec3 d = cubeDirection(map.face, 2 * u - 1, 2 * v - 1);
        const double along = map.decoding.distance(depth) / (map.radial ? length(d) : 1);
        return light.position + along * d;
    }
    const Matrix4& m = map.worldToShadow;
    const double at[] = {u, v, depth};
    Vec3 rows[3], right;
    for (int r = 0; r < 3; ++r) {
        rows[r] = rowOf(m, r) - at[r] * rowOf(m, 3);
        right[r] = at[r] * m[3][3] - m[r][3];
    }
    return solved(rows[0], rows[1], rows[2], right);
}

// The area across the light, at `p`, of a beam through 1 in u and 1 in v; by a unit of strength: of
// directional light it is an area, of others a solid angle.
double beam(const LightDepths& map, const MappedLight& light, Vec3 p) {
    if (map.face >= 0) {
        const Vec3 d = p - light.position;
        const double axis = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
        return 4 * std::pow(axis / length(d), 3);
    }
    const Matrix4& m = map.worldToShadow;
    const Vec3 u = rowOf(m, 0), v = rowOf(m, 1), w = rowOf(m, 3);
    if (light.directional) return m[3][3] * m[3][3] / std::abs(dot(cross(u, v), light.toLight));
    const Vec3 d = normalized(p - light.position);
    return std::pow(dot(w, d), 3) / std::abs(determinant(u, v, w));
}

double strength(const MappedLight& light, Vec3 p) {
    if (!light.spot) return 1;
    const double cosine = dot(normalized(p - light.position), light.spotDirection);
    return smoothstep01(saturate((cosine - light.cosOuter) / (light.cosInner - light.cosOuter)));
}

bool holds(const LightDepths& map, Vec3 p) {
    const Vec3 at = shadowCoordinates(map.worldToShadow, p, {}, 0);
    return at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1 && at.z >= 0 && at.z <= 1;
}

// The share of a cascade's texel, at its depth, that no finer cascade holds.
double shareBeyond(const MappedLight& light, size_t k, int x, int y) {
    const LightDepths& map = light.maps[k];
    const double depth = map.depth[size_t(y) * size_t(map.width) + size_t(x)];
    const auto beyond = [&](double right, double down) {
        const Vec3 p = pointAt(map, light, (x + right) / map.width, (y + down) / map.height, depth);
        return std::none_of(light.maps.begin(), light.maps.begin() + std::ptrdiff_t(k),
                            [&](const LightDepths& finer) { return holds(finer, p); });
    };
    const int corners = beyond(0, 0) + beyond(0, 1) + beyond(1, 0) + beyond(1, 1);
    if (corners % 4 == 0) return corners / 4;  // no border crosses the texel
    constexpr int steps = 24;
    int count = 0;
    for (int i = 0; i < steps * steps; ++i)
        count += beyond((i % steps + 0.5) / steps, (i / steps + 0.5) / steps);
    return double(count) / (steps * steps);
}

// The longer side of a texel across the light, where it shines on `p`.
double texelLength(const LightDepths& map, const MappedLight& light, Vec3 p) {
    if (map.face >= 0) {
        const CubeFace& face = cubeFaces[map.face];
        return 2 * dot(p - light.position, face.out) / map.width;
    }
    const Matrix4& m = map.worldToShadow;
    const Vec3 forward = rowOf(m, 3);
    const double along = dot(forward, forward);
    double longest = 0;
    for (int r = 0; r < 2; ++r) {
        Vec3 row = rowOf(m, r);
        if (along > 0) row = row - (dot(row, forward) / along) * forward;
        longest = std::max(longest, 1 / (length(row) * (r ? map.height : map.width)));
    }
    return longest * (dot(forward, p) + m[3][3]);
}

// The shorter of the steps to two places. A step that is NaN or Inf is left out.
Vec3 shorter(Vec3 p, Vec3 a, Vec3 b) {
    const Vec3 toA = a - p, toB = b - p;
    if (!std::isfinite(length(toA))) return toB;
    if (!std::isfinite(length(toB))) return toA;
    return length(toA) <= length(toB) ? toA : toB;
}

// The way from texel to texel: the mean of those on both sides where one is less than twice the other.
Vec3 stepOf(Vec3 p, Vec3 before, Vec3 after) {
    const double back = length(before - p), on = length(after - p);
    const bool alike = std::max(back, on) < 2 * std::min(back, on);  // false if one is NaN
    return alike && std::isfinite(back + on) ? (after - before) / 2 : shorter(p, before, after);
}

double nearShare(double distance, double rho) {
    return saturate(2 - distance / rho);
}

// R cut at its reach, and scaled so that its integral is 1.
class Cut {
  public:
    explicit Cut(const Profile& profile)
        : profile_(profile), reach_(scatterReach(profile)), all_(enclosedEnergy(profile, reach_)) {}
    Rgb radial(double distance) const {
        if (distance >= reach_) return {};
        return profile_.radial(distance) / all_;
    }
    Rgb within(double distance) const { return enclosedEnergy(profile_, std::min(distance, reach_)) / all_; }

  private:
    const Profile& profile_;
    double reach_;
    Rgb all_;
};

// The share of the light that comes from within the window, on a plane: g falls evenly from rho to 2 rho.
Rgb shareOfWindow(const Cut& profile, double rho) {
    constexpr int steps = 16;
    Rgb sum;
    for (int k = 0; k < steps; ++k) sum = sum + profile.within(rho * (1 + (k + 0.5) / steps));
    return sum / steps;
}

// The factor that corrects light with this accumulated weight for the weight of a plane.
double planeLike(double weight, double plane) {
    if (!(weight > 0.1 * plane)) return 1;
    const double off = weight / plane - 1, trust = saturate(2 - std::abs(off) / nearlyPlane);
    return (1 + off * (1 - trust)) / (1 + off);
}

// Blend weight of the pixels' mean against the texels, for one channel.
double trustInPixels(double byPixels, double byTexels, double weight, double window, double cosine,
                     double texel, double step) {
    const double finer = texel * texel / (texel * texel + stepOverTexel * step * step),
                 whole = saturate(1.5 - std::abs(weight / window - 1) / (2 * weightOff)),
                 most = std::max(byPixels, byTexels),
                 apart = most > 0 ? std::abs(byPixels - byTexels) * cosine / most : 0;
    return std::max(saturate(2 - apart / agree), finer * whole);
}

// Lit surface: what one texel shows.
struct LitTexel {
    Vec3 position;
    double flux;       // irradiance times area, over the light's colour
    double extent;     // area
    Vec3 right, down;  // its sides
};

std::vector<LitTexel> litTexels(const MappedLight& light) {
    std::vector<LitTexel> all;
    for (size_t k = 0; k < light.maps.size(); ++k) {
        const LightDepths& map = light.maps[k];
        const auto place = [&](int x, int y, int depthX, int depthY) {
            const int column = std::clamp(depthX, 0, map.width - 1),
                      row = std::clamp(depthY, 0, map.height - 1);
            const double depth = map.depth[size_t(row) * size_t(map.width) + size_t(column)];
            return pointAt(map, light, (x + 0.5) / map.width, (y + 0.5) / map.height, depth);
        };
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x) {
                const Vec3 p = place(x, y, x, y);
                if (!std::isfinite(length(p))) continue;
                const double share = k > 0 && map.face < 0 ? shareBeyond(light, k, x, y) : 1;
                if (share <= 0) continue;
                const double texel = share * beam(map, light, p) / (double(map.width) * map.height);
                const Vec3 from = light.position - p;
                const double across = light.directional ? texel : texel * dot(from, from);
                const Vec3 right = stepOf(p, place(x - 1, y, x - 1, y), place(x + 1, y, x + 1, y)),
                           down = stepOf(p, place(x, y - 1, x, y - 1), place(x, y + 1, x, y + 1));
                const double area = length(cross(right, down)), farthest = longestSlope * std::sqrt(across);
                const auto side = [&](Vec3 v) { return length(v) < farthest ? v : Vec3{}; };
                all.push_back({p, strength(light, p) * texel,
                               std::min(std::isfinite(area) ? area : across, longestSlope * across),
                               side(right), side(down)});
            }
    }
    return all;
}

}  // namespace

std::vector<Rgb> scatterFromLights(const ScatterPicture& p, const std::vector<MappedLight>& lights,
                                   const Profile& whole) {
    const Cut profile(whole);
    std::vector<std::vector<LitTexel>> texels;
    for (const MappedLight& light : lights) texels.push_back(litTexels(light));
    std::vector<double> areas(p.positions.size());
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x)
            if (p.ids[p.at(x, y)]) areas[p.at(x, y)] = surfaceArea(p, x, y);
    std::vector<Rgb> result = p.irradiance;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            const size_t i = p.at(x, y);
            if (!(areas[i] > 0)) continue;
            const Vec3 here = p.positions[i];
            const Vec3 right = shorterStep(p, x, y, 1, 0).value_or(Vec3{}),
                       down = shorterStep(p, x, y, 0, 1).value_or(Vec3{}), across = cross(right, down),
                       normal = across / std::max(length(across), 1e-300);
            const double step = std::max(length(right), length(down));
            double rho = 0, own = 0, texel = 0, steepest = 1;
            for (const MappedLight& light : lights) {
                const Vec3 toLight = light.directional ? light.toLight : normalized(light.position - here);
                const double cosine = std::abs(dot(normal, toLight));
                steepest = std::min(steepest, std::max(cosine, leastCosine));
                for (const LightDepths& map : light.maps) {
                    const double length = texelLength(map, light, here);
                    if (!(length > 0)) continue;
                    rho = std::max(rho, shownWindow * length / std::max(cosine, shownCosine));
                    own = std::max(own, ownWindow / pointsAcross * length / std::max(cosine, ownCosine));
                    texel = std::max(texel, length / std::max(cosine, leastCosine));
                }
            }
            rho = std::max(rho, own);
            const Rgb within = shareOfWindow(profile, rho), withinOwn = shareOfWindow(profile, own),
                      lit = p.irradiance[i];
            Rgb far, between, asPlane;
            for (size_t k = 0; k < lights.size(); ++k) {
                Rgb beyond, light, weight;
                for (const LitTexel& t : texels[k]) {
                    if (!(t.flux > 0)) continue;
                    const Vec3 d = t.position - here;
                    const double longest = std::max(length(t.right), length(t.down));
                    const int n = length(d) < pointsWithin * longest ? pointsAcross : 1;
                    for (int v = 0; v < n; ++v)
                        for (int u = 0; u < n; ++u) {
                            const double distance = length(d + ((u + 0.5) / n - 0.5) * t.right +
                                                           ((v + 0.5) / n - 0.5) * t.down),
                                         g = nearShare(distance, rho), ring = g - nearShare(distance, own);
                            if (distance <= own) continue;
                            const Rgb density = profile.radial(distance) / (n * n);
                            beyond = beyond + (1 - g) * t.flux * density;
                            light = light + ring * t.flux * density;
                            weight = weight + ring * t.extent * density;
                        }
                }
                far = far + lights[k].color * beyond;
                between = between + lights[k].color * light;
                for (int c = 0; c < 3; ++c)
                    asPlane[c] +=
                        lights[k].color[c] * light[c] * planeLike(weight[c], within[c] - withinOwn[c]);
            }
            // Near: the mean of what pixels show.
            const Rgb self = profile.within(std::sqrt(areas[i] / pi));
            Rgb weights = self, near = self * lit;
            for (size_t j = 0; j < p.positions.size(); ++j) {
                if (j == i || !(areas[j] > 0) || p.ids[j] != p.ids[i]) continue;
                const double distance = length(p.positions[j] - here), share = nearShare(distance, rho);
                if (!(share > 0)) continue;
                const Rgb weight = share * areas[j] * profile.radial(distance);
                weights = weights + weight;
                near = near + weight * p.irradiance[j];
            }
            for (int c = 0; c < 3; ++c) {
                const double byPixels = within[c] * (weights[c] > 0 ? near[c] / weights[c] : lit[c]),
                             byTexels = withinOwn[c] * lit[c] + asPlane[c];
                result[i][c] =
                    far[c] + withinOwn[c] * lit[c] + between[c] +
                    trustInPixels(byPixels, byTexels, weights[c], within[c], steepest, texel, step) *
                        (byPixels - byTexels);
            }
        }
    return result;
}

}  // namespace reference
