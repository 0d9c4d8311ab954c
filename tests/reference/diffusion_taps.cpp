#include "reference/diffusion_taps.h"

#include <functional>

namespace reference {
namespace {

constexpr double mostGain = 8, leastViewCosine = 0.25, alike = 16;

// The integral of a density from 0 on, as a table; 1 at `end`. By Gauss' rule of two points in each step.
class Rising {
  public:
    Rising(double end, const std::function<Rgb(double)>& density) : end_(end), values_{Rgb{}} {
        for (int i = 0; i < count; ++i) {
            const double middle = (at(i) + at(i + 1)) / 2, half = (at(i + 1) - at(i)) / 2;
            const Rgb sum = density(middle - half / std::sqrt(3.0)) + density(middle + half / std::sqrt(3.0));
            values_.push_back(values_.back() + half * sum);
        }
        const Rgb all = values_.back();
        for (Rgb& v : values_) v = v / all;
    }
    Rgb value(double x) const {
        const double t = std::cbrt(std::clamp(x / end_, 0.0, 1.0)) * count;
        const int i = std::min(int(t), count - 1);
        const double f = (x - at(i)) / (at(i + 1) - at(i));
        return (1 - f) * values_[i] + f * values_[i + 1];
    }
    double mean(double x) const {
        const Rgb v = value(x);
        return (v.x + v.y + v.z) / 3;
    }

  private:
    static constexpr int count = 3000;
    double at(int i) const { return end_ * std::pow(double(i) / count, 3); }
    double end_;
    std::vector<Rgb> values_;
};

struct Surface {
    Vec3 p;
    double area = 0, pixel = 0;
    bool there = false;
};

// Of a view along z; every pixel of a picture is as wide as high.
std::vector<Surface> surfaces(const ScatterPicture& s) {
    std::vector<Surface> all(s.positions.size());
    for (int y = 0; y < s.height; ++y)
        for (int x = 0; x < s.width; ++x) {
            Surface& here = all[s.at(x, y)];
            if (!(here.there = sound(s, s.at(x, y)))) continue;
            here.p = s.positions[s.at(x, y)];
            for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
                const Vec3 step = shorterStep(s, x, y, dx, dy).value_or(Vec3{});
                here.pixel = std::max(here.pixel, std::hypot(step.x, step.y));
            }
            here.area = std::min(surfaceArea(s, x, y), here.pixel * here.pixel / leastViewCosine);
        }
    return all;
}

double at(const std::vector<double>& values, size_t i) {
    return values.empty() ? 1 : values[i];
}

// Light on a plane from within a distance, of that from within the reach.
Rising enclosedLight(const Profile& profile) {
    return Rising(scatterReach(profile), [&](double r) { return 2 * pi * r * profile.radial(r); });
}

Rgb ratio(Rgb a, Rgb b, double gain) {
    Rgb r;
    for (int c = 0; c < 3; ++c) r[c] = b[c] > 0 ? std::min(a[c] / b[c], mostGain) * gain : 0;
    return r;
}

Rgb mixed(const TapScene& s, size_t i, Rgb light, Rgb weight) {
    const Rgb own = s.picture.irradiance[i];
    Rgb result;
    for (int c = 0; c < 3; ++c)
        result[c] = own[c] + at(s.weights, i) * ((weight[c] > 0 ? light[c] / weight[c] : own[c]) - own[c]);
    return result;
}

// Light from within a disk as large as the pixel.
Rgb lightWithin(const TapScene& s, const Rising& light, const Surface& surface, size_t i) {
    return light.value(surface.pixel / std::sqrt(pi) / at(s.radii, i)) * s.picture.irradiance[i];
}

bool gathers(const TapScene& s, const std::vector<Surface>& all, size_t i) {
    return all[i].there && all[i].pixel > 0 && at(s.radii, i) > 0 && at(s.weights, i) > 0;
}

// Whether another pixel gathers, and is on the surface of this one.
bool sameSurface(const TapScene& s, const std::vector<Surface>& all, size_t here, size_t there) {
    const double apart = length(all[there].p - all[here].p);
    return gathers(s, all, there) && s.picture.ids[there] == s.picture.ids[here] &&
           apart * apart <= alike * std::max(all[here].area, all[there].area);
}

}  // namespace

