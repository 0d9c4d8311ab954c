#include "plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

namespace pellucid::bench {
namespace {

template <class... Values>
std::string format(const char* pattern, Values... values) {
    char buffer[512];
    std::snprintf(buffer, sizeof buffer, pattern, values...);
    return buffer;
}

// Whole decades that hold all positive values.
struct LogAxis {
    int low = 0, high = 1;
    double from, to;  // pixels

    template <class Values>
    LogAxis(const Values& values, double from_, double to_) : from(from_), to(to_) {
        double least = INFINITY, most = 0;
        for (const double v : values)
            if (v > 0 && std::isfinite(v)) least = std::min(least, v), most = std::max(most, v);
        if (most > 0) {
            low = int(std::floor(std::log10(least)));
            high = std::max(low + 1, int(std::ceil(std::log10(most))));
        }
    }
    double at(double v) const {
        const double t = v > 0 ? (std::log10(v) - low) / (high - low) : 0;
        return from + std::clamp(t, 0.0, 1.0) * (to - from);
    }
};

std::string text(double x, double y, const char* anchor, const std::string& what, const char* more = "") {
    return format("<text x='%.1f' y='%.1f' text-anchor='%s' %s>", x, y, anchor, more) + escapeHtml(what) +
           "</text>";
}

}  // namespace

const char* seriesColor(int series) {
    // Okabe and Ito's palette, which colour-blind readers can tell apart.
    static constexpr const char* colors[] = {"#0072b2", "#d55e00", "#009e73",
                                             "#cc79a7", "#e69f00", "#56b4e9"};
    return colors[size_t(series) % std::size(colors)];
}

std::string escapeHtml(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '\'')
            out += "&#39;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

std::string shortNumber(double value) {
    if (!std::isfinite(value)) return "–";
    if (value == 0) return "0";
    const double size = std::abs(value);
    if (size < 1e-3 || size >= 1e5) return format("%.2e", value);
    return format(size < 1 ? "%.3f" : size < 10 ? "%.2f" : size < 100 ? "%.1f" : "%.0f", value);
}

std::string scatterPlot(const std::vector<PlotPoint>& points, const std::string& xTitle,
                        const std::string& yTitle) {
    const double width = 860, height = 400, left = 70, right = 660, top = 12, bottom = 350;
    std::vector<double> xs, ys;
    for (const PlotPoint& p : points) xs.push_back(p.x), ys.push_back(p.y);
    const LogAxis x(xs, left, right), y(ys, bottom, top);
    std::string svg = format("<svg viewBox='0 0 %.0f %.0f' role='img'>", width, height);
    for (int d = x.low; d <= x.high; ++d) {
        const double at = x.at(std::pow(10, d));
        svg += format("<line class='grid' x1='%.1f' x2='%.1f' y1='%.1f' y2='%.1f'/>", at, at, top, bottom);
        svg += text(at, bottom + 18, "middle", format("%g", std::pow(10, d)));
    }
    for (int d = y.low; d <= y.high; ++d) {
        const double at = y.at(std::pow(10, d));
        svg += format("<line class='grid' x1='%.1f' x2='%.1f' y1='%.1f' y2='%.1f'/>", left, right, at, at);
        svg += text(left - 8, at + 4, "end", format("1e%d", d));
    }
    svg += text((left + right) / 2, height - 12, "middle", xTitle, "class='title'");
    svg += format("<text class='title' text-anchor='middle' transform='translate(16 %.1f) rotate(-90)'>",
                  (top + bottom) / 2) +
           escapeHtml(yTitle) + "</text>";
    // Labels go in a column on the right, in the order of the points' heights, so that none covers another.
    std::vector<const PlotPoint*> order;
    for (const PlotPoint& p : points) order.push_back(&p);
    std::sort(order.begin(), order.end(), [&](auto* a, auto* b) { return y.at(a->y) < y.at(b->y); });
    double labelled = top;
    for (const PlotPoint* p : order) {
        const double px = x.at(p->x), py = y.at(p->y), line = std::max(labelled + 13, py);
        labelled = std::min(line, bottom + 30);
        svg += format("<polyline class='leader' points='%.1f,%.1f %.1f,%.1f %.1f,%.1f'/>", px, py, right + 6,
                      labelled, right + 14, labelled);
        svg += format("<circle cx='%.1f' cy='%.1f' r='4.5' fill='%s' stroke='%s'/>", px, py,
                      p->y > 0 ? seriesColor(p->series) : "#fff", seriesColor(p->series));
        svg += text(right + 18, labelled + 4, "start", p->label);
    }
    return svg + "</svg>";
}

std::string barPlot(const std::vector<PlotBar>& bars, const std::string& title) {
    const double width = 860, left = 210, right = 780, step = 20, bottom = 10 + step * double(bars.size());
    std::vector<double> values;
    for (const PlotBar& b : bars) values.push_back(b.value);
    const LogAxis x(values, left, right);
    std::string svg = format("<svg viewBox='0 0 %.0f %.0f' role='img'>", width, bottom + 46);
    for (int d = x.low; d <= x.high; ++d) {
        const double at = x.at(std::pow(10, d));
        svg += format("<line class='grid' x1='%.1f' x2='%.1f' y1='4' y2='%.1f'/>", at, at, bottom);
        svg += text(at, bottom + 18, "middle", format("%g", std::pow(10, d)));
    }
    for (size_t i = 0; i < bars.size(); ++i) {
        const PlotBar& b = bars[i];
        const double y = 10 + step * double(i);
        svg += text(left - 8, y + 12, "end", b.label);
        svg += format("<rect x='%.1f' y='%.1f' width='%.1f' height='13' fill='%s'/>", left, y,
                      x.at(b.value) - left, seriesColor(b.series));
        const double low = x.at(std::max(b.value - b.spread, b.value * 0.1)), high = x.at(b.value + b.spread);
        svg += format("<line x1='%.1f' x2='%.1f' y1='%.1f' y2='%.1f' stroke='#000'/>", low, high, y + 6.5,
                      y + 6.5);
        svg += text(high + 6, y + 11, "start", shortNumber(b.value));
    }
    svg += text((left + right) / 2, bottom + 38, "middle", title, "class='title'");
    return svg + "</svg>";
}

}  // namespace pellucid::bench
