#include "diffusion/surface_tree.h"

#include <numbers>
#include <numeric>

namespace pel {
namespace {

// Light of a set of triangles: per channel its weight and its centre.
struct Moments {
    Three weight{};                // integral of E dA
    std::array<Three, 3> first{};  // of E y dA
    Three second{};                // of E |y|^2 dA

    void add(const Moments& other) {
        weight += other.weight;
        for (int c = 0; c < 3; ++c) first[c] += other.first[c];
        second += other.second;
    }
};

Three corner(const SurfaceTriangle& t, int k) {
    return threeAt(t.corner + 3 * k);
}

// Exact for cubic integrands; E |y|^2 is cubic [Strang & Fix 1973, degree 3]. Relative to `origin`, to avoid
// cancellation.
Moments momentsOf(const SurfaceTriangle& t, const Three& origin) {
    const Three a = corner(t, 0) - origin, ab = corner(t, 1) - corner(t, 0), ac = corner(t, 2) - corner(t, 0);
    const double area = length(cross(ab, ac)) / 2;
    Moments sum;
    const double at[4][3] = {{1 / 3., 1 / 3., 1 / 3.}, {.6, .2, .2}, {.2, .6, .2}, {.2, .2, .6}};
    for (int q = 0; q < 4; ++q) {
        const double part = area * (q == 0 ? -27 / 48. : 25 / 48.);
        const Three y = a + at[q][1] * ab + at[q][2] * ac;
        for (int c = 0; c < 3; ++c) {
            double E = 0;
            for (int k = 0; k < 3; ++k) E += at[q][k] * t.irradiance[3 * k + c];
            sum.weight[c] += part * E;
            sum.first[c] += part * E * y;
            sum.second[c] += part * E * dot(y, y);
        }
    }
    return sum;
}

class Builder {
  public:
    Builder(SurfaceTree& tree, const SurfaceProfile& profile, double error,
            const std::function<void(double)>& progress)
        : tree_(tree), profile_(profile), progress_(progress) {
        // The error is divided among distances, the same for each octave: E dA / (2 pi r^2 octaves) of a
        // plane adds up to E.
        nearest_ = profile.distance(0);
        share_ = error / (2 * std::numbers::pi * std::log(2 * profile.reach / nearest_));
        order_.resize(tree.triangles.size());
        std::iota(order_.begin(), order_.end(), 0u);
        for (const SurfaceTriangle& t : tree.triangles)
            middles_.push_back((1 / 3.) * (corner(t, 0) + corner(t, 1) + corner(t, 2)));
        tree.nodes.reserve(2 * order_.size());
        origin_ = middles_[0];
    }
    void build() {
        split(0, order_.size());
        // Leaves in the order of the walk, so that neighbours are side by side in memory.
        std::vector<SurfaceTriangle> sorted(order_.size());
        uint32_t next = 0;
        for (SurfaceNode& node : tree_.nodes)
            if (node.triangle != PEL_SURFACE_NONE) {
                sorted[next] = tree_.triangles[node.triangle];
                node.triangle = next++;
            }
        tree_.triangles = std::move(sorted);
    }

  private:
    struct Set {
        Moments moments;
        Three low, high;
    };

