// The surface integral of a lit mesh (mathematics, section 9): pelSurfaceIntegral.
#pragma once
#include "mesh/vertex_view.h"

namespace pel {

// Throws unless every number is valid; the message names the triangle or vertex.
void checkSurfaceIntegral(const PelSurfaceIntegralDesc& desc);

// Enqueues the sums; the mesh is read during the call.
void surfaceIntegral(Device& device, const PelSurfaceIntegralDesc& desc, const VertexView& points,
                     const VertexView& result, bool blocking);

}  // namespace pel
