#include "diffusion/texture_scatter.h"

#include <cstring>
#include <numeric>

#include "shading/check_settings.h"
#include "shading/launch_ranges.h"
#include "shading/shading_constants.h"

namespace pel {
namespace {

constexpr uint32_t largestSide = 16384;
constexpr size_t texelBytes = 4 * sizeof(float);

// Number from 1 of the connected part of the mesh that each triangle belongs to.
std::vector<uint32_t> islandsOf(const std::vector<uint32_t>& indices, uint32_t vertices) {
    std::vector<uint32_t> parent(vertices);
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (size_t i = 0; i + 2 < indices.size(); i += 3)
        for (size_t k = 1; k < 3; ++k) parent[root(indices[i + k])] = root(indices[i]);
    std::vector<uint32_t> islands;
    for (size_t i = 0; i + 2 < indices.size(); i += 3) islands.push_back(root(indices[i]) + 1);
    return islands;
}

void checkParams(const PelTextureScatterParams& params, const Profile& profile, const ImageView& albedo) {
    if (!(params.scale > 0) || !std::isfinite(params.scale))
        invalidArgument("PelTextureScatterParams.scale is ", params.scale,
                        "; a length above 0 is needed, in units of positions per unit of the profile");
    for (double width : profile.shape().width()) {
        width *= params.scale;
        if (!(width > 1e-15 && width < 1e15))
            invalidArgument("PelTextureScatterParams.scale is ", params.scale, ", and makes the profile ",
                            width, " wide; 1e-15 to 1e15 would do");
    }
    if (!(params.albedoBefore >= 0 && params.albedoBefore <= 1))
        invalidArgument("PelTextureScatterParams.albedoBefore is ", params.albedoBefore,
                        "; it must be between 0 and 1");
    if (params.gaussians < 2 || params.gaussians > 12)
        invalidArgument("PelTextureScatterParams.gaussians is ", params.gaussians,
                        "; 2 to 12 would be right");
    if ((params.albedoBefore > 0 || params.albedoAfter) && !albedo)
        invalidArgument("PelTextureScatterParams.", params.albedoAfter ? "albedoAfter" : "albedoBefore",
                        " is set, but there is no albedo image");
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
            invalidArgument("triangle ", i / 3, " has the vertex ", desc.indices[i], " of ",
                            desc.numVertices);
    const std::vector<uint32_t> indices(desc.indices, desc.indices + desc.numIndices);
    std::vector<float> uvs(2 * size_t(desc.numVertices));
    for (uint32_t i = 0; i < desc.numVertices; ++i) {
        float* uv = &uvs[2 * size_t(i)];
        std::memcpy(uv, reinterpret_cast<const char*>(desc.uvs) + size_t(i) * stride, 2 * sizeof(float));
        if (!(uv[0] >= 0 && uv[0] <= 1 && uv[1] >= 0 && uv[1] <= 1))
            invalidArgument("vertex ", i, " has the texture coordinates (", uv[0], ", ", uv[1],
                            "); from 0 to 1 would be right");
    }
    const Ref<TextureScatter> made = Ref<TextureScatter>::adopt(new TextureScatter(device, desc));
    made->drawMesh(indices, uvs);
    return made;
}

void TextureScatter::drawMesh(const std::vector<uint32_t>& indices, const std::vector<float>& uvs) {
    triangles_ = uint32_t(indices.size() / 3);
    indices_ = device_->upload(indices);
    uvs_ = device_->upload(uvs);
    islands_ = device_->upload(islandsOf(indices, vertices_));
    owners_ = device_->allocate(texels() * sizeof(cl_uint));
    tileFlags_ = device_->allocate(tiles() * sizeof(cl_uint));
    counters_ = device_->allocate(PEL_TEXTURE_COUNTERS * sizeof(cl_uint));
    device_->fill(owners_.get(), 0, texels() * sizeof(cl_uint), 0);
    device_->fill(counters_.get(), 0, PEL_TEXTURE_COUNTERS * sizeof(cl_uint), 0);
    describe({}, {}, {}, 0, 0);
    const cl::Program map = program("diffusion/texture_map.cl", {}, {}, {});
    launch(map, "texture_owner", triangles_, frameMemory_, indices_, uvs_, owners_);
    launch(map, "texture_tiles", tiles(), frameMemory_, owners_, tileFlags_, counters_);
    events_.clear();
}

void TextureScatter::describe(const ImageView& irradiance, const ImageView& albedo, const ImageView& out,
                              float before, float after) {
    PelTextureFrame frame{};
    frame.width = width_, frame.height = height_, frame.tilesX = tilesX();
    frame.triangles = triangles_;
    frame.before = before, frame.after = after;
    frame.irradiance = describeImage(irradiance);
    frame.albedo = describeImage(albedo);
    frame.out = describeImage(out);
    if (frameMemory_ && !std::memcmp(&frame, &frame_, sizeof frame)) return;
    frameMemory_ = device_->allocate(sizeof frame, &frame);
    frame_ = frame;
}

cl::Program TextureScatter::program(const char* file, const ImageView& irradiance, const ImageView& albedo,
                                    const ImageView& out) const {
    // A program needs some format to store in, also where it stores nothing.
    return device_->programs().get(
        {{file},
         {{"PEL_WIDTH", 1},
          {"PEL_FORMAT_IRRADIANCE", formatCode(irradiance, 1)},
          {"PEL_FORMAT_ALBEDO", formatCode(albedo, 1)},
          {"PEL_FORMAT_OUT", out ? formatCode(out, 1) : uint32_t(PEL_FORMAT_RGB32F)}}});
}

void TextureScatter::checkSize(const ImageView& view, const char* name) const {
    if (view.width != width_ || view.height != height_)
        invalidArgument("the ", name, " image is ", view.width, " x ", view.height, ", the texture ", width_,
                        " x ", height_, "; they must have one size");
}

void TextureScatter::setPositions(const VertexView& positions) {
    events_.clear();
    const cl::Program map = program("diffusion/texture_map.cl", {}, {}, {});
    cl::Memory stretch = stretch_;
    if (!stretch_) {
        stretch = device_->allocate(texels() * texelBytes);
        device_->fill(stretch.get(), 0, texels() * texelBytes, 0);
    }
    launch(map, "texture_stretch", texels(), frameMemory_, indices_, uvs_, positions, owners_, stretch);
    if (!stretch_)
        launch(map, "texture_edges", width_ + height_, frameMemory_, indices_, uvs_, positions, islands_,
               owners_, stretch);
    stretch_ = std::move(stretch);
    placed_ = true;
}

void TextureScatter::draw(const VertexView& values, bool unit, const ImageView& out) {
    checkImage(PEL_SLOT_RADIANCE, out);
    checkSize(out, "output");
    describe({}, {}, out, 0, 0);
    events_.clear();
    launch(program("diffusion/texture_map.cl", {}, {}, out), "texture_draw", texels(), frameMemory_, indices_,
           uvs_, values, owners_, cl_uint(unit), out);
}

void TextureScatter::execute(const PelTextureScatterParams& params, const Ref<Profile>& profile,
                             const ImageView& irradiance, const ImageView& albedo, const ImageView& out) {
    if (!placed_)
        fail(PEL_ERROR_INVALID_STATE,
             "the mesh has no positions yet: pelTextureScatterSetPositions comes first");
    checkParams(params, *profile, albedo);
    checkImage(PEL_SLOT_IRRADIANCE, irradiance);
    checkSize(irradiance, "irradiance");
    checkImage(PEL_SLOT_RADIANCE, out);
    checkSize(out, "output");
    if (overlapsElsewhere(out, irradiance))
        invalidArgument("the output overlaps the irradiance image, but not at the same texels");
    if (albedo) {
        checkImage(PEL_SLOT_ALBEDO, albedo);
        checkSize(albedo, "albedo");
        if (sharesBytes(out, albedo)) invalidArgument("the output overlaps the albedo image, which is read");
    }
    if (chainOf_.get() != profile.get() || chainMost_ != params.gaussians)
        chain_ = gaussianChain(*profile, params.gaussians), chainOf_ = profile, chainMost_ = params.gaussians;
    std::vector<PelTextureBlur> blurs;
    double before = 0;
    for (const GaussianTerm& term : chain_.terms) {
        PelTextureBlur blur{};
        blur.variance = float((term.variance - before) * params.scale * params.scale);
        blur.before = float(before * params.scale * params.scale);
        before = term.variance;
        for (int c = 0; c < 3; ++c) blur.weight[c] = float(term.weight[c]);
        blurs.push_back(blur);
        blur.down = 1, blur.first = blurs.size() == 1;
        blurs.push_back(blur);
    }
    for (cl::Memory* memory : {&light_, &blurred_, &result_})
        if (!*memory) *memory = device_->allocate(texels() * texelBytes);
    blurs_ = device_->upload(blurs);
    describe(irradiance, albedo, out, params.albedoBefore, params.albedoAfter ? 1 - params.albedoBefore : 0);
    device_->fill(counters_.get(), PEL_COUNT_TEXELS_INVALID * sizeof(cl_uint), sizeof(cl_uint), 0);
    events_.clear();
    const cl::Program kernels = program("diffusion/scatter_texture.cl", irradiance, albedo, out);
    launch(kernels, "texture_light", texels(), frameMemory_, stretch_, irradiance, albedo, light_, counters_);
    for (uint32_t i = 0; i < blurs.size(); ++i)
        device_->launch(events_, kernels, "texture_blur", groupRange(*device_, groupsFor(*device_, tiles())),
                        frameMemory_, blurs_, cl_uint(i), stretch_, tileFlags_, i % 2 ? blurred_ : light_,
                        i % 2 ? light_ : blurred_, result_);
    launch(kernels, "texture_result", texels(), frameMemory_, light_, result_, albedo, out);
}

PelTextureScatterStats TextureScatter::stats() {
    device_->finish();
    PelTextureScatterStats stats = pelTextureScatterStatsDefaults();
    cl_uint counts[PEL_TEXTURE_COUNTERS];
    device_->read(counters_.get(), 0, sizeof counts, counts, true);
    stats.texelsTotal = texels();
    stats.texelsCovered = counts[PEL_COUNT_TEXELS_COVERED];
    stats.texelsInvalid = counts[PEL_COUNT_TEXELS_INVALID];
    stats.tilesTotal = tiles();
    stats.tilesBlurred = uint64_t(counts[PEL_COUNT_TEXTURE_TILES]) * chain_.terms.size();
    stats.gaussians = chain_.terms.size();
    stats.profileError = chain_.error;
    stats.scratchBytes =
        texels() * (sizeof(cl_uint) + texelBytes * (placed_ + 3 * bool(light_))) + tiles() * sizeof(cl_uint);
    stats.launches = uint32_t(events_.size());
    for (const cl::Event& event : events_) stats.deviceMilliseconds += eventMilliseconds(event);
    return stats;
}

}  // namespace pel
