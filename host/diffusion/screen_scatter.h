// Scatters the irradiance of a picture: the kernels of kernels/diffusion over plain inputs, for the shader's
// passes and for hosts that light their own frames.
#pragma once
#include "diffusion/light_space.h"
#include "diffusion/profile_table.h"
#include "shading/shading_constants.h"

namespace pel {

struct ScatterView {
    const float (&inverseViewProjection)[16];  // clip to world; all zero: not known, with positions
    const float (&position)[3];                // of the camera; all zero: not known
    float tolerance = 0;                       // of irradiance
    bool everywhere = false;                   // leave nothing out
};

// From where, or in which direction, a picture is seen.
struct Sight {
    PelUint32 view = PEL_VIEW_UNKNOWN;
    float origin[3] = {};     // of PEL_VIEW_POINT
    float direction[3] = {};  // unit, of PEL_VIEW_DIRECTION
    // Whether that is away from the camera, which its position tells; else it is that of increasing depth.
    bool away = false;
};
Sight sightOf(const ScatterView& view);
bool samePixels(const ImageView& a, const ImageView& b);

// The fields that PelDiffusionFrame and PelGatherFrame have in common, but for the kind of view.
template <class Frame>
void describePicture(const ScatterImages& images, const ScatterView& view, const Sight& sight, Frame& frame) {
    frame.width = images.irradiance.width, frame.height = images.irradiance.height;
    frame.tilesX = (frame.width + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE;
    frame.tilesY = (frame.height + PEL_DIFFUSION_TILE - 1) / PEL_DIFFUSION_TILE;
    std::ranges::copy(sight.origin, frame.origin);
    std::ranges::copy(sight.direction, frame.direction);
    std::ranges::copy(view.inverseViewProjection, frame.inverseViewProjection);
    frame.inPlace = samePixels(images.irradiance, images.out);
    frame.irradiance = describeImage(images.irradiance);
    frame.position = describeImage(images.positions ? images.positions : images.depth);
    frame.ids = describeImage(images.ids);
    frame.radii = describeImage(images.radii);
    frame.out = describeImage(images.out);
}

// Lights whose shadow maps serve as lit surface.
struct ScatterLights {
    std::vector<ShaderLight> lights;
    bool alone = false;  // true: the far part is the sum over texels; false: only occluded texels are added
    bool half = false;   // texels alone: summed at every second pixel along both axes
};

struct ScatterCounts {
    uint32_t tilesCovered, tilesTapped, pixelsCovered, pixelsTapped, taps, invalid, history;
};
struct LightCounts {
    uint32_t pixels, texels, tiles;
    uint64_t reached;  // texels of maps
};

// The distinct materials of all ids. `numberOf`: number of each id's material, from 1 on; 0: none.
template <class Material>
std::vector<Material> distinctOf(const std::map<uint32_t, Material>& materials,
                                 uint32_t (&numberOf)[PEL_DIFFUSION_IDS]) {
    std::vector<Material> distinct;
    std::ranges::fill(numberOf, 0);
    for (const auto& [id, material] : materials) {
        const auto found = std::ranges::find(distinct, material);
        numberOf[id] = uint32_t(found - distinct.begin()) + 1;
        if (found == distinct.end()) distinct.push_back(material);
    }
    return distinct;
}

class ScreenScatter {
  public:
    explicit ScreenScatter(Ref<Device> device) : device_(device), light_(std::move(device)) {}

    // The profile of pixels with each id, 1 to 255, and its lengths in the unit of positions.
    struct Material {
        Ref<Profile> profile;
        double scale;
        std::array<float, 3> gain{};  // length: as ShaderMaterial has it; 0: the medium is not known
        bool sheet = false;           // reflects its albedo, however thin it is
        bool operator==(const Material& other) const {
            return profile.get() == other.profile.get() && scale == other.scale && gain == other.gain &&
                   sheet == other.sheet;
        }
    };
    // Sets the lights, before `programs` is called; none by default.
    void announce(const ScatterLights& lights);
    // Allocates memory, and sends constants that have changed.
    void prepare(const std::map<uint32_t, Material>& materials, const ScatterImages& images,
                 const ScatterView& view);
    std::vector<cl::ProgramKey> programs(const ScatterImages& images) const;
    // Programs come from the device's cache.
    void enqueue(const ScatterImages& images, std::vector<cl::Event>& events);
    // Those of the sums over shadow maps go to `light`.
    ScatterCounts counts(LightCounts* light = nullptr);
    // Memory of a picture, beside tables.
    static uint64_t bytesFor(uint32_t width, uint32_t height, bool radii);
    size_t bytes() const {
        return pyramid_.bytes() + sums_.bytes() + nodeBytes_ + tiles_.bytes() + light_.bytes();
    }

  private:
    void sendTables(const std::map<uint32_t, Material>& materials);
    void describeLevels(uint32_t width, uint32_t height, bool radii);
    bool fillsHidden() const { return !light_.empty() && !lights_.alone; }
    ScreenMemory memory(const cl::Program& program) const;

    Ref<Device> device_;
    LightSpace light_;
    ScatterLights lights_;
    std::map<uint32_t, Material> materials_;
    PelDiffusionFrame frame_{};
    CachedUpload constants_;
    cl::Memory tables_, nodes_, counters_;
    SizedMemory pyramid_, sums_, tiles_;
    bool hasSides_ = false, byTexels_ = false;  // whether tables_ have directions; for sums over texels only
    double narrowest_ = 0, widest_ = 0;         // reach of the tables, length
    size_t nodeBytes_ = 0;
};

}  // namespace pel
