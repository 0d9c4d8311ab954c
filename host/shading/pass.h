// A pass of shading: the host side of one kernel file. The shader keeps the needed passes of a list in order
// and calls the same functions of each. Passes exchange data only through the plan, so other folders may add
// passes: the list comes from host/api/shader.cpp.
#pragma once
#include "shading/shader_plan.h"

namespace pel {

class ShadingConstants;

// Memory for images that a pass makes.
struct PassScratch {
    uint64_t pixelBytes = 0;  // per pixel of a band
    uint64_t guardBytes = 0;  // in addition
    uint32_t haloRows = 0;    // rows of tiles that must exist before and after a band
    bool wholeFrame = false;  // pixels need others anywhere in the frame: there is one band
};

// Launches of one execution, or of one band of it.
struct PassWork {
    Device& device;
    const ShaderPlan& plan;
    const ShadingConstants& constants;
    std::vector<cl::Event>& events;
    TileRows rows{0, 0};    // those of the launches
    TileRows around{0, 0};  // those of the band with its halo
    uint64_t band = 0;
    bool interruptible = false;  // the caller waits, and may want progress
    bool written = false;        // set by the pass that writes the caller's images
    bool codeAlone = false;      // a warm-up: kernels are launched so that the driver compiles or loads them

    // Whether the band has no halo: then the launch around it also covered it.
    bool alone() const { return rows.begin == around.begin && rows.end == around.end; }
    uint32_t tiles() const { return (rows.end - rows.begin) * plan.tilesX; }
    void launch(cl::Launch& launch, const cl::Range& range) {
        events.push_back(device.launch(launch, range));
    }
    template <class... Values>
    void launch(const cl::Program& program, const char* kernel, const cl::Range& range,
                const Values&... values) {
        device.launch(events, program, kernel, range, values...);
    }
};

class Pass {
  public:
    virtual ~Pass() = default;

    // Memory. First the needs of images, before a band is chosen; then they are allocated and named in the
    // plan. Called again with another band if memory did not suffice: buffers of the right size are kept,
    // others are released before new ones are made.
    virtual PassScratch scratch(const ShaderPlan&) const { return {}; }
    virtual void allocate(const Ref<Device>&, ShaderPlan&) {}
    virtual size_t bytes() const { return 0; }  // held now

    // Programs.
    virtual std::vector<cl::ProgramKey> programs(const Device&, const ShaderPlan&) const = 0;
    void build(Device& device, const ShaderPlan& plan) {
        programs_.clear();
        for (const cl::ProgramKey& key : programs(device, plan))
            programs_.push_back(device.programs().get(key));
    }

    // Constants, sent if they changed. Returns the bytes sent.
    virtual size_t upload(Device&, ShaderPlan&) { return 0; }
    // Sets the first pixel row of scratch images in the constants; after `upload` it is 0.
    virtual void moveScratch(Device&, const ShaderPlan&, const ShadingConstants&, uint32_t /*row*/) {}

    // Launches: once in an execution; for a band with its halo; for a band.
    virtual void enqueueFrame(PassWork&) {}
    virtual void enqueueAround(PassWork&) {}
    virtual void enqueue(PassWork&) {}

    virtual void addStats(Device&, const ShaderPlan&, uint64_t /*bands*/, PelShaderStats&) const {}

  protected:
    const cl::Program& program(size_t index = 0) const { return programs_[index]; }

  private:
    std::vector<cl::Program> programs_;
};

// An entry of a list of passes. A pass that a state does not need is not made: it has no memory and no
// programs.
struct PassKind {
    bool (*needed)(const ShaderPlan& plan);
    std::unique_ptr<Pass> (*make)();
    std::string_view name;  // PelPassStats.name
    uint32_t methods = 0;   // bit i: the pass provides the PelScattering i
};
template <class P>
constexpr PassKind passKind(std::string_view name, uint32_t methods = 0) {
    return {P::needed, [] { return std::unique_ptr<Pass>(std::make_unique<P>()); }, name, methods};
}

// The passes of a shader, and the memory that they share.
class PassList {
  public:
    PassList() = default;
    explicit PassList(std::span<const PassKind> kinds) : kinds_(kinds), passes_(kinds.size()) {}

    // Makes the needed passes and drops the others. Their images hold as many rows of tiles as
    // PelShaderOptions.scratchBudget, memory and `mostRows` allow.
    void allocate(const Ref<Device>& device, ShaderPlan& plan, uint32_t mostRows);
    size_t bytes() const;
    // Bytes that the passes of a plan will take, if one of them works on the whole frame at once; else 0.
    uint64_t bytesOfWholeFrame(const ShaderPlan& plan);
    bool empty() const { return kinds_.empty(); }

    template <class Call>
    void each(Call&& call) const {
        for (const auto& pass : passes_)
            if (pass) call(*pass);
    }
    // The pass of a kind; nullptr: not needed.
    Pass* at(size_t kind) const { return kind < passes_.size() ? passes_[kind].get() : nullptr; }

  private:
    PassScratch choose(const ShaderPlan& plan);

    std::span<const PassKind> kinds_;
    std::vector<std::unique_ptr<Pass>> passes_;  // one for each kind; empty: not needed
};

// The passes of this folder, each in a file beside its kernel's.
extern const PassKind ambientCubePass, classifyTilesPass, blurNormalsPass, normalMapPass, shadowBoundsPass,
    wideShadowPass, irradiancePass, reflectionCubePass, environmentPass, irisesPass, tapCellsPass, shadePass;

}  // namespace pel
