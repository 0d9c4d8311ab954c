// The shading pass as one would first write it, for speed claims: a scalar C++ loop with OpenMP, and a
// straight OpenCL port with one work-item per pixel. One skin material, one directional light, a parallel
// shadow map; float32 images, tightly packed.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

namespace baseline {

struct ShadeTable {
    std::vector<float> texels;  // RGB
    int width = 0, height = 0;
};

struct ShadeFrame {
    int width = 0, height = 0;
    std::vector<uint8_t> id;  // 0: background
    std::vector<float> position, geometric, shading, blurred, curvature, albedo, wide;
    std::vector<float> map;
    int mapSize = 0;
};

struct ShadeSettings {
    float toLight[3], light[3], camera[3];
    float ambient[9][3];  // polynomial of the normal, as kernels/shared/shade.h has it
    float worldToShadow[16], depthRange;
    float rowsCurvature[2], rowsShadow[2];  // row in [0, 1] = scale * value + bias
    float penumbraPerCosine, sharpening;
    float deepScatter[3], deepScatterRadius, normalOffset, filterRadius;
    int taps;  // 0: no deep scatter
    float specular, roughness, f0;
    std::vector<float> disk;  // 2 * taps
};

// What the loop does about terms that come out as 0.
enum class Effort {
    Straight,  // every term of every pixel of a material
    Skipping,  // no taps where sat(0.3 - Nb.L) is 0, no specular where N.L <= 0, as the library
};

// out: RGB float32.
void shadeOpenMp(const ShadeFrame& frame, const ShadeSettings& settings, const ShadeTable& curvature,
                 const ShadeTable& shadow, Effort effort, std::vector<float>& out);

// Images are uploaded once; run() blocks.
class ShadePort {
  public:
    // OpenCL objects, of pelDeviceGetCl.
    ShadePort(void* context, void* device, void* queue, const ShadeFrame& frame,
              const ShadeSettings& settings, const ShadeTable& curvature, const ShadeTable& shadow);
    ~ShadePort();
    void run();
    std::vector<float> result();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace baseline
