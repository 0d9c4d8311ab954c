#include "page.h"

#include <cmath>
#include <cstdio>
#include <set>

namespace pellucid::bench {

std::string shortNumber(double value) {
    if (!std::isfinite(value)) return "–";
    if (value == 0) return "0";
    const double size = std::abs(value);
    const char* pattern = size < 1e-3 || size >= 1e5 ? "%.2e"
                          : size < 1                 ? "%.3f"
                          : size < 10                ? "%.2f"
                          : size < 100               ? "%.1f"
                                                     : "%.0f";
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, pattern, value);
    return buffer;
}

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* style = R"(<style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 1280px; margin: 2em auto; padding: 0 1em; }
body { color: #222; background: #fff; } h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin-top: 2em; }
table { border-collapse: collapse; font-size: 13px; width: 100%; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 4px; border-bottom: 1px solid #ddd; text-align: right; white-space: nowrap; }
th:first-child, td:first-child, td.text, th.text { text-align: left; } .wide { overflow-x: auto; }
.first td { font-size: 16px; } .note { color: #555; font-size: 13px; }
</style>)";

std::string escapeHtml(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const char* name = c == '&'    ? "&amp;"
                           : c == '<'  ? "&lt;"
                           : c == '>'  ? "&gt;"
                           : c == '\'' ? "&#39;"
                           : c == '"'  ? "&quot;"
                                       : nullptr;
        name ? void(out += name) : void(out += c);
    }
    return out;
}

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
        html += cell(words(e, "what"), " class='text'") + cell(shortNumber(value(e, "median_ms"))) +
                cell(shortNumber(value(e, "mad_ms"))) +
                cell(value(e, "device_ms") > 0 ? shortNumber(value(e, "device_ms")) : "–") +
                cell((rate >= 1e9   ? shortNumber(rate * 1e-9) + " G"
                      : rate >= 1e6 ? shortNumber(rate * 1e-6) + " M"
                                    : shortNumber(rate) + " ") +
                     words(e, "unit")) +
                cell(percent(value(e, "bandwidth_share"))) + cell(percent(value(e, "arithmetic_share"))) +
                cell("<span title='" + words(e, "truth") + "'>" + shortNumber(value(e, "error_max")) +
                     "</span>") +
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

// Which device, how many frames a second, at what error: the question that the page is opened with.
std::string framesTable(const Json& devices) {
    struct Column {
        const char *operation, *title;
    };
    static constexpr Column columns[] = {{"shade-10-percent", "skin on a tenth of the frame, 32 taps"},
                                         {"shade-surface", "skin everywhere"},
                                         {"shade-32-taps", "skin everywhere, 32 taps"}};
    std::string head = "<tr><th>frames a second</th>", rows, size;
    for (const Column& c : columns) head += std::string("<th>") + c.title + "</th>";
    for (const Json& d : devices) {
        rows += "<tr>" + cell(words(d, "name"));
        double error = NAN;
        for (const Column& c : columns) {
            double frames = NAN;
            for (const Json& e : d.at("operations")) {
                if (words(e, "name") != c.operation || e.contains("failed")) continue;
                frames = 1e3 / value(e, "median_ms");
                error = std::fmax(error, value(e, "error_max"));
                if (size.empty()) size = words(e, "what").substr(0, words(e, "what").find(','));
            }
            rows += cell(shortNumber(frames));
        }
        rows += cell(shortNumber(error)) + "</tr>";
    }
    if (size.empty()) return "";  // --only
    return "<table class='first'>" + head + "<th>largest error</th></tr>" + rows +
           "</table><p class='note'>Frames of " + size +
           " pixels with one light, nothing else running. Error of linear radiance, against double "
           "precision.</p>";
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
            (report.value("quick", false) ? ", <b>quick: small sizes, few repetitions</b>" : "") + ".</p>" +
            framesTable(devices);
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

    for (const Json& d : devices)
        html += "<h2>" + words(d, "name") + "</h2>" + operationsTable(d) + truthList(d);
    return html + "</body></html>\n";
}

}  // namespace pellucid::bench
