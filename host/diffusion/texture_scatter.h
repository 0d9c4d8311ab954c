// PelTextureScatter: scattering in the texture of a mesh (kernels/diffusion/texture_map.cl and
// scatter_texture.cl).
#pragma once
#include "core/image_view.h"
#include "core/launch_policy.h"
#include "diffusion/gaussian_chain.h"
#include "mesh/vertex_view.h"
#include "shared/texture_scatter.h"

namespace pel {

class TextureScatter final : public Object {
  public:
    static constexpr Kind kind = Kind::textureScatter;
    // Throws if the mesh is wrong.
    static Ref<TextureScatter> create(const Ref<Device>& device, const PelTextureScatterDesc& desc);

    // Each enqueues its work.
    void setPositions(const VertexView& positions);
    void draw(const VertexView& values, bool unit, const ImageView& out);
    void execute(const PelTextureScatterParams& params, const Ref<Profile>& profile,
                 const ImageView& irradiance, const ImageView& albedo, const ImageView& out);
    PelTextureScatterStats stats();
    Device& device() const { return *device_; }
    uint32_t vertices() const { return vertices_; }

  private:
    TextureScatter(const Ref<Device>& device, const PelTextureScatterDesc& desc)
        : Object(kind),
          device_(device),
          width_(desc.width),
          height_(desc.height),
          vertices_(desc.numVertices) {}
    ~TextureScatter() override = default;
    void drawMesh(const std::vector<uint32_t>& indices, const std::vector<float>& uvs);
    void describe(const ImageView& irradiance, const ImageView& albedo, const ImageView& out, float before,
                  float after);
    void checkSize(const ImageView& view, const char* name) const;
    cl::Program program(const char* file, const ImageView& irradiance, const ImageView& albedo,
                        const ImageView& out) const;
    template <class... Values>
    void launch(const cl::Program& program, const char* kernel, size_t items, const Values&... values) {
        if (items) device_->launch(events_, program, kernel, itemRange(*device_, items), values...);
    }
    size_t texels() const { return size_t(width_) * height_; }
    uint32_t tilesX() const { return (width_ + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE; }
    uint32_t tiles() const { return tilesX() * ((height_ + PEL_TEXTURE_TILE - 1) / PEL_TEXTURE_TILE); }

    Ref<Device> device_;
    uint32_t width_, height_, vertices_, triangles_ = 0;
    PelTextureFrame frame_{};
    cl::Memory frameMemory_, indices_, uvs_, islands_, owners_, tileFlags_, counters_, stretch_;
    cl::Memory light_, blurred_, result_, blurs_;  // of executions
    bool placed_ = false;
    GaussianChain chain_{};
    Ref<Profile> chainOf_;
    uint32_t chainMost_ = 0;
    std::vector<cl::Event> events_;
};

}  // namespace pel
