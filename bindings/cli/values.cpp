#include "values.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <sstream>

#include "io/spelling.h"

namespace pellucid::cli {
namespace {

// `fits`: whether a number is allowed; `what` describes the allowed numbers.
template <class Number>
Check numbers(const std::string& what, const std::string& description, std::function<bool(Number)> fits) {
    return {[what, fits](std::string& given) {
                Number number{};
                const char *begin = given.data() + given.starts_with('+'), *end = given.data() + given.size();
                const auto [at, error] = std::from_chars(begin, end, number);
                const bool read = error == std::errc() && at == end;
                return read && fits(number) ? std::string() : "'" + given + "' is not " + what;
            },
            description};
}

template <class Number>
Check range(const std::string& kind, Number low, Number high) {
    std::ostringstream what;
    what << "a " << kind << " from " << low << " to " << high;
    std::ostringstream description;
    description << low << " to " << high;
    return numbers<Number>(what.str(), description.str(), [=](Number n) { return n >= low && n <= high; });
}

}  // namespace

Check isOneOf(std::vector<std::string> names) {
    std::string list, description;
    for (const std::string& name : names) {
        list += (list.empty() ? "" : ", ") + name;
        description += (description.empty() ? "{" : ",") + name;
    }
    return {[names = std::move(names), list](std::string& given) {
                std::string small = given;
                std::ranges::transform(small, small.begin(),
                                       [](unsigned char c) { return char(std::tolower(c)); });
                if (std::ranges::find(names, small) != names.end()) {
                    given = small;
                    return std::string();
                }
                const std::string nearest = io::nearestWord(small, names);
                return "there is no '" + given + "'; " +
                       (nearest.empty() ? "" : "did you mean " + nearest + "? ") + "there are " + list;
            },
            description + "}"};
}

Check isOneOf(std::span<const std::string_view> names, const std::vector<std::string>& more) {
    std::vector<std::string> all(names.begin(), names.end());
    all.insert(all.end(), more.begin(), more.end());
    return isOneOf(std::move(all));
}

Check inRange(int low, int high) {
    return range("whole number", low, high);
}
Check inRange(double low, double high) {
    return range("number", low, high);
}

Check isPositive() {
    return numbers<double>("a number above 0", "above 0", [](double n) { return std::isfinite(n) && n > 0; });
}
Check isNotNegative() {
    return numbers<double>("a number from 0 on", "from 0 on",
                           [](double n) { return std::isfinite(n) && n >= 0; });
}

}  // namespace pellucid::cli
