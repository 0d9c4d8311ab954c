// The passes before the shading kernel that make images which the caller did not give: blurred normals, wide shadows.
// Their programs and scratch memory exist only while something asks for them.
#pragma once
#include <vector>

#include "core/buffer.h"
#include "shared/shade_passes.h"

namespace pel {

struct ShaderState;
struct ShaderLight;
class ShadeTables;

class ShadePasses {
  public:
    // `state` with the images to be made in their slots; allocates them, and frees those no longer needed.
    ShaderState plan(const Ref<Device>& device, const ShaderState& state, uint32_t features);
    void build(Device& device, const ShaderState& plan, uint32_t features);
    // Returns the bytes sent.
    size_t upload(Device& device, const ShaderState& plan);
    void enqueue(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                 const cl::Memory& counters, std::vector<cl::Event>& events) const;
    size_t scratchBytes() const;

  private:
    void enqueueBlur(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                     std::vector<cl::Event>& events) const;

    uint32_t features_ = 0;
    std::vector<uint32_t> filteredLights_;   // of plan.lights
    std::vector<uint32_t> mappedMaterials_;  // ids
    Ref<Buffer> normals_, wideShadows_;      // what the shading kernel reads
    Ref<Buffer> positions_, between_, tags_;  // of the blur alone
    uint32_t planeValues_ = 0;                // from one plane of normals or positions to the next
    std::vector<cl::Memory> lightConstants_, mapConstants_;
    std::vector<std::vector<unsigned char>> sent_;  // what those hold
    cl::Program blurProgram_, mapProgram_, shadowProgram_;
};

// What the wide-shadow kernel needs of a light. Throws when worldToShadow does not tell across from along.
PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index);

}  // namespace pel
