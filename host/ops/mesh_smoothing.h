// Smoothing of values on a mesh: kernels/curvature.cl (uniform passes) and kernels/curvature_diffuse.cl (to a
// radius).
#pragma once
#include "ops/mesh_passes.h"

namespace pel {

// Planes of one value per slot, planeStride apart, in two memories that take turns; `from` holds the values.
struct SlotPlanes {
    uint32_t planes, planeStride;
    cl::Memory from, to;
};

void smoothUniform(MeshTopology& topology, const cl::Program& passes, uint32_t count, SlotPlanes& values);

// radius: length, > 0. crease: radians, 0: none. stages: 0: chosen from the mesh, which waits the first time.
void smoothToRadius(MeshTopology& topology, const SlotData& data, float radius, float crease, uint32_t stages,
                    SlotPlanes& values);

}  // namespace pel
