// Shadow maps as lit surface beside a picture that scatters (docs/mathematics.md, section 10, "Light space").
#pragma once
#include "core/sized_memory.h"
#include "diffusion/light_maps.h"
#include "diffusion/scatter_images.h"
#include "shading/scratch_image.h"

namespace pel {

// Memory of ScreenScatter that the kernels read.
struct ScreenMemory {
    cl::Program program;  // with the files of LightSpace::addFiles
    cl::Memory frame, pyramid, tables, nodes, tiles, sums, counters;
    uint32_t width, height;
    size_t tileCount;
};

class LightSpace {
  public:
    explicit LightSpace(Ref<Device> device) : device_(std::move(device)) {}

    // Sets the variant of the program. `hidden`: occluded texels fill missing weight of the screen;
    // otherwise all texels are the far part of the sum; `half`: at every second pixel along both axes. All
    // maps have one format and one content. Without a map nothing is done.
    void announce(const std::vector<ShaderLight>& lights, bool hidden, bool half);
    // `narrowest`, `widest`: reach of the profiles, length. `blocks`: floats for the occluded light of the
    // screen's blocks.
    void prepare(const std::vector<ShaderLight>& lights, const float origin[3], double narrowest,
                 double widest, size_t tileCount, size_t blocks);
    bool empty() const { return empty_; }
    // Adds the kernels to a program that reads the same images: building separate programs takes drivers
    // longer.
    void addFiles(cl::ProgramKey& program) const;
    // Builds the lights' pyramids and classifies tiles; after the screen's pyramid and its tile flags.
    void enqueuePyramids(const ScatterImages& images, const ScreenMemory& screen,
                         std::vector<cl::Event>& events);
    // Sums occluded light; after the screen's sums by levels and before its last step.
    void enqueueHidden(const ScreenMemory& screen, std::vector<cl::Event>& events);
    const cl::Memory& hidden() const { return hiddenSums_.memory(); }
    // Sums over the texels only; after the irradiance has been copied to the output.
    void enqueueSums(const ScatterImages& images, const ScreenMemory& screen, std::vector<cl::Event>& events);
    static uint64_t bytesFor(const std::vector<ShaderLight>& lights, bool hidden);
    // Texels of these regions (PEL_LIGHT_REGION), one of each map.
    uint64_t texelsOf(const uint32_t (&regions)[PEL_LIGHT_MAPS][4]) const;
    size_t bytes() const {
        return pyramid_.bytes() + seen_.bytes() + hiddenSums_.bytes() + samples_.bytes() +
               2 * cells_[0].bytes() + maps_.size() * sizeof(PelLightMap);
    }

  private:
    void describeLevels();
    static uint64_t layOutLevels(std::vector<LightMap>& maps, bool hidden, uint64_t& seen, uint64_t& cells);

    Ref<Device> device_;
    std::vector<LightMap> maps_;
    std::vector<PelLightMap> sent_;
    bool empty_ = true, hidden_ = true, half_ = false, area_ = false;
    bool known_ = false;        // whether cells_[0] matches the pyramid, and seen_ is 0
    uint32_t frameNumber_ = 0;  // of those that were enqueued
    uint32_t mapFormat_ = 0, content_ = 0;
    CachedUpload mapUpload_;
    std::vector<cl::Memory> images_;  // distinct memory of the maps: PelLightMap.buffer
    SizedMemory pyramid_, seen_, parts_, hiddenSums_, samples_;
    SizedMemory cells_[2];  // which have flux: before this frame, now
};

}  // namespace pel