std::vector<Rgb> scatterOnDisk(const TapScene& s, const Profile& profile) {
    const ScatterPicture& picture = s.picture;
    const double reach = scatterReach(profile);
    const Rising light = enclosedLight(profile);
    const auto quantile = [&](double part) {
        return bisected(0, reach, [&](double r) {
            const Rgb v = light.value(r);
            return std::min({v.x, v.y, v.z}) < part;
        });
    };
    std::vector<double> ends{0};
    for (int i = 1; i < s.taps; ++i) ends.push_back(quantile(double(i) / s.taps));
    ends.push_back(reach);
    const std::vector<Surface> all = surfaces(picture);
    std::vector<Rgb> result = picture.irradiance;
    for (int set = 0; set < 4; ++set) {
        std::vector<double> radii;
        for (int i = 0; i < s.taps; ++i) radii.push_back(quantile((i + (set + 0.5) / 4) / s.taps));
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const int column = x / s.rate, row = y / s.rate;
                if ((column % 2 + 2 * (row % 2) + s.frame) % 4 != set) continue;
                const size_t here = picture.at(x, y);
                const Surface& own = all[here];
                const double wide = at(s.radii, here);
                if (!own.there || !(own.pixel > 0) || !(wide > 0)) continue;
                const uint32_t turn = uint32_t(column) * 3242174889u + uint32_t(row) * 2447445414u +
                                      uint32_t(s.frame) * 2654435769u;
                Rgb sum{}, weights{};
                for (int i = 0; i < s.taps; ++i) {
                    const double angle = pi * (3 - std::sqrt(5.0)) * i + 2 * pi * turn / 4294967296.0;
                    const int dx = int(std::floor(wide * radii[i] * std::cos(angle) / own.pixel + 0.5)),
                              dy = int(std::floor(wide * radii[i] * std::sin(angle) / own.pixel + 0.5));
                    const Rgb share = light.value(ends[i + 1]) - light.value(ends[i]);
                    const int u = x + dx, v = y + dy;
                    Rgb brings = share, e = picture.irradiance[here];
                    if (picture.holds(u, v) && (dx || dy) && all[picture.at(u, v)].there) {
                        const size_t there = picture.at(u, v);
                        const Rgb flows = picture.ids[there] == picture.ids[here] ? Rgb{1, 1, 1} : s.border;
                        const double stretch =
                            length(all[there].p - own.p) / (std::hypot(dx, dy) * own.pixel);
                        Rgb gain = ratio(profile.radial(radii[i] * stretch), profile.radial(radii[i]),
                                         all[there].area / (own.pixel * own.pixel));
                        if (radii[i] * stretch > reach) gain = Rgb{};
                        for (int c = 0; c < 3; ++c)
                            if (flows[c] > 0)
                                brings[c] *= flows[c] * gain[c], e[c] = picture.irradiance[there][c];
                    }
                    sum = sum + brings * e;
                    weights = weights + brings;
                }
                result[here] = mixed(s, here, sum, weights);
            }
    }
    return result;
}

