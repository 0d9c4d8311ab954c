#include "diffusion/texture_scatter.h"

#include <cmath>
#include <cstring>

namespace pel {
namespace {

constexpr uint32_t largestSide = 16384;

[[noreturn]] void notYet(const char* call) {
    fail(PEL_ERROR_UNSUPPORTED, call, " is not in this build of the library");
}

}  // namespace

Ref<TextureScatter> TextureScatter::create(const Ref<Device>& device, const PelTextureScatterDesc& desc) {
    if (desc.width < 1 || desc.height < 1 || desc.width > largestSide || desc.height > largestSide)
        invalidArgument("PelTextureScatterDesc is ", desc.width, " x ", desc.height, " texels; 1 to ",
                        largestSide, " each would be right");
    if (desc.numIndices % 3)
        invalidArgument("PelTextureScatterDesc.numIndices is ", desc.numIndices,
                        ", which is no multiple of 3");
    if (desc.numIndices > UINT32_MAX)
        fail(PEL_ERROR_UNSUPPORTED, "PelTextureScatterDesc.numIndices is ", desc.numIndices, "; ", UINT32_MAX,
             " is the most");
    if (desc.numIndices && !desc.indices) invalidArgument("PelTextureScatterDesc.indices is NULL");
    if (desc.numVertices && !desc.uvs) invalidArgument("PelTextureScatterDesc.uvs is NULL");
    const uint32_t stride = desc.uvStride ? desc.uvStride : 2 * sizeof(float);
    if (stride < 2 * sizeof(float))
        invalidArgument("PelTextureScatterDesc.uvStride is ", stride, " bytes; u and v need 8");
    for (uint64_t i = 0; i < desc.numIndices; ++i)
        if (desc.indices[i] >= desc.numVertices)
            invalidArgument("triangle ", i / 3, " has the vertex ", desc.indices[i], " of ", desc.numVertices);
    const Ref<TextureScatter> made = Ref<TextureScatter>::adopt(new TextureScatter(device, desc));
    made->indices_.assign(desc.indices, desc.indices + desc.numIndices);
    made->uvs_.resize(2 * size_t(desc.numVertices));
    for (uint32_t i = 0; i < desc.numVertices; ++i) {
        float* uv = &made->uvs_[2 * size_t(i)];
        std::memcpy(uv, reinterpret_cast<const char*>(desc.uvs) + size_t(i) * stride, 2 * sizeof(float));
        if (!(uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1))
            invalidArgument("vertex ", i, " has the texture coordinates (", uv[0], ", ", uv[1],
                            "); from 0 to 1 would be right");
    }
    return made;
}

void TextureScatter::setPositions(const VertexView&) {
    notYet("pelTextureScatterSetPositions");
}

void TextureScatter::draw(const VertexView&, bool, const ImageView&) {
    notYet("pelTextureScatterDraw");
}

void TextureScatter::execute(const PelTextureScatterParams&, const Ref<Profile>&, const ImageView&,
                             const ImageView&, const ImageView&) {
    notYet("pelTextureScatterExecute");
}

PelTextureScatterStats TextureScatter::stats() {
    PelTextureScatterStats stats = pelTextureScatterStatsDefaults();
    stats.texelsTotal = uint64_t(width_) * height_;
    stats.tilesTotal = uint64_t((width_ + 15) / 16) * ((height_ + 15) / 16);
    return stats;
}

}  // namespace pel
