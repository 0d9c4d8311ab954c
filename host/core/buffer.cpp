#include "core/buffer.h"

namespace pel {

Buffer::Buffer(Ref<Device> device, cl::Memory memory, size_t bytes)
    : Object(kind), device_(std::move(device)), memory_(std::move(memory)), bytes_(bytes) {
    // Location of the bytes, which other buffers may view, too: in host memory, or a part of a cl_mem.
    const cl_mem own = memory_.get(), whole = cl::info<cl_mem>(own, CL_MEM_ASSOCIATED_MEMOBJECT);
    void* const host = cl::info<void*>(own, CL_MEM_HOST_PTR);
    place_ = host    ? Place{nullptr, reinterpret_cast<uintptr_t>(host)}
             : whole ? Place{whole, cl::info<size_t>(own, CL_MEM_OFFSET)}
                     : Place{memory_.get(), 0};
}

Buffer::~Buffer() {
    if (mapped_) clEnqueueUnmapMemObject(device_->queue(), memory_.get(), mapped_, 0, nullptr, nullptr);
}

Ref<Buffer> Buffer::create(Ref<Device> device, size_t bytes, const void* initial) {
    if (bytes == 0) invalidArgument("a buffer of 0 bytes was asked for; at least 1 is needed");
    cl::Memory memory = initial ? device->allocate(bytes, initial) : device->allocateZeros(bytes);
    return make<Buffer>(std::move(device), std::move(memory), bytes);
}

Ref<Buffer> Buffer::createFromHost(Ref<Device> device, void* host, size_t bytes) {
    if (!host || bytes == 0) invalidArgument("a buffer from host memory needs a pointer and at least 1 byte");
    cl_int code = CL_SUCCESS;
    cl::Memory memory(
        clCreateBuffer(device->context(), CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, host, &code));
    cl::check(code, "clCreateBuffer(from host memory)");
    return make<Buffer>(std::move(device), std::move(memory), bytes);
}

Ref<Buffer> Buffer::createFromCl(Ref<Device> device, cl_mem mem) {
    if (!mem) invalidArgument("a cl_mem is needed, not NULL");
    if (cl::info<cl_context>(mem, CL_MEM_CONTEXT) != device->context())
        invalidArgument("the cl_mem belongs to another cl_context than the device");
    const auto type = cl::info<cl_mem_object_type>(mem, CL_MEM_TYPE);
    if (type == CL_MEM_OBJECT_BUFFER)
        return make<Buffer>(std::move(device), cl::Memory::retained(mem), cl::info<size_t>(mem, CL_MEM_SIZE));
    if (type != CL_MEM_OBJECT_IMAGE2D)
        invalidArgument("the cl_mem is an image of another kind than image2d; that, or a buffer, is needed");
    const auto ofImage = [&](cl_image_info what) {
        size_t value = 0;
        cl::check(clGetImageInfo(mem, what, sizeof value, &value, nullptr), "clGetImageInfo");
        return value;
    };
    const size_t width = ofImage(CL_IMAGE_WIDTH), height = ofImage(CL_IMAGE_HEIGHT);
    const Ref<Buffer> copy =
        create(std::move(device), width * height * ofImage(CL_IMAGE_ELEMENT_SIZE), nullptr);
    copy->texture_ = cl::Memory::retained(mem);
    copy->texels_ = {width, height, 1};
    return copy;
}

void Buffer::copyTexture(bool back) const {
    constexpr size_t origin[3] = {};
    if (back)
        cl::check(clEnqueueCopyBufferToImage(device_->queue(), memory_.get(), texture_.get(), 0, origin,
                                             texels_.data(), 0, nullptr, nullptr),
                  "clEnqueueCopyBufferToImage");
    else
        cl::check(clEnqueueCopyImageToBuffer(device_->queue(), texture_.get(), memory_.get(), origin,
                                             texels_.data(), 0, 0, nullptr, nullptr),
                  "clEnqueueCopyImageToBuffer");
}

void Buffer::checkRange(uint64_t offset, uint64_t bytes, const char* what) const {
    if (offset > bytes_ || bytes > bytes_ - offset)
        invalidArgument(what, " needs bytes ", offset, " to ", offset + bytes, " of a buffer of ", bytes_,
                        " bytes");
}

void* Buffer::map() {
    std::lock_guard lock(mutex_);
    if (mapCount_ == 0) {
        cl_int code = CL_SUCCESS;
        mapped_ = clEnqueueMapBuffer(device_->queue(), memory_.get(), CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0,
                                     bytes_, 0, nullptr, nullptr, &code);
        cl::check(code, "clEnqueueMapBuffer");
    }
    ++mapCount_;
    return mapped_;
}

void Buffer::unmap() {
    std::lock_guard lock(mutex_);
    if (mapCount_ == 0) fail(PEL_ERROR_INVALID_STATE, "pelBufferUnmap on a buffer that is not mapped");
    if (--mapCount_ > 0) return;
    cl::check(clEnqueueUnmapMemObject(device_->queue(), memory_.get(), std::exchange(mapped_, nullptr), 0,
                                      nullptr, nullptr),
              "clEnqueueUnmapMemObject");
}

}  // namespace pel
