// What an option takes. CLI11's own checks answer a wrong value with lists of names and numbers, let NaN pass, and print the
// largest double in full; the help texts are those of CLI11.
#pragma once
#include <CLI/CLI.hpp>
#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pellucid::cli {

// One of these words, in small or capital letters.
CLI::Validator isOneOf(std::vector<std::string> names);

// Choices by the names that files have for them (io/choice_keys.h).
CLI::Validator isOneOf(std::span<const std::string_view> names, const std::vector<std::string>& more = {});
template <class Enum>
Enum chosen(std::span<const std::string_view> names, const std::string& name) {
    return Enum(std::find(names.begin(), names.end(), name) - names.begin());
}

// Whole numbers, and numbers, from `low` to `high`; both belong to them.
CLI::Validator inRange(int low, int high);
CLI::Validator inRange(double low, double high);

// Finite numbers above 0; from 0 on.
CLI::Validator isPositive();
CLI::Validator isNotNegative();

}  // namespace pellucid::cli
