// PelScatter: scattering alone, for hosts that light their own frames.
#pragma once
#include "diffusion/screen_scatter.h"

namespace pel {

class Scatter final : public Object {
  public:
    static constexpr Kind kind = Kind::scatter;
    explicit Scatter(Ref<Device> device) : Object(kind), device_(device), screen_(std::move(device)) {}

    // A null profile removes the material.
    void setMaterial(uint32_t id, const Ref<Profile>& profile, float scale);
    void setControls(uint32_t id, const PelScatterControls& controls);
    void setImage(PelImageSlot slot, const ImageView& view);
    // Enqueues everything.
    void execute(const PelScatterParams& params, const ScatterImages& images);
    PelScatterStats stats();
    Device& device() const { return *device_; }

  private:
    ~Scatter() override = default;
    Ref<Device> device_;
    ScreenScatter screen_;
    std::map<uint32_t, ScreenScatter::Material> materials_;
    std::map<uint32_t, PelScatterControls> controls_;
    std::map<PelImageSlot, ImageView> images_;  // that executions read beside theirs
    std::vector<cl::Event> events_;
    bool executed_ = false;
    uint32_t pixels_ = 0;
};

}  // namespace pel