std::vector<std::optional<Rgb>> betweenSamples(const TapScene& s, const Profile& profile,
                                               const std::vector<Rgb>& gathered) {
    const ScatterPicture& picture = s.picture;
    const Rising light = enclosedLight(profile);
    const std::vector<Surface> all = surfaces(picture);
    const auto ownLight = [&](size_t i) { return lightWithin(s, light, all[i], i); };
    std::vector<std::optional<Rgb>> result(all.size());
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const size_t here = picture.at(x, y);
            if (!gathers(s, all, here)) continue;
            Rgb sum{};
            int count = 0;
            for (int v = std::max(y - 1, 0); v <= std::min(y + 1, picture.height - 1); ++v)
                for (int u = std::max(x - 1, 0); u <= std::min(x + 1, picture.width - 1); ++u) {
                    const size_t there = picture.at(u, v);
                    const bool own = (x % 2 || u == x) && (y % 2 || v == y);
                    if (u % 2 || v % 2 || !own || !sameSurface(s, all, here, there)) continue;
                    const Rgb beyond = gathered[there] - ownLight(there);
                    for (int c = 0; c < 3; ++c) sum[c] += std::max(beyond[c], 0.0);
                    ++count;
                }
            if (count) result[here] = sum / double(count) + ownLight(here);
        }
    return result;
}

std::vector<Rgb> blendHistory(const TapScene& s, const Profile& profile, const std::vector<Rgb>& gathered,
                              const std::vector<Vec3>& motion, double weight,
                              std::vector<HistoryPixel>& history) {
    const ScatterPicture& picture = s.picture;
    const std::vector<Surface> all = surfaces(picture);
    const Rising profileLight = enclosedLight(profile);
    std::vector<Rgb> beyond(all.size());
    for (size_t i = 0; i < all.size(); ++i)
        if (gathers(s, all, i))
            beyond[i] = gathered[i] - (1 - at(s.weights, i)) * picture.irradiance[i] -
                        at(s.weights, i) * lightWithin(s, profileLight, all[i], i);
    std::vector<Rgb> result = gathered;
    std::vector<HistoryPixel> after(all.size());
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const size_t here = picture.at(x, y);
            if (!gathers(s, all, here)) continue;
            const double column = x + motion[here].x, row = y + motion[here].y,
                         distance = all[here].p.z + motion[here].z;
            Rgb earlier{};
            double found = 0;
            int frames = 0;
            const double left = std::floor(column), top = std::floor(row);
            for (double v : {top, top + 1})
                for (double u : {left, left + 1}) {
                    const double near = (1 - std::abs(column - u)) * (1 - std::abs(row - v));
                    const bool inside = u >= 0 && v >= 0 && u < picture.width && v < picture.height;
                    if (history.empty() || !inside || !(near > 0)) continue;
                    const HistoryPixel& before = history[picture.at(int(u), int(v))];
                    const double apart = before.distance - distance;
                    if (before.id != picture.ids[here] || !(apart * apart <= alike * all[here].area))
                        continue;
                    frames = found > 0 ? std::min(frames, before.frames) : before.frames;
                    earlier = earlier + near * before.light;
                    found += near;
                }
            Rgb light = beyond[here];
            for (int c = 0; found > 0 && c < 3; ++c) {
                double low = light[c], high = light[c], sum = 0, squares = 0, count = 0;
                std::optional<double> beside;
                for (int dy = -s.rate; dy <= s.rate; dy += s.rate)
                    for (int dx = -s.rate; dx <= s.rate; dx += s.rate) {
                        if (!picture.holds(x + dx, y + dy)) continue;
                        const size_t there = picture.at(x + dx, y + dy);
                        if (!sameSurface(s, all, here, there)) continue;
                        low = std::min(low, beyond[there][c]), high = std::max(high, beyond[there][c]);
                        const int u = x + dx + int(std::floor(motion[here].x + 0.5)),
                                  v = y + dy + int(std::floor(motion[here].y + 0.5));
                        if (!picture.holds(u, v) || history[picture.at(u, v)].id != picture.ids[here])
                            continue;
                        const double change = beyond[there][c] - history[picture.at(u, v)].light[c];
                        sum += change, squares += change * change, ++count;
                        // All pixels are read with the same offset from their exact positions as this one.
                        if (!dx && !dy) beside = history[picture.at(u, v)].light[c] - earlier[c] / found;
                    }
                const double mean = sum / count, change = mean + beside.value_or(-mean),
                             error2 = std::max(squares / count - mean * mean, 0.0) / count,
                             shift = change * change > 4 * error2 ? change - 4 * error2 / change : 0;
                light[c] += std::min(weight, frames / (frames + 1.0)) *
                            (std::clamp(earlier[c] / found + shift, low, high) - light[c]);
            }
            result[here] = gathered[here] + light - beyond[here];
            after[here] = {picture.ids[here], std::min(frames + 1, 31), light, all[here].p.z};
        }
    history = after;
    return result;
}

