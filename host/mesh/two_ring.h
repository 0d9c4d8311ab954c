// The two-rings of a mesh as lists of points (shared/mesh.h), for the quadric estimator.
#pragma once
#include "mesh/mesh_topology.h"

namespace pel {

// The lists of the topology, made at the first call, which waits until they are there, on a queue of its
// own. `program` holds two_ring.cl. Call with the topology's lock held.
const MeshTopology::TwoRings& twoRings(MeshTopology& topology, const cl::Program& program);

}  // namespace pel
