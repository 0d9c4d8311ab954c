// Logarithmic plots as SVG, for a page that needs nothing else.
#pragma once
#include <string>
#include <vector>

namespace pellucid::bench {

struct PlotPoint {
    double x, y;
    int series;         // colour
    std::string label;  // beside the point
};

// Points over two logarithmic axes; those that are not above 0 lie on the border, drawn hollow.
std::string scatterPlot(const std::vector<PlotPoint>& points, const std::string& xTitle,
                        const std::string& yTitle);

struct PlotBar {
    std::string label;
    double value, spread;  // spread: length of the whisker either way
    int series;
};

// Horizontal bars over a logarithmic axis.
std::string barPlot(const std::vector<PlotBar>& bars, const std::string& title);

const char* seriesColor(int series);
std::string escapeHtml(const std::string& text);
std::string shortNumber(double value);  // three digits

}  // namespace pellucid::bench
