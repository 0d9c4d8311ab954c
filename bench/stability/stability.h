// The operations of docs/stability.md: from points of the unit cube, which stand for inputs, the errors
// there.
#pragma once
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "shading/pass_scene.h"
#include "tolerances.h"

namespace stability {

using namespace pellucid;
using Point = std::vector<double>;  // of the unit cube

// Random numbers that are the same with every standard library.
class Dice {
  public:
    explicit Dice(uint32_t seed) : engine_(seed) {}
    uint32_t bits() { return uint32_t(engine_()); }
    double uniform() { return (bits() + 0.5) * 0x1p-32; }
    double normal() { return std::sqrt(-2 * std::log(uniform())) * std::cos(6.283185307179586 * uniform()); }

  private:
    std::mt19937 engine_;
};

// Moves inputs by at most one unit in the last place of float, to see what their rounding alone does to the
// answer.
class Jitter {
  public:
    explicit Jitter(uint32_t seed) : dice_(seed) {}
    float operator()(float v) {
        const uint32_t side = dice_.bits() % 3;
        return side == 0 ? v : std::nextafter(v, side == 1 ? -INFINITY : INFINITY);
    }
    void operator()(std::vector<float>& values) {
        for (float& v : values) v = (*this)(v);
    }

  private:
    Dice dice_;
};

enum class Unit {
    absolute,  // relative where the truth is above 1
    largest,   // of the largest value
    length     // mm
};

// What the page says of an operation.
struct Header {
    std::string name, range;
    Unit unit = Unit::absolute;
    tolerance::Tolerance limit;
    size_t dimensions = 1, points = 1000;  // of a full search
};
// The dimension along which the page draws the error, logarithmic.
struct Axis {
    size_t dimension;
    double low, high;
    const char* label;
};

struct Operation {
    Header header;
    size_t batch = 1;  // points that one evaluation takes
    // Seed 0: of the device against the oracle; else of the oracle against itself, its inputs moved by
    // Jitter(seed).
    std::function<std::vector<double>(const std::vector<Point>&, uint32_t seed)> errors;
    std::function<std::string(const Point&)> where;
    std::optional<Axis> axis;
};

// One launch for one point, whose answer has many values. A truth of NaN is left out: there the
// result depends on a threshold.
class Case {
  public:
    virtual ~Case() = default;
    virtual void move(Jitter& jitter) = 0;
    virtual std::vector<float> measured() = 0;
    virtual std::vector<double> truth() = 0;
    virtual std::string where() = 0;
};
Operation operation(Header header, std::function<std::unique_ptr<Case>(const Point&)> make);

// One launch for many points, each of which is a pixel.
class Pixels {
  public:
    virtual ~Pixels() = default;
    virtual void move(Jitter& jitter) = 0;
    virtual std::vector<float> measured() = 0;            // as many values for each point
    virtual std::vector<double> truth(size_t pixel) = 0;  // called from several threads
};
// The last dimension of a point chooses one of `scenes`: what is not per pixel.
Operation operation(Header header, size_t scenes,
                    std::function<std::unique_ptr<Pixels>(size_t scene, const std::vector<Point>&)> make,
                    std::function<std::string(size_t scene, const Point&)> where);

inline double logBetween(double t, double low, double high) {
    return low * std::pow(high / low, t);
}
inline double between(double t, double low, double high) {
    return low + t * (high - low);
}

inline std::string text(const char* format, double a, double b = 0, double c = 0, double d = 0,
                        double e = 0) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, format, a, b, c, d, e);
    return buffer;
}

// A NaN is the worst of all errors, and stays it.
inline void keepWorst(double& worst, double e) {
    if (std::isnan(e) || e > worst) worst = e;
}

inline const Device& device() {
    return shade_test::device();
}

// body(i) for i below count, on all cores.
void inParallel(size_t count, const std::function<void(size_t)>& body);

struct Found {
    double drawn = 0, worst = 0;  // of the points drawn blindly; of all
    double inherent = 0;          // change of the oracle at the worst point if its inputs move by one ulp
    size_t points = 0;
    bool stopped = false;  // by the cap on time
    std::string where;
    std::vector<double> alongAxis;  // worst by part of the axis
};
// `share` of the operation's points; the same device finds the same. `seconds`: where to stop in any case.
Found search(const Operation& operation, double share, double seconds);

std::vector<Operation> tableOperations();
std::vector<Operation> profileOperations();
std::vector<Operation> meshOperations();
std::vector<Operation> smoothingOperations();
std::vector<Operation> screenOperations();
std::vector<Operation> shadingOperations();

}  // namespace stability
