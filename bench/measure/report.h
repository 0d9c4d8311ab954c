// Reports of `pellucid bench`: their page, and the comparison of two.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace pellucid::bench {

// The report in a text: an object with an array "devices", nested no deeper than any report. Anything else is
// discarded (is_discarded()).
nlohmann::ordered_json parseReport(const std::string& text);

// {"devices": [{"name", "operations": [{"name", "old_ms", "new_ms", "ratio", "noise", "verdict"}]}],
// "slower", "faster", "less_accurate", ...}. Verdicts: "same", "faster", "slower", "less accurate", "fails",
// "other size", "only old", "only new", "not compared". Devices are paired by name and platform. If one
// device is left over in each report, the two are compared, and "old_name" is the name of the old one.
//
// ratio = new / old median. A change counts when |ln ratio| is beyond `noise` = max(5 %, 4 standard errors,
// change of the device's own copies and arithmetic between the two reports). The standard error of a median
// is 1.2533 sigma / sqrt(samples); sigma is 1.4826 times the median absolute deviation [Rousseeuw and Croux
// 1993]. An error counts as grown when it is more than 1.5 times the old one and 1e-7 above it.
nlohmann::ordered_json compareReports(const nlohmann::ordered_json& before,
                                      const nlohmann::ordered_json& after);
std::string describeComparison(const nlohmann::ordered_json& comparison);  // a table for people

std::string htmlPage(const nlohmann::ordered_json& report);  // self-contained
std::string shortNumber(double value);                       // three digits

}  // namespace pellucid::bench