    Set split(size_t begin, size_t end) {
        const size_t index = tree_.nodes.size();
        tree_.nodes.emplace_back();
        Set set;
        if (end - begin == 1) {
            const SurfaceTriangle& t = tree_.triangles[order_[begin]];
            set.moments = momentsOf(t, origin_);
            set.low = set.high = corner(t, 0);
            for (int k = 1; k < 3; ++k) grow(set, corner(t, k), corner(t, k));
            if (++done_ % 16384 == 0) progress_(double(done_) / double(order_.size()));
        } else {
            Three low = middles_[order_[begin]], high = low;
            for (size_t i = begin; i < end; ++i)
                for (int a = 0; a < 3; ++a) {
                    low[a] = std::min(low[a], middles_[order_[i]][a]);
                    high[a] = std::max(high[a], middles_[order_[i]][a]);
                }
            const Three extent = high - low;
            const int axis = int(std::max_element(extent.begin(), extent.end()) - extent.begin());
            const size_t middle = (begin + end) / 2;
            // Equal places are ordered by their numbers, so that the tree is the same everywhere.
            std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                             [&](uint32_t a, uint32_t b) {
                                 const double pa = middles_[a][axis], pb = middles_[b][axis];
                                 return pa != pb ? pa < pb : a < b;
                             });
            set = split(begin, middle);
            const Set other = split(middle, end);
            set.moments.add(other.moments);
            grow(set, other.low, other.high);
        }
        finish(tree_.nodes[index], set, end - begin == 1 ? order_[begin] : PEL_SURFACE_NONE);
        return set;
    }
    static void grow(Set& set, const Three& low, const Three& high) {
        for (int a = 0; a < 3; ++a) {
            set.low[a] = std::min(set.low[a], low[a]);
            set.high[a] = std::max(set.high[a], high[a]);
        }
    }
    void finish(SurfaceNode& node, const Set& set, uint32_t triangle) const {
        const Moments& m = set.moments;
        const double light = m.weight[0] + m.weight[1] + m.weight[2];
        const Three centre = (1 / light) * (m.first[0] + m.first[1] + m.first[2]);
        // Per channel: the distance of its light from the centre, and its mean squared distance.
        double offset = 0, spread = 0;
        for (int c = 0; c < 3; ++c) {
            if (!(m.weight[c] > 0)) continue;
            const Three own = (1 / m.weight[c]) * m.first[c] - centre;
            offset = std::max(offset, length(own));
            spread = std::max(
                spread, (m.second[c] - 2 * dot(centre, m.first[c])) / m.weight[c] + dot(centre, centre));
        }
        if (offset * offset < 1e-12 * spread) offset = 0;  // white light: only rounding
        Three far{};
        const Three at = centre + origin_;
        for (int a = 0; a < 3; ++a) far[a] = std::max(at[a] - set.low[a], set.high[a] - at[a]);
        const double radius = length(far);
        std::ranges::copy(at, node.centre);
        std::ranges::copy(m.weight, node.weight);
        node.radius = float(radius);
        const double accept = acceptFrom(radius, std::max(0.0, spread), offset);
        node.accept2 = float(accept * accept);
        node.skip = uint32_t(tree_.nodes.size());
        node.triangle = triangle;
    }
    // The least distance from which on Taylor's remainder round the centre stays below the set's share of the
    // error.
    double acceptFrom(double radius, double spread, double offset) const {
        size_t low = 0, high = profile_.count();  // rows of the distance to the set's nearest point
        const auto fits = [&](size_t row) {
            const double far = profile_.distance(row + 1) + 2 * radius;
            return (0.5 * spread * profile_.curving[row] + offset * profile_.fall[row]) * far * far <= share_;
        };
        while (low < high) {
            const size_t middle = (low + high) / 2;
            (fits(middle) ? high : low) = fits(middle) ? middle : middle + 1;
        }
        return std::max(nearest_, profile_.distance(low)) + radius;
    }

    SurfaceTree& tree_;
    const SurfaceProfile& profile_;
    const std::function<void(double)>& progress_;
    double nearest_, share_;
    std::vector<uint32_t> order_;
    std::vector<Three> middles_;
    Three origin_;
    size_t done_ = 0;
};

}  // namespace

SurfaceTree buildSurfaceTree(std::vector<SurfaceTriangle> lit, const SurfaceProfile& profile, double error,
                             const std::function<void(double)>& progress) {
    SurfaceTree tree;
    tree.triangles = std::move(lit);
    if (tree.triangles.empty()) return tree;
    Builder(tree, profile, error, progress).build();
    return tree;
}

}  // namespace pel
