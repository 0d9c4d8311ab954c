// PelScatter: scattering alone, for hosts that light their own frames.
#pragma once
#include "core/build_jobs.h"
#include "diffusion/blend_scatter.h"
#include "diffusion/gather_scatter.h"
#include "diffusion/mean_curvature.h"

namespace pel {

class Scatter final : public Object {
  public:
    static constexpr Kind kind = Kind::scatter;
    explicit Scatter(Ref<Device> device)
        : Object(kind),
          device_(device),
          screen_(device),
          disk_(device, GatherScatter::Form::disk),
          lines_(device, GatherScatter::Form::lines),
          before_(device),
          after_(std::move(device)) {}

    // A null profile removes the material.
    void setMaterial(uint32_t id, const Ref<Profile>& profile, float scale);
    void setControls(uint32_t id, const PelScatterControls& controls);
    void setImage(PelImageSlot slot, const ImageView& view);
    // Enqueues everything.
    void execute(const PelScatterParams& params, const ScatterImages& images);
    // Jobs for a warm-up: they build the programs for such images, and scatter a small image.
    void addBuildJobs(const PelScatterParams& params, const ScatterImages& images, BuildJobs& jobs) const;
    PelScatterStats stats();
    Device& device() const { return *device_; }

  private:
    struct Plan {
        std::map<uint32_t, ScreenScatter::Material> screen;
        std::map<uint32_t, GatherScatter::Material> disk, lines;
        GatherScatter::Ids sources;
        ImageView weight;
        ImageView curvature;                // the caller's, if a material has a gain
        bool measures = false;              // it is needed, but not given
        std::map<uint32_t, float> windows;  // lengths over which it is measured, by id
        std::map<uint32_t, PelBlendMaterial> blend;
        PelBlendMaterial other{};  // of ids that do not scatter
        bool prepares = false, finishes = false;
    };
    ~Scatter() override = default;
    Plan planOf(const PelScatterParams& params, const ScatterImages& images) const;
    // With `keys` it only names the programs.
    void run(const PelScatterParams& params, const ScatterImages& images, std::vector<cl::ProgramKey>* keys);
    PelScatterControls controlsOf(uint32_t id) const;
    void capture(const PelScatterParams& params, const ScatterImages& images);
    ImageView image(PelImageSlot slot) const;
    ImageView scratch(size_t index, const ImageView& like);

    Ref<Device> device_;
    ScreenScatter screen_;
    GatherScatter disk_, lines_;
    BlendScatter before_, after_;
    MeanCurvature curvature_;
    Ref<Buffer> measured_;
    std::array<Ref<Buffer>, 3> scratch_;
    std::map<uint32_t, ScreenScatter::Material> materials_;
    std::map<uint32_t, PelScatterControls> controls_;
    std::map<PelImageSlot, ImageView> images_;  // further images, kept between executions
    std::vector<std::pair<PelScattering, std::function<ScatterCounts()>>> counts_;  // of the methods that ran
    std::vector<cl::Event> events_;
    bool executed_ = false, captureAsked_ = false;
    uint32_t pixels_ = 0;
};

}  // namespace pel
