// The passes before the shading kernel that make images which the caller did not give: blurred normals, wide shadows.
// Their programs and scratch memory exist only while something asks for them.
#pragma once
#include <optional>
#include <vector>

#include "core/buffer.h"
#include "shared/shade_passes.h"

namespace pel {

struct ImageView;
struct ShaderState;
struct ShaderLight;
class ShadeTables;

class ShadePasses {
  public:
    // `state` with the images to be made in their slots; allocates them, and frees those no longer needed. They hold as many
    // rows of tiles as PelShaderOptions.scratchBudget, memory and `mostRows` allow, and those that a blur reads round them.
    ShaderState plan(const Ref<Device>& device, const ShaderState& state, uint32_t features, uint32_t mostRows = UINT32_MAX);
    uint32_t bandRows() const { return bandRows_; }  // rows of tiles that can be shaded at a time
    uint32_t haloRows() const { return haloRows_; }  // that prepare() needs before and after them
    bool any() const { return scratchPixelBytes_ > 0; }
    void build(Device& device, const ShaderState& plan, uint32_t features);
    // Returns the bytes sent.
    size_t upload(Device& device, const ShaderState& plan);
    // Says in all constants that the images begin at this row of pixels.
    void moveScratch(Device& device, const ShaderState& plan, const ShadeTables& tables, uint32_t row);
    // What has to be there in the halo too; then the rest. `list` and the band of `tables` say where.
    void prepare(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list, uint32_t tiles,
                 std::vector<cl::Event>& events) const;
    void enqueue(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                 const cl::Memory& counters, uint32_t tiles, std::vector<cl::Event>& events) const;
    size_t scratchBytes() const;

  private:
    void chooseBand(const ShaderState& state, uint32_t mostRows);
    void allocate(const Ref<Device>& device, const ImageView& frame);
    uint32_t scratchRows(uint32_t frameHeight) const;  // pixels
    void enqueueBlur(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                     uint32_t tiles, bool alongY, std::vector<cl::Event>& events) const;

    // A shadow map whose blocks' bounds are kept: of a light of filteredLights_.
    struct BoundedMap {
        uint32_t filtered, cascade;
        uint32_t blocks;
        uint32_t offset;  // of its bounds in bounds_, floats
    };

    uint32_t features_ = 0, bandRows_ = 0, haloRows_ = 0;
    uint32_t scratchPixelBytes_ = 0;  // of all images together
    std::optional<uint32_t> scratchRow_;  // in the device's constants; empty: it has to be written
    std::vector<uint32_t> filteredLights_;   // of plan.lights
    std::vector<uint32_t> mappedMaterials_;  // ids
    Ref<Buffer> normals_, wideShadows_;      // what the shading kernel reads
    std::vector<BoundedMap> boundedMaps_;
    Ref<Buffer> bounds_;                      // of the wide shadows alone
    Ref<Buffer> positions_, between_, tags_;  // of the blur alone
    uint32_t planeValues_ = 0;                // from one plane of normals or positions to the next
    std::vector<cl::Memory> lightConstants_, mapConstants_;
    std::vector<std::vector<unsigned char>> sent_;  // what those hold
    cl::Program blurProgram_, mapProgram_, shadowProgram_;
};

// What the wide-shadow kernel needs of a light's map, or of the cascade-th of them. Throws when its matrix does not tell across
// from along.
PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index, uint32_t cascade = 0);

}  // namespace pel
