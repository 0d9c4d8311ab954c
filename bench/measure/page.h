// One self-contained HTML page of a report of `pellucid bench`.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace pellucid::bench {

std::string htmlPage(const nlohmann::ordered_json& report);
std::string shortNumber(double value);  // three digits

}  // namespace pellucid::bench
