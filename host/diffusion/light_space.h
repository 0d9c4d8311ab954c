// Shadow maps as lit surface beside a picture that scatters (docs/mathematics.md, section 10, "Light space").
#pragma once
#include "diffusion/light_maps.h"
#include "diffusion/scatter_images.h"
#include "shading/cached_upload.h"

namespace pel {

// What ScreenScatter has on the device.
struct ScreenMemory {
    cl::Program program;  // with the files of LightSpace::addFiles
    cl::Memory frame, pyramid, tables, nodes, tiles, sums;
    uint32_t width, height;
    size_t tileCount;
};

struct LightCounts {
    uint32_t pixels, texels, tiles;
};

class LightSpace {
  public:
    explicit LightSpace(Ref<Device> device) : device_(std::move(device)) {}

    // What its program follows from. `hidden`: texels that the camera does not see fill what the screen misses; else all texels are
    // the far part of the sum. The format and the content of all maps are one. Without a map nothing is done.
    void announce(const std::vector<ShaderLight>& lights, bool hidden);
    // `narrowest`: reach of the profiles, length. `blocks`: floats that hold what is hidden from the screen's blocks.
    void prepare(const std::vector<ShaderLight>& lights, const float origin[3], double narrowest,
                 size_t tileCount, size_t blocks);
    bool empty() const { return empty_; }
    // Adds its kernels to a program that reads the same pictures: each program by itself takes drivers their time.
    void addFiles(cl::ProgramKey& program) const;
    // After the screen's pyramid and its words are made: the lights' pyramids, and what they matter to.
    void enqueuePyramids(const ScatterImages& images, const ScreenMemory& screen, std::vector<cl::Event>& events);
    // After the screen's sums by levels: what the camera does not see, for the screen's last step.
    void enqueueHidden(const ScreenMemory& screen, std::vector<cl::Event>& events);
    const cl::Memory& hidden() const { return hiddenMemory_; }
    // With the lights' texels alone, after the picture is copied.
    void enqueueSums(const ScatterImages& images, const ScreenMemory& screen, std::vector<cl::Event>& events);
    LightCounts counts();
    static uint64_t bytesFor(const std::vector<ShaderLight>& lights, bool hidden);
    size_t bytes() const {
        return pyramidBytes_ + seenBytes_ + hiddenBytes_ + 2 * cellBytes_ + maps_.size() * sizeof(PelLightMap);
    }

  private:
    void describeLevels();
    static uint64_t layOutLevels(std::vector<LightMap>& maps, bool hidden, uint64_t& seen, uint64_t& cells);
    cl::Range rows(const PelPyramidLevel& level) const;

    Ref<Device> device_;
    std::vector<LightMap> maps_;
    std::vector<PelLightMap> sent_;
    bool empty_ = true, hidden_ = true;
    bool cellsKnown_ = false;  // whether cells_[0] says what the pyramid holds
    uint32_t mapFormat_ = 0, content_ = 0;
    CachedUpload mapUpload_;
    cl::Memory pyramid_, seen_, parts_, hiddenMemory_, counters_;
    cl::Memory cells_[2];  // which have flux: before this frame, now
    size_t pyramidBytes_ = 0, seenBytes_ = 0, partBytes_ = 0, hiddenBytes_ = 0, cellBytes_ = 0;
};

}  // namespace pel
