// Searches the inputs of every operation for the worst error against the double-precision oracle of the
// tests; docs/stability.md is made of such reports by write_page.
//
// The search: points of the unit cube drawn blindly, then an evolution strategy whose individuals carry their
// own step [Schwefel 1981], in a fixed order from a fixed seed: the result depends on the device alone.

#include "measure/measure.h"
#include "stability.h"

using namespace stability;
using Json = nlohmann::ordered_json;

namespace stability {

void inParallel(size_t count, const std::function<void(size_t)>& body) {
    std::atomic<size_t> next = 0;
    std::vector<std::jthread> threads(
        std::clamp<size_t>(std::thread::hardware_concurrency(), 1, std::max<size_t>(count, 1)));
    for (std::jthread& thread : threads)
        thread = std::jthread([&] {
            for (size_t i; (i = next++) < count;) body(i);
        });
}

}  // namespace stability

namespace {

struct Found {
    double drawn = 0, worst = 0;  // of the points drawn blindly; of all
    double inherent = 0;          // change of the oracle at the worst point if its inputs move by one ulp
    size_t points = 0;
    bool stopped = false;  // by the cap on time
    std::string where;
    std::vector<double> alongAxis;  // worst by part of the axis
};

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

double difference(std::span<const float> device, std::span<const double> truth, Unit unit) {
    double worst = 0, largest = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        if (std::isnan(truth[i])) continue;
        const double e = std::abs(device[i] - truth[i]);
        keepWorst(worst, unit == Unit::absolute ? e / std::max(1.0, std::abs(truth[i])) : e);
        largest = std::max(largest, std::abs(truth[i]));
    }
    return unit == Unit::largest ? (largest > 0 ? worst / largest : worst) : worst;
}
// Seed 0: of the device against the oracle; else of the oracle against itself after Jitter(seed).
std::vector<double> errorsOf(const Operation& o, const std::vector<Point>& points, uint32_t seed) {
    const Case one = o.make(points);
    std::vector<float> left;
    if (seed) {
        const std::vector<double> before = one.truth();
        left.assign(before.begin(), before.end());
        Jitter jitter(seed);
        one.move(jitter);
    } else {
        left = one.measured();
    }
    const std::vector<double> truth = one.truth();
    std::vector<double> errors;
    for (size_t k = 0, values = truth.size() / points.size(); k < points.size(); ++k)
        errors.push_back(
            difference({&left[k * values], values}, {&truth[k * values], values}, o.header.unit));
    return errors;
}

// `share` of the operation's points; the same device finds the same. `seconds`: where to stop in any case.
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
        const std::vector<double> errors = errorsOf(o, points, 0);
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
    found.where = o.make({best[0].at}).where;
    for (uint32_t seed = 1; seed <= 4; ++seed) keepWorst(found.inherent, errorsOf(o, {best[0].at}, seed)[0]);
    return found;
}

// Three digits; NaN, which JSON has not, as null.
Json number(double v) {
    return std::isfinite(v) ? Json::parse(text("%.3g", v)) : Json();
}

Json record(const Operation& o, const Found& f) {
    constexpr const char* unitNames[] = {"absolute, relative above 1", "of the largest", "mm"};
    Json json = {{"name", o.header.name},
                 {"range", o.header.range},
                 {"unit", unitNames[int(o.header.unit)]},
                 {"limit", number(o.header.limit)},
                 {"points", f.points},
                 {"stopped", f.stopped},
                 {"drawn", number(f.drawn)},
                 {"worst", number(f.worst)},
                 {"inherent", number(f.inherent)},
                 {"where", f.where}};
    if (o.axis) {
        json["axis"] = {{"label", o.axis->label},
                        {"low", number(o.axis->low)},
                        {"high", number(o.axis->high)},
                        {"worst", Json::array()}};
        for (const double worst : f.alongAxis) json["axis"]["worst"].push_back(number(worst));
    }
    return json;
}

}  // namespace

namespace pellucid::bench {

void findTaps(const Request& request) {
    if (const std::string disk = request.data + "/bench/poisson_disk.clh"; std::filesystem::exists(disk))
        shade_test::diskFile() = disk;
}

Json measureStability(const Request& request) {
    const double seconds = request.limitSeconds * std::clamp(request.stability, 1 / 12.0, 0.9);
    findTaps(request);
    Json records = Json::array();
    for (const auto& some : {tableOperations(), meshOperations(), screenOperations(), shadingOperations()})
        for (const Operation& o : some) {
            const std::string name = "stability: " + o.header.name;
            if (!request.wants(name)) continue;
            request.begin(name, "stability");
            request.say(name);
            records.push_back(record(o, search(o, request.stability, seconds)));
        }
    return {{"stability", {{"share", request.stability}, {"operations", records}}}};
}

}  // namespace pellucid::bench
