// The operations of docs/stability.md: the errors at points of the unit cube, which stand for inputs.
#pragma once

#include "io/shortest.h"
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

// Moves inputs by at most one unit in the last place of float, to see what their rounding alone does.
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

// The page's description of an operation.
struct Header {
    std::string name, range;
    Unit unit = Unit::absolute;
    double limit;
    size_t dimensions = 1, points = 1000;  // of a full search
};
// The dimension along which the page draws the error, logarithmic.
struct Axis {
    size_t dimension;
    double low, high;
    const char* label;
};

// The same inputs on the device and in the oracle; as many values for each point that it is made of. Values
// whose truth is NaN are left out: there the result depends on a threshold.
struct Case {
    std::function<void(Jitter&)> move;
    std::function<std::vector<float>()> measured;
    std::function<std::vector<double>()> truth;
    std::string where;  // of the first point
};

struct Operation {
    Header header;
    std::function<Case(const std::vector<Point>&)> make;
    size_t batch = 1;  // points of a case
    std::optional<Axis> axis;
};

inline double logBetween(double t, double low, double high) {
    return low * std::pow(high / low, t);
}
inline double between(double t, double low, double high) {
    return low + t * (high - low);
}

inline std::string text(const char* format, double a, double b = 0, double c = 0, double d = 0,
                        double e = 0) {
    return io::printed(format, a, b, c, d, e);
}

// A NaN is the worst of all errors, and stays it.
inline void keepWorst(double& worst, double e) {
    if (std::isnan(e) || e > worst) worst = e;
}

// body(i) for i below count, on all cores.
void inParallel(size_t count, const std::function<void(size_t)>& body);

std::vector<Operation> tableOperations();
std::vector<Operation> meshOperations();
std::vector<Operation> screenOperations();
std::vector<Operation> shadingOperations();

}  // namespace stability
