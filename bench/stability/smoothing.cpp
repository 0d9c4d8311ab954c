// Smoothing of curvature: uniform passes, and to a radius by either weights, with and without creases.
#include "meshes.h"

namespace stability {
namespace {

// Values of the edge estimator, which is exact to 2e-7, so that what is seen is the smoothing.
class Smoothed : public MovedMesh {
  public:
    Smoothed(const Point& p, PelSmoothingWeights weights) : MovedMesh(p) {
        params_.estimator = PEL_CURVATURE_EDGE;
        params_.smoothingPasses = 0;
        params_.smoothingWeights = weights;
    }
    void passes(uint32_t count) {
        params_.smoothingPasses = count;
        place += text(", %.0f passes", count);
    }
    void radius(double sizes, uint32_t stages, double crease) {
        params_.smoothingRadius = float(8 * scale * sizes);
        params_.smoothingStages = stages;
        params_.smoothingCrease = float(crease);
        place += text(", radius %.2g sizes in %.0f stages", sizes, stages) +
                 (crease > 0 ? text(", creases of %.2g", crease) : "");
    }
    void move(Jitter& j) override {
        MovedMesh::move(j);
        params_.smoothingRadius = j(params_.smoothingRadius);
        if (params_.smoothingCrease > 0) params_.smoothingCrease = j(params_.smoothingCrease);
    }
    std::vector<float> measured() override { return curvature(params_); }
    std::vector<double> truth() override {
        // Whether a triangle has a plane is a decision.
        for (const auto& t : mesh.triangles)
            for (int i = 0; i < 3; ++i) {
                const reference::Vec3 p = mesh.positions[size_t(t[i])],
                                      a = mesh.positions[size_t(t[(i + 1) % 3])] - p,
                                      b = mesh.positions[size_t(t[(i + 2) % 3])] - p;
                const double sine2 = dot(cross(a, b), cross(a, b)) / (dot(a, a) * dot(b, b));
                if (std::abs(sine2 / reference::flatTriangle - 1) < 0.1)
                    return std::vector<double>(count(), NAN);
            }
        const auto values =
            reference::smoothed(mesh, reference::edgeCurvature(mesh), int(params_.smoothingPasses));
        if (params_.smoothingRadius == 0) return values;
        auto smooth = reference::smoothedToRadius(
            mesh, values,
            {params_.smoothingRadius, params_.smoothingCrease, int(params_.smoothingStages),
             params_.smoothingWeights == PEL_SMOOTHING_AREA});
        for (double& v : smooth) v = std::abs(v);  // slivers carry values below 0
        return smooth;
    }

  private:
    PelCurvatureParams params_ = pelCurvatureParamsDefaults();
};

Operation passes() {
    return operation({"smoothing passes", std::string(meshRange) + "; 1 to 32 passes", Unit::largest,
                      tolerance::edgeCurvature, 5, 400},
                     [](const Point& p) {
                         auto smooth = std::make_unique<Smoothed>(p, PEL_SMOOTHING_COTANGENT);
                         smooth->passes(uint32_t(logBetween(p[4], 1, 32.99)));
                         return smooth;
                     });
}

Operation toRadius(const char* name, PelSmoothingWeights weights, bool crease) {
    return operation({name,
                      std::string(meshRange) + "; radius 0.001 to 1 sizes, 4 to 64 stages" +
                          (crease ? ", creases of 0.1 to 2 radians" : ""),
                      Unit::largest, tolerance::radiusSmoothing, 7, 300},
                     [=](const Point& p) {
                         auto smooth = std::make_unique<Smoothed>(p, weights);
                         smooth->radius(logBetween(p[4], 1e-3, 1), 4 * uint32_t(logBetween(p[5], 1, 16.99)),
                                        crease ? logBetween(p[6], 0.1, 2) : 0);
                         return smooth;
                     });
}

}  // namespace

std::vector<Operation> smoothingOperations() {
    return {passes(), toRadius("smoothing to a radius, cotangents", PEL_SMOOTHING_COTANGENT, false),
            toRadius("smoothing to a radius, areas", PEL_SMOOTHING_AREA, false),
            toRadius("smoothing to a radius, creases", PEL_SMOOTHING_COTANGENT, true)};
}

}  // namespace stability
