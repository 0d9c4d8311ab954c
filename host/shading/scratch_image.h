// Images that passes make.
#pragma once
#include "shading/shader_plan.h"
#include "shared/shade_passes.h"

namespace pel {

// Gives `buffer` this many bytes; 0: none. An old one of another size is released before the new one is made.
void resize(Ref<Buffer>& buffer, const Ref<Device>& device, size_t bytes);

// An image as wide as the frame inside scratch memory.
ImageView scratchImage(const Ref<Buffer>& buffer, const ImageView& frame, PelFormat format,
                       uint64_t offset = 0);

// Rewrites the start of a PelShadeImage at `at` in `memory`: to where the image would begin if it also had
// the rows before `row`.
void moveImage(Device& device, cl_mem memory, size_t at, const ImageView& view, uint32_t row);

// A buffer that is written again only if its bytes differ.
class CachedUpload {
  public:
    // Returns the bytes sent.
    size_t update(Device& device, const void* bytes, size_t count);
    template <class T>
    size_t update(Device& device, const T& value) {
        return update(device, &value, sizeof value);
    }
    template <class T>
    size_t update(Device& device, const std::vector<T>& values) {
        return update(device, values.data(), values.size() * sizeof(T));
    }
    const cl::Memory& memory() const { return memory_; }
    size_t bytes() const { return bytes_.size(); }

  private:
    std::vector<unsigned char> bytes_;
    cl::Memory memory_;
};

// Images of three floats per pixel that a pass makes in a slot: planes, with a guard before and after each.
class ShadingConstants;

constexpr size_t planeGuardBytes = 2 * PEL_PLANE_GUARD * sizeof(float);
// Bytes of one plane with a value per pixel of a band, and of its guards.
size_t scratchPlaneBytes(const ShaderPlan& plan);

class ScratchPlanes {
  public:
    explicit ScratchPlanes(PelImageSlot slot) : slot_(slot) {}
    // Allocates the planes and puts them into their slot.
    void allocate(const Ref<Device>& device, ShaderPlan& plan);
    // Pass::moveScratch; not if another pass has replaced the slot.
    void move(Device& device, const ShaderPlan& plan, const ShadingConstants& constants, uint32_t row) const;
    const cl::Memory& memory() const { return buffer_->memory(); }
    size_t bytes() const { return buffer_ ? buffer_->bytes() : 0; }

  private:
    PelImageSlot slot_;
    Ref<Buffer> buffer_;
};

}  // namespace pel