std::vector<Rgb> scatterSeparably(const TapScene& s, const Profile& profile) {
    const ScatterPicture& picture = s.picture;
    const double reach = scatterReach(profile);
    const Rising half(reach, [&](double s) { return profile.lineSpread(s); });
    // Half of the pieces by light, half by the root of length.
    std::vector<double> ends;
    for (int i = 0; i <= s.taps; ++i) {
        const double t = 2.0 * i / s.taps - 1;
        const auto below = [&](double x) { return (half.mean(x) + std::sqrt(x / reach)) / 2 < std::abs(t); };
        const bool outer = i == 0 || i == s.taps;
        ends.push_back(std::copysign(outer ? reach : bisected(0, reach, below), t));
    }
    const std::vector<Surface> all = surfaces(picture);
    const auto filtered = [&](const std::vector<Rgb>& from, int dx, int dy, bool weigh) {
        std::vector<Rgb> result = weigh ? picture.irradiance : from;
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x) {
                const size_t here = picture.at(x, y);
                const Surface& own = all[here];
                const double wide = at(s.radii, here);
                if (!own.there || !(own.pixel > 0) || !(wide > 0)) continue;
                Rgb sum{}, weights{};
                const auto add = [&](int k, double part, const Rgb& share, double middle) {
                    const int u = x + k * dx, v = y + k * dy;
                    Rgb brings = part * share, e = from[here];
                    if (k && picture.holds(u, v) && all[picture.at(u, v)].there) {
                        const size_t there = picture.at(u, v);
                        const Rgb flows = picture.ids[there] == picture.ids[here] ? Rgb{1, 1, 1} : s.border;
                        const double stretch = length(all[there].p - own.p) / (std::abs(k) * own.pixel);
                        const Rgb gain = std::abs(middle) * stretch > reach
                                             ? Rgb{}
                                             : ratio(profile.lineSpread(std::abs(middle) * stretch),
                                                     profile.lineSpread(std::abs(middle)), 1);
                        for (int c = 0; c < 3; ++c) {
                            brings[c] *= flows[c] > 0 ? flows[c] * gain[c] : 1;
                            if (flows[c] > 0) e[c] = from[there][c];
                        }
                    }
                    sum = sum + brings * e;
                    weights = weights + brings;
                };
                for (int i = 0; i < s.taps; ++i) {
                    const double a = ends[i] * wide / own.pixel, b = ends[i + 1] * wide / own.pixel;
                    const double middle = (a + b) / 2, reachOf = std::min(b - a, 1.0) / 2;
                    const int first = int(std::floor(middle - reachOf + 0.5)),
                              last = int(std::floor(middle + reachOf + 0.5));
                    Rgb share;
                    const Rgb before = half.value(std::abs(ends[i])),
                              after = half.value(std::abs(ends[i + 1]));
                    for (int c = 0; c < 3; ++c)
                        share[c] =
                            0.5 * (std::copysign(after[c], ends[i + 1]) - std::copysign(before[c], ends[i]));
                    const double beyond =
                        last > first ? (middle + reachOf - (last - 0.5)) / (2 * reachOf) : 0;
                    add(first, 1 - beyond, share, (ends[i] + ends[i + 1]) / 2);
                    if (last > first) add(last, beyond, share, (ends[i] + ends[i + 1]) / 2);
                }
                if (weigh)
                    result[here] = mixed(s, here, sum, weights);
                else
                    result[here] = sum / weights;
            }
        return result;
    };
    return filtered(filtered(picture.irradiance, 1, 0, false), 0, 1, true);
}

}  // namespace reference
