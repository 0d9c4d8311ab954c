// PelTextureScatter: scattering in the texture of a mesh.
#pragma once
#include <vector>

#include "core/image_view.h"
#include "lut/profile.h"
#include "mesh/vertex_view.h"

namespace pel {

class TextureScatter final : public Object {
  public:
    static constexpr Kind kind = Kind::textureScatter;
    // Throws where the mesh is none.
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
        : Object(kind), device_(device), width_(desc.width), height_(desc.height), vertices_(desc.numVertices) {}
    ~TextureScatter() override = default;

    Ref<Device> device_;
    uint32_t width_, height_, vertices_;
    std::vector<uint32_t> indices_;
    std::vector<float> uvs_;
};

}  // namespace pel
