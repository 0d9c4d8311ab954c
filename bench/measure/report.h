// Reports of `pellucid bench`, and the comparison of two.
#pragma once
#include <nlohmann/json.hpp>

namespace pellucid::bench {

// The report in a text: an object with an array "devices"; anything else is discarded (is_discarded()).
nlohmann::ordered_json parseReport(const std::string& text);

// {"devices": [{"name", "operations": [{"name", "old_ms", "new_ms", "ratio", "noise", "verdict"}]}],
// "slower", "faster", "less_accurate", ...}. Verdicts: "same", "faster", "slower", "less accurate", "fails",
// "other size", "only old", "only new", "not compared". Devices are paired by name and platform. If one
// device is left over in each report, the two are compared, and "old_name" is the name of the old one.
//
// ratio = new / old median. A change counts when |ln ratio| is beyond `noise` = max(5 %, 4 standard errors,
// change of the device's own copies and arithmetic between the two reports). The standard error of a median
// is 1.2533 sigma / sqrt(samples); sigma is 1.4826 times the median absolute deviation [Rousseeuw and Croux
// 1993]. An error counts as grown when it is more than 1.5 times the old one and 1e-7 above it,
// FLIP when it is more than a tenth of the old one and more than the noise of the truth above it.
nlohmann::ordered_json compareReports(const nlohmann::ordered_json& before,
                                      const nlohmann::ordered_json& after);
std::string describeComparison(const nlohmann::ordered_json& comparison);  // a table for people

// The setting of "auto" that gets an image that the others do not get.
constexpr const char* withThickness = "with thickness";

// What a reader asks first. Adds to a device of a report:
// "summary": each method and setting over all scenes: {"method", "setting", "scenes", "rmse" (RGB) and
// "error", root mean squares, "flip", the mean where all scenes have it, "watts", the median, "ns_per_pixel"
// of skin beyond plain lighting, median and 90th percentile, "ms": {"1080p", "4K"} of a frame with a head,
// "measured": whether it was measured at that size or follows from the scenes, "pareto": no other is both
// faster and nearer}. "answers": for each of `budgets`, milliseconds at 1080p, the nearest to light that
// keeps it; for each of `errors`, the fastest below it. "budgets", where time budgets were tried: {"frames",
// "kept": those whose time was at most 15 % beyond the budget, "worst_ratio": largest error over that of the
// nearest method that was as fast in the same scene, "near": how many of the frames are within 1.3 of it}.
void summarize(nlohmann::ordered_json& device, const std::vector<double>& budgets,
               const std::vector<double>& errors);

// The device's part of a record for PelShaderOptions.timeBudget; "" where no method was measured.
std::string tuningText(const nlohmann::ordered_json& device);

// The page that shows reports: `page` (data/bench/page.html) with them in it.
std::string pageOf(std::string page, const nlohmann::ordered_json& reports);

}  // namespace pellucid::bench
