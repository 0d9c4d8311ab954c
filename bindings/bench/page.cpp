#include "page.h"

#include <cmath>
#include <set>
#include <vector>

#include "plot.h"

namespace pellucid::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* style = R"(<style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 1280px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; }
h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin-top: 2em; } h3 { font-size: 1em; margin: 1.6em 0 .3em; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 4px; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap; }
th:first-child, td:first-child, td.text, th.text { text-align: left; } .wide { overflow-x: auto; }
svg { width: 100%; height: auto; } svg text { font-size: 12px; fill: #222; } svg .title { font-size: 13px; }
svg .grid { stroke: #e4e4e4; } svg .leader { stroke: #bbb; fill: none; }
.key span { display: inline-block; width: .8em; height: .8em; margin: 0 .35em 0 1em; } .note { color: #555; font-size: 13px; }
</style>)";

double value(const Json& e, const char* key) {
    const auto found = e.find(key);
    return found != e.end() && found->is_number() ? found->get<double>() : NAN;
}
std::string words(const Json& e, const char* key) {
    const auto found = e.find(key);
    return found != e.end() && found->is_string() ? escapeHtml(found->get<std::string>()) : "";
}
std::string percent(double share) {
    return std::isfinite(share) ? shortNumber(100 * share) + " %" : "–";
}
std::string cell(const std::string& text, const char* kind = "") {
    return std::string("<td") + kind + ">" + text + "</td>";
}

std::string operationsTable(const Json& device) {
    std::string html =
        "<div class='wide'><table><tr><th>operation</th><th class='text'>size</th><th>median ms</th><th>± "
        "MAD</th><th>device "
        "ms</th><th>per second</th>"
        "<th>of copies</th><th>of arithmetic</th><th>largest error</th><th>RMS error</th></tr>";
    for (const Json& e : device.at("operations")) {
        html += "<tr>" + cell(words(e, "name"));
        if (e.contains("failed")) {
            html += "<td class='text' colspan='9'>could not be done: " + words(e, "failed") + "</td></tr>";
            continue;
        }
        const double rate = value(e, "per_second");
        html +=
            cell(words(e, "what"), " class='text'") + cell(shortNumber(value(e, "median_ms"))) +
            cell(shortNumber(value(e, "mad_ms"))) +
            cell(value(e, "device_ms") > 0 ? shortNumber(value(e, "device_ms")) : "–") +
            cell((rate >= 1e9   ? shortNumber(rate * 1e-9) + " G"
                  : rate >= 1e6 ? shortNumber(rate * 1e-6) + " M"
                                : shortNumber(rate) + " ") +
                 words(e, "unit")) +
            cell(percent(value(e, "bandwidth_share"))) + cell(percent(value(e, "arithmetic_share"))) +
            cell("<span title='" + words(e, "truth") + "'>" + shortNumber(value(e, "error_max")) + "</span>") +
            cell(shortNumber(value(e, "error_rms"))) + "</tr>";
    }
    return html + "</table></div>";
}

std::string truthList(const Json& device) {
    std::string html = "<p class='note'>Errors are against: ";
    std::set<std::string> said;
    for (const Json& e : device.at("operations"))
        if (const std::string truth = words(e, "truth"); !truth.empty() && said.insert(truth).second)
            html += (said.size() > 1 ? "; <b>" : "<b>") + words(e, "name") + "</b> " + truth;
    return html + ".</p>";
}

}  // namespace

std::string htmlPage(const Json& report) {
    const Json& host = report.at("host");
    const Json& devices = report.at("devices");
    std::string html =
        "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><title>pellucid bench</title>";
    html += style;
    html += "</head><body><h1>pellucid bench</h1><p>Version " + words(host, "pellucid") + ", " +
            words(host, "date") + ", " + words(host, "cpu") + " with " +
            std::to_string(host.value("cores", 0)) + " threads" +
            (report.value("quick", false) ? ", <b>quick: small sizes, few repetitions</b>" : "") + ".</p>";
    html +=
        "<p class='note'>Times are medians of blocking calls, cases interleaved in rounds; MAD is the median "
        "absolute deviation. "
        "Bandwidth and arithmetic are shares of what the same device reached in the same run with a copy and "
        "with "
        "multiply-adds alone, counting only what the operation's definition needs.</p>";
    html +=
        "<table><tr><th>device</th><th class='text'>platform, driver</th><th>copy GB/s</th><th>arithmetic "
        "GFLOP/s</th>"
        "<th>first use ms</th><th>warm start ms</th></tr>";
    for (const Json& d : devices)
        html += "<tr>" + cell(words(d, "name")) +
                cell(words(d, "platform") + ", " + words(d, "driver"), " class='text'") +
                cell(shortNumber(value(d, "copy_bytes_per_second") * 1e-9)) +
                cell(shortNumber(value(d, "operations_per_second") * 1e-9)) +
                cell(shortNumber(d.contains("first_use") ? value(d["first_use"], "total_ms") : NAN)) +
                cell(shortNumber(d.contains("warm_start") ? value(d["warm_start"], "total_ms") : NAN)) +
                "</tr>";
    html +=
        "</table><p class='note'>First use: a new process with empty caches, from nothing to the first small "
        "table and frame; warm "
        "start: the same again.</p>";

    html += "<h2>Run time against error</h2><p class='key'>";
    for (size_t i = 0; i < devices.size(); ++i)
        html += std::string("<span style='background:") + seriesColor(int(i)) + "'></span>" +
                words(devices[i], "name");
    html += "</p>";
    for (const char* group : {"mesh", "tables", "shading"}) {
        std::vector<PlotPoint> points;
        for (size_t i = 0; i < devices.size(); ++i)
            for (const Json& e : devices[i].at("operations"))
                if (e.at("group") == group && std::isfinite(value(e, "error_max")))
                    points.push_back({value(e, "median_ms"), value(e, "error_max"), int(i), e.at("name")});
        if (points.empty()) continue;
        html += std::string("<h3>") + group + "</h3>" + scatterPlot(points, "run time, ms", "largest error");
    }
    for (size_t i = 0; i < devices.size(); ++i) {
        const Json& d = devices[i];
        html += "<h2>" + words(d, "name") + "</h2>" + operationsTable(d) + truthList(d);
        std::vector<PlotBar> bars;
        for (const Json& e : d.at("operations"))
            if (!e.contains("failed") && e.at("group") != "device")
                bars.push_back({e.at("name"), value(e, "median_ms"), value(e, "mad_ms"), int(i)});
        html += "<h3>Run time</h3>" + barPlot(bars, "ms, median and its absolute deviation");
    }
    return html + "</body></html>\n";
}

}  // namespace pellucid::bench
