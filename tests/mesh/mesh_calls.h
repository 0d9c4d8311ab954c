// Descriptions of meshes and parameters of curvature, for tests and benchmarks.
#pragma once
#include "mesh_shapes.h"

namespace fixture {

inline PelMeshTopologyDesc topologyDesc(const Mesh& mesh) {
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    desc.numVertices = mesh.vertices();
    desc.indices = mesh.indices.data();
    desc.numIndices = mesh.indices.size();
    desc.positions = mesh.positions.data();
    return desc;
}

inline PelMeshTopologyDesc weldedDesc(const Mesh& mesh, float tolerance = 0) {
    PelMeshTopologyDesc desc = topologyDesc(mesh);
    desc.weld = tolerance > 0 ? PEL_WELD_TOLERANCE : PEL_WELD_EXACT;
    desc.weldTolerance = tolerance;
    return desc;
}

inline constexpr PelCurvatureEstimator allEstimators[] = {PEL_CURVATURE_EDGE, PEL_CURVATURE_TENSOR,
                                                          PEL_CURVATURE_QUADRIC};

inline PelCurvatureParams paramsOf(PelCurvatureEstimator estimator, uint32_t passes = 2,
                                   PelCurvatureQuantity quantity = PEL_QUANTITY_ABSOLUTE) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = estimator;
    params.quantity = quantity;
    params.smoothingPasses = passes;
    return params;
}

inline PelCurvatureParams edgeParams(uint32_t passes) {
    return paramsOf(PEL_CURVATURE_EDGE, passes);
}

// Signed mean curvature (of PEL_CURVATURE_EDGE the one quantity that it knows), smoothed to `radius`.
inline PelCurvatureParams meanParams(PelCurvatureEstimator estimator, float radius = 0,
                                     PelSmoothingWeights weights = PEL_SMOOTHING_COTANGENT) {
    PelCurvatureParams params =
        paramsOf(estimator, 0, estimator == PEL_CURVATURE_EDGE ? PEL_QUANTITY_ABSOLUTE : PEL_QUANTITY_MEAN);
    params.smoothingRadius = radius;
    params.smoothingWeights = weights;
    return params;
}

}  // namespace fixture
