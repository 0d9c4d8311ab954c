#include "baselines.h"

#include <algorithm>
#include <cmath>

namespace baseline {
namespace {

float length(const float* a, const float* b) {
    const float x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

void edgeCurvature(const std::vector<float>& positions, const std::vector<float>& normals,
                   const std::vector<uint32_t>& indices, uint32_t passes, CurvatureScratch& scratch,
                   std::vector<float>& curvature) {
    const size_t n = positions.size() / 3;
    std::vector<float>&low = scratch.low, &high = scratch.high, &weight = scratch.weight;
    low.assign(n, 1e30f);
    high.assign(n, 0.0f);
    curvature.resize(n);
    for (size_t t = 0; t < indices.size(); t += 3)
        for (int c = 0; c < 3; ++c) {
            const uint32_t a = indices[t + c], b = indices[t + (c + 1) % 3];
            const float k =
                length(&normals[3 * a], &normals[3 * b]) / length(&positions[3 * a], &positions[3 * b]);
            low[a] = std::min(low[a], k);
            low[b] = std::min(low[b], k);
            high[a] = std::max(high[a], k);
            high[b] = std::max(high[b], k);
        }
    for (size_t v = 0; v < n; ++v) curvature[v] = 0.5f * (low[v] + high[v]);
    for (uint32_t pass = 0; pass < passes; ++pass) {
        std::vector<float>& sum = low;
        sum.assign(n, 0.0f);
        weight.assign(n, 0.0f);
        for (size_t t = 0; t < indices.size(); t += 3) {
            const uint32_t a = indices[t], b = indices[t + 1], c = indices[t + 2];
            sum[a] += curvature[b] + curvature[c];
            sum[b] += curvature[c] + curvature[a];
            sum[c] += curvature[a] + curvature[b];
            weight[a] += 2.0f;
            weight[b] += 2.0f;
            weight[c] += 2.0f;
        }
        for (size_t v = 0; v < n; ++v) curvature[v] = sum[v] / std::max(1.0f, weight[v]);
    }
}

}  // namespace baseline
