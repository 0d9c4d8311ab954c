// A PelVertexView, checked.
#pragma once
#include "core/buffer.h"
#include "shared/mesh.h"

namespace pel {

struct VertexView {
    cl::Memory memory;  // empty when there are no vertices
    VertexLayout layout{};
};

// Throws unless the view holds `count` vertices (as many as `owner` has) of `components` floats inside a
// buffer of `device`.
VertexView checkedView(const PelVertexView* view, const char* name, const Device& device, uint32_t count,
                       uint32_t components, const char* owner = "the topology");

}  // namespace pel
