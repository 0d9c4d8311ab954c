// The search: points of the unit cube drawn blindly, then an evolution strategy whose individuals carry their
// own step [Schwefel 1981], both in a fixed order from a fixed seed, so that the result depends on the device
// alone.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <thread>

#include "stability.h"

namespace stability {
namespace {

constexpr double blindShare = 0.3;
constexpr size_t parents = 6, axisParts = 24;

struct Individual {
    Point at;
    double error = -1, step = 0.1;
};
// NaN is worst of all.
bool worse(const Individual& a, const Individual& b) {
    if (std::isnan(a.error) || std::isnan(b.error)) return std::isnan(a.error) && !std::isnan(b.error);
    return a.error > b.error;
}

Point blind(size_t dimensions, Dice& dice) {
    Point at(dimensions);
    for (double& x : at) x = dice.uniform();
    return at;
}

// Most steps move a few coordinates only: errors often hang on one or two.
Individual child(const Individual& of, Dice& dice) {
    Individual c = of;
    c.step = std::clamp(of.step * std::exp(0.5 * dice.normal()), 1e-5, 0.5);
    const double moved = dice.uniform() < 0.5 ? 1.0 : 2.0 / double(of.at.size());
    const size_t surely = dice.bits() % of.at.size();
    for (size_t i = 0; i < c.at.size(); ++i)
        if (dice.uniform() < moved || i == surely)
            c.at[i] = std::clamp(c.at[i] + c.step * dice.normal(), 0.0, 1.0);
    return c;
}

double difference(const std::vector<float>& device, const std::vector<double>& truth, Unit unit) {
    double worst = 0, largest = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        if (std::isnan(truth[i])) continue;
        const double e = std::abs(device[i] - truth[i]);
        keepWorst(worst, unit == Unit::absolute ? e / std::max(1.0, std::abs(truth[i])) : e);
        largest = std::max(largest, std::abs(truth[i]));
    }
    return unit == Unit::largest ? (largest > 0 ? worst / largest : worst) : worst;
}
std::vector<float> rounded(const std::vector<double>& values) {
    return {values.begin(), values.end()};
}

}  // namespace

void inParallel(size_t count, const std::function<void(size_t)>& body) {
    std::atomic<size_t> next = 0;
    const auto work = [&] {
        for (size_t i; (i = next++) < count;) body(i);
    };
    std::vector<std::thread> others;
    for (unsigned k = 1; k < std::min<size_t>(std::thread::hardware_concurrency(), count); ++k)
        others.emplace_back(work);
    work();
    for (std::thread& t : others) t.join();
}

Operation operation(Header header, std::function<std::unique_ptr<Case>(const Point&)> make) {
    Operation o{header, 1, {}, [make](const Point& p) { return make(p)->where(); }, {}};
    o.errors = [make, unit = header.unit](const std::vector<Point>& points, uint32_t seed) {
        std::vector<double> errors;
        for (const Point& p : points) {
            const std::unique_ptr<Case> one = make(p);
            std::vector<float> left;
            if (seed) {
                left = rounded(one->truth());
                Jitter jitter(seed);
                one->move(jitter);
            } else {
                left = one->measured();
            }
            errors.push_back(difference(left, one->truth(), unit));
        }
        return errors;
    };
    return o;
}

Operation operation(Header header, size_t scenes,
                    std::function<std::unique_ptr<Pixels>(size_t, const std::vector<Point>&)> make,
                    std::function<std::string(size_t, const Point&)> where) {
    const auto sceneOf = [scenes](const Point& p) {
        return std::min(scenes - 1, size_t(p.back() * double(scenes)));
    };
    Operation o{header, 512 * scenes, {}, [=](const Point& p) { return where(sceneOf(p), p); }, {}};
    o.errors = [=, unit = header.unit](const std::vector<Point>& points, uint32_t seed) {
        std::vector<double> errors(points.size());
        std::map<size_t, std::vector<size_t>> members;
        for (size_t i = 0; i < points.size(); ++i) members[sceneOf(points[i])].push_back(i);
        for (const auto& [scene, of] : members) {
            std::vector<Point> some;
            for (size_t i : of) some.push_back(points[i]);
            const std::unique_ptr<Pixels> pixels = make(scene, some);
            std::vector<float> left;
            if (seed) {
                for (size_t k = 0; k < of.size(); ++k)
                    for (double v : pixels->truth(k)) left.push_back(float(v));
                Jitter jitter(seed);
                pixels->move(jitter);
            } else {
                left = pixels->measured();
            }
            const size_t values = left.size() / of.size();
            inParallel(of.size(), [&](size_t k) {
                const std::vector<float> mine(left.begin() + std::ptrdiff_t(k * values),
                                              left.begin() + std::ptrdiff_t((k + 1) * values));
                errors[of[k]] = difference(mine, pixels->truth(k), unit);
            });
        }
        return errors;
    };
    return o;
}

Found search(const Operation& o, double share, double seconds) {
    const auto start = std::chrono::steady_clock::now();
    const auto passed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    const size_t total = std::max<size_t>(size_t(share * double(o.header.points)), 4),
                 drawn = std::max<size_t>(size_t(blindShare * double(total)), 2);
    Dice dice(1);
    Found found;
    if (o.axis) found.alongAxis.resize(axisParts);
    std::vector<Individual> best;
    while (found.points < total && !found.stopped) {
        const bool blindly = found.points < drawn;
        std::vector<Individual> next;
        std::vector<Point> points;
        for (size_t left = std::min(o.batch, (blindly ? drawn : total) - found.points); left > 0; --left) {
            if (blindly || dice.uniform() < 0.05)
                next.push_back({blind(o.header.dimensions, dice)});
            else
                next.push_back(child(best[dice.bits() % best.size()], dice));
            points.push_back(next.back().at);
        }
        const std::vector<double> errors = o.errors(points, 0);
        for (size_t i = 0; i < next.size(); ++i) {
            next[i].error = errors[i];
            keepWorst(found.worst, errors[i]);
            if (o.axis)
                keepWorst(
                    found
                        .alongAxis[std::min(axisParts - 1, size_t(points[i][o.axis->dimension] * axisParts))],
                    errors[i]);
        }
        found.points += next.size();
        if (blindly) found.drawn = found.worst;
        best.insert(best.end(), next.begin(), next.end());
        std::stable_sort(best.begin(), best.end(), worse);
        if (best.size() > parents) best.resize(parents);
        found.stopped = found.points < total && passed() > seconds;
    }
    found.where = o.where(best[0].at);
    for (uint32_t seed = 1; seed <= 4; ++seed) keepWorst(found.inherent, o.errors({best[0].at}, seed)[0]);
    return found;
}

}  // namespace stability
