// Irradiance of a picture scattered by a few taps: on a disk (kernels/diffusion/scatter_disk.cl) or along
// two lines (scatter_separable.cl).
#pragma once
#include <bitset>

#include "diffusion/screen_scatter.h"
#include "shared/gather.h"

namespace pel {

struct GatherImages {
    ScatterImages of;
    ImageView weight;   // may be empty
    bool half = false;  // gathered at every second pixel along both axes
    // Light from beyond pixels goes to `of.out`, tightly packed RGBA32F; the result to `out`.
    struct History {
        float weight = 0;    // as PelShaderOptions.historyWeight; 0: none
        uint32_t cut = 0;    // historyCut
        ImageView motion{};  // may be empty
        ImageView out{};
    } history{};
};

class GatherScatter {
  public:
    enum class Form { disk, lines };
    GatherScatter(Ref<Device> device, Form form) : device_(std::move(device)), form_(form) {}

    struct Material {
        Ref<Profile> profile;
        double scale;
        uint32_t taps;
        std::array<float, 3> border;
        bool operator==(const Material& other) const {
            return profile.get() == other.profile.get() && scale == other.scale && taps == other.taps &&
                   border == other.border;
        }
    };
    using Ids = std::bitset<PEL_DIFFUSION_IDS>;
    // Allocates memory, and sends constants that have changed. `sources`: ids whose light may flow over
    // borders.
    void prepare(const std::map<uint32_t, Material>& materials, const Ids& sources,
                 const GatherImages& images, const ScatterView& view, uint32_t frameIndex);
    std::vector<cl::ProgramKey> programs(const GatherImages& images) const;
    // Programs come from the device's cache.
    void enqueue(const GatherImages& images, std::vector<cl::Event>& events);
    ScatterCounts counts();
    size_t bytes() const {
        return points_.bytes() + rows_.bytes() + tableBytes_ + tiles_.bytes() + samples_.bytes() +
               history_[0].bytes() + history_[1].bytes();
    }
    // Memory of a picture, beside tables.
    static uint64_t pixelBytes(Form form, bool half, bool history) {
        return (PEL_GATHER_FLOATS + (form == Form::lines ? 4 : 0) + (half ? 1 : 0) + (history ? 8 : 0)) *
               sizeof(float);
    }

  private:
    // Properties of frames that share a history.
    struct Sequence {
        uint32_t width, height, view, cut;
        bool operator==(const Sequence&) const = default;
    };
    void blendHistory(const GatherImages& images, const cl::Program& program, std::vector<cl::Event>& events);
    void sendMaterials(const std::map<uint32_t, Material>& materials);

    Ref<Device> device_;
    const Form form_;
    std::map<uint32_t, Material> materials_;
    PelGatherFrame frame_{};
    CachedUpload constants_;
    cl::Memory described_, taps_, nodes_, counters_;
    SizedMemory points_, rows_, samples_, tiles_;
    SizedMemory history_[2];  // up to the last frame, and up to this one
    std::optional<Sequence> sequence_;
    cl_float4 lastView_{};  // origin or direction; see blend_history.cl
    size_t tableBytes_ = 0;
};

}  // namespace pel
