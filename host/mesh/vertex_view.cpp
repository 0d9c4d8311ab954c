#include "mesh/vertex_view.h"

#include "core/handle_table.h"

namespace pel {

VertexView checkedView(const PelVertexView* view, const char* name, const Device& device, uint32_t count,
                       uint32_t components, const char* owner) {
    if (!view) invalidArgument("`", name, "` is needed, not NULL");
    if (view->count != count)
        invalidArgument("`", name, "` has ", view->count, " vertices, ", owner, " has ", count);
    if (count == 0) return {};
    const Ref<Buffer> held =
        about([&] { return fromHandle<Buffer>(view->buffer); }, "the buffer of `", name, "`");
    const Buffer& buffer = *held;
    if (&buffer.device() != &device)
        invalidArgument("the buffer of `", name, "` belongs to another device than ", owner);
    const uint64_t element = components * sizeof(float);
    const uint64_t stride = view->byteStride ? view->byteStride : element;
    if (view->byteOffset % 4 != 0 || stride % 4 != 0)
        invalidArgument("`", name, "` has offset ", view->byteOffset, " and stride ", stride,
                        " bytes; both must be multiples of 4");
    if (stride < element)
        invalidArgument("`", name, "` has stride ", stride, " bytes; its ", components, " floats need ",
                        element);
    if (view->byteOffset / 4 > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, "`", name, "` begins ", view->byteOffset,
             " bytes into its buffer; at most 16 GiB are supported");
    buffer.checkRange(view->byteOffset, (count - 1) * stride + element, name);
    return {buffer.memory(), {count, uint32_t(view->byteOffset / 4), uint32_t(stride / 4), 0}};
}

}  // namespace pel
