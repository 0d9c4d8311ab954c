#include "values.h"

#include <cmath>
#include <functional>
#include <sstream>

#include "io/spelling.h"

namespace pellucid::cli {
namespace {

// `fits` says of a number whether it is one of `what`.
template <class Number>
CLI::Validator numbers(const std::string& what, const std::string& description, std::function<bool(Number)> fits) {
    return CLI::Validator(
        [what, fits](std::string& given) {
            Number number{};
            const bool read = CLI::detail::lexical_cast(given, number);
            return read && fits(number) ? std::string() : "'" + given + "' is not " + what;
        },
        description);
}

template <class Number>
CLI::Validator range(const std::string& kind, Number low, Number high) {
    std::ostringstream what;
    what << "a " << kind << " from " << low << " to " << high;
    return numbers<Number>(what.str(), CLI::Range(low, high).get_description(),
                           [=](Number n) { return n >= low && n <= high; });
}

}  // namespace

CLI::Validator isOneOf(std::vector<std::string> names) {
    const std::string description = CLI::IsMember(names).get_description();
    return CLI::Validator(
        [names = std::move(names)](std::string& given) {
            const std::string small = CLI::detail::to_lower(given);
            if (std::find(names.begin(), names.end(), small) != names.end()) {
                given = small;
                return std::string();
            }
            const std::string nearest = io::nearestWord(small, names);
            return "there is no '" + given + "'; " +
                   (nearest.empty() ? "" : "did you mean " + nearest + "? ") + "there are " +
                   CLI::detail::join(names, ", ");
        },
        description);
}

CLI::Validator isOneOf(std::span<const std::string_view> names, const std::vector<std::string>& more) {
    std::vector<std::string> all(names.begin(), names.end());
    all.insert(all.end(), more.begin(), more.end());
    return isOneOf(std::move(all));
}

CLI::Validator inRange(int low, int high) {
    return range("whole number", low, high);
}
CLI::Validator inRange(double low, double high) {
    return range("number", low, high);
}

CLI::Validator isPositive() {
    return numbers<double>("a number above 0", "POSITIVE", [](double n) { return std::isfinite(n) && n > 0; });
}
CLI::Validator isNotNegative() {
    return numbers<double>("a number from 0 on", "NONNEGATIVE",
                           [](double n) { return std::isfinite(n) && n >= 0; });
}

}  // namespace pellucid::cli
