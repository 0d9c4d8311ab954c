#include "shading/shade_passes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shading/shader.h"
#include "shared/features.h"

namespace pel {
namespace {

constexpr size_t boundsGroup = 16;

// The geometric normals of a frame: their slot, or the shading normals'.
PelImageSlot normalSlot(const ShaderState& state) {
    return state.images[PEL_SLOT_NORMAL_GEOMETRIC] ? PEL_SLOT_NORMAL_GEOMETRIC : PEL_SLOT_NORMAL_SHADING;
}

const cl::Memory& memoryOf(const ImageView& view) {
    static const cl::Memory none;
    return view ? view.buffer->memory() : none;
}

// An image as wide as the frame inside scratch memory.
ImageView scratchImage(const Ref<Buffer>& buffer, const ImageView& frame, PelFormat format, uint64_t offset = 0) {
    ImageView view;
    view.buffer = buffer;
    view.format = format;
    view.width = frame.width;
    view.height = frame.height;
    view.byteOffset = offset;
    view.pixelStride = view.info().pixelBytes;
    view.rowStride = view.width * view.pixelStride;
    view.planeStride = view.height * view.rowStride;
    return view;
}

// Where the image would begin if it had the rows before `row` too; may wrap round, as addresses do.
void moveImage(Device& device, cl_mem memory, size_t at, const ImageView& view, uint32_t row) {
    const uint64_t offset = view.byteOffset - uint64_t(row) * view.rowStride;
    device.fill(memory, at, 4, uint32_t(offset));
    device.fill(memory, at + 4, 4, uint32_t(offset >> 32));
}

// `buffer` with this many bytes; 0: none.
void resize(Ref<Buffer>& buffer, const Ref<Device>& device, size_t bytes) {
    if ((buffer ? buffer->bytes() : 0) == bytes) return;
    buffer = Ref<Buffer>();
    if (bytes) buffer = Buffer::create(device, bytes, nullptr);
}

// A buffer that holds `values`; written anew only when they changed. Returns the bytes sent.
template <class T>
size_t send(Device& device, const std::vector<T>& values, cl::Memory& memory, std::vector<unsigned char>& sent) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    const size_t size = values.size() * sizeof(T);
    if (memory && sent.size() == size && std::equal(sent.begin(), sent.end(), bytes)) return 0;
    memory = device.allocate(size, nullptr);  // an execution that is queued keeps reading the old one
    sent.clear();
    device.write(memory.get(), 0, size, bytes, true);
    sent.assign(bytes, bytes + size);
    return size;
}

uint32_t cascadesOf(const ShaderLight& light) {
    return std::max(light.params.shadowCascades, 1u);
}

// Of the size of PEL_BOUNDS_BLOCK.
uint32_t blocksOf(const ImageView& map) {
    const auto blocks = [](uint32_t texels) { return (texels + PEL_BOUNDS_BLOCK - 1) / PEL_BOUNDS_BLOCK; };
    return blocks(map.width) * blocks(map.height);
}

PelNormalMap describeNormalMap(const ShaderState& plan, uint32_t id, bool fallback) {
    const ShaderMaterial& material = plan.materials.at(id);
    PelNormalMap map{};
    map.count = uint32_t(material.normalMap.size());
    for (uint32_t i = 0; i < map.count; ++i) map.levels[i] = describeImage(material.normalMap[i]);
    map.material = id;
    map.fallback = fallback;
    const ImageView& finest = material.normalMap[0];
    const double size = std::max(finest.width, finest.height), scale = material.params.uvScale;
    map.baseLevel = float(std::log2(std::max(size * material.params.diffusionRadius, scale) / scale));
    return map;
}

}  // namespace

// How many rows of tiles fit into the budget.
void ShadePasses::chooseBand(const ShaderState& state, uint32_t mostRows) {
    const ImageView& frame = state.images[PEL_SLOT_RADIANCE];
    const uint32_t tileRows = (frame.height + PEL_TILE_HEIGHT - 1) / PEL_TILE_HEIGHT;
    const bool blur = features_ & PEL_FEATURE_BLUR_NORMALS, map = features_ & PEL_FEATURE_NORMAL_MAP;
    scratchPixelBytes_ = uint32_t(((blur || map) * 3 + blur * 7 + filteredLights_.size()) * sizeof(float));
    haloRows_ = blur ? PEL_BLUR_TAPS * PEL_BLUR_STEP_MAX / PEL_TILE_HEIGHT : 0;
    bandRows_ = std::max(1u, any() ? std::min(tileRows, mostRows) : tileRows);
    const uint64_t budget = state.options.scratchBudget, rowBytes = uint64_t(frame.width) * scratchPixelBytes_;
    const uint64_t guards = 2 * PEL_PLANE_GUARD * sizeof(float) * ((blur || map) * 3 + blur * 7);
    const auto bytes = [&] { return scratchRows(frame.height) * rowBytes + guards; };
    if (!budget || bytes() <= budget) return;
    const uint64_t fit = (budget - std::min(budget, guards)) / rowBytes / PEL_TILE_HEIGHT;
    bandRows_ = uint32_t(std::clamp<uint64_t>(fit, 2 * haloRows_ + 1, bandRows_ + 2 * haloRows_)) - 2 * haloRows_;
    if (bytes() > budget)
        fail(PEL_ERROR_OUT_OF_MEMORY, "PelShaderOptions.scratchBudget is ", budget, " bytes; a frame of ", frame.width, " x ",
             frame.height, " with these passes needs at least ", bytes(), ", for ", scratchRows(frame.height), " rows of pixels");
}

uint32_t ShadePasses::scratchRows(uint32_t frameHeight) const {
    return uint32_t(std::min<uint64_t>(frameHeight, (uint64_t(bandRows_) + 2 * haloRows_) * PEL_TILE_HEIGHT));
}

void ShadePasses::allocate(const Ref<Device>& device, const ImageView& frame) {
    const size_t pixels = size_t(frame.width) * scratchRows(frame.height);
    const bool blur = features_ & PEL_FEATURE_BLUR_NORMALS, map = features_ & PEL_FEATURE_NORMAL_MAP;
    const size_t plane = (pixels + 2 * PEL_PLANE_GUARD) * sizeof(float);
    resize(normals_, device, blur || map ? 3 * plane : 0);
    resize(positions_, device, blur ? 3 * plane : 0);
    resize(between_, device, blur ? 3 * plane : 0);
    resize(tags_, device, blur ? plane : 0);
    planeValues_ = uint32_t(plane / sizeof(float));
    resize(wideShadows_, device, filteredLights_.size() * pixels * sizeof(float));
}

ShaderState ShadePasses::plan(const Ref<Device>& device, const ShaderState& state, uint32_t features, uint32_t mostRows) {
    ShaderState plan = state;
    const ImageView& frame = state.images[PEL_SLOT_RADIANCE];
    features_ = features;
    mappedMaterials_.clear();
    for (const auto& [id, material] : state.materials)
        if (features & PEL_FEATURE_NORMAL_MAP && !material.normalMap.empty()) mappedMaterials_.push_back(id);
    filteredLights_.clear();
    for (uint32_t i = 0; i < state.lights.size(); ++i)
        if (features & PEL_FEATURE_FILTER_SHADOW && filtersShadow(state.lights[i])) filteredLights_.push_back(i);
    chooseBand(state, mostRows);
    for (bool fits = false; !fits;) {
        try {
            allocate(device, frame);
            fits = true;
        } catch (const Error& e) {  // less at a time may still be had
            if (e.code() != PEL_ERROR_OUT_OF_MEMORY || bandRows_ == 1) throw;
            bandRows_ = (bandRows_ + 1) / 2;
        }
    }
    if (normals_) {
        ImageView& image = plan.images[PEL_SLOT_NORMAL_BLURRED];
        image = scratchImage(normals_, frame, PEL_FORMAT_PLANAR_RGB32F, PEL_PLANE_GUARD * sizeof(float));
        image.planeStride = planeValues_ * sizeof(float);
    }
    const size_t lightBytes = size_t(frame.width) * scratchRows(frame.height) * sizeof(float);
    for (size_t k = 0; k < filteredLights_.size(); ++k)
        plan.lights[filteredLights_[k]].images[PEL_LIGHT_WIDE_SHADOW] =
            scratchImage(wideShadows_, frame, PEL_FORMAT_R32F, k * lightBytes);
    boundedMaps_.clear();
    uint64_t boundsFloats = 0;
    for (size_t k = 0; k < filteredLights_.size() && !state.options.disableSkipping; ++k) {
        const ShaderLight& light = plan.lights[filteredLights_[k]];
        if (light.params.shadowContent != PEL_SHADOW_CONTENT_DEPTH || isCube(light.params)) continue;
        for (uint32_t i = 0; i < cascadesOf(light); ++i) {
            const ImageView& map = *shadowCascade(light, i).map;
            boundedMaps_.push_back({uint32_t(k), i, blocksOf(map), uint32_t(boundsFloats)});
            boundsFloats += 4 * uint64_t(blocksOf(map));
        }
    }
    if (boundsFloats > UINT32_MAX)  // kernels count them with 32 bits
        fail(PEL_ERROR_UNSUPPORTED, "the shadow maps that are filtered are ", filteredLights_.size(), " lights' and too large together: ",
             boundsFloats, " bounds of their depths; ", UINT32_MAX, " are the most");
    // One vector more, since the last row's vectors reach beyond its end.
    resize(bounds_, device, boundsFloats ? (boundsFloats + device->info().mathWidth) * sizeof(float) : 0);
    return plan;
}

void ShadePasses::moveScratch(Device& device, const ShaderState& plan, const ShadeTables& tables, uint32_t row) {
    if (!any() || scratchRow_ == row) return;
    scratchRow_.reset();
    if (normals_)
        moveImage(device, tables.frameMemory().get(),
                  offsetof(PelShadeFrame, images) + PEL_SLOT_NORMAL_BLURRED * sizeof(PelShadeImage),
                  plan.images[PEL_SLOT_NORMAL_BLURRED], row);
    for (size_t k = 0; k < filteredLights_.size(); ++k) {
        const ImageView& view = plan.lights[filteredLights_[k]].images[PEL_LIGHT_WIDE_SHADOW];
        moveImage(device, tables.lights().get(), filteredLights_[k] * sizeof(PelShadeLight) + offsetof(PelShadeLight, wide), view,
                  row);
        moveImage(device, lightConstants_[k].get(), offsetof(PelWideShadow, out), view, row);
    }
    scratchRow_ = row;
}

void ShadePasses::build(Device& device, const ShaderState& plan, uint32_t features) {
    const uint32_t width = device.info().mathWidth;
    const auto code = [&](PelImageSlot slot, uint32_t lanes) { return text(formatCode(plan.images[slot], lanes)); };
    const auto common = [&](uint32_t lanes) {
        return cl::Defines{{"PEL_PASS_GROUP", text(shadeGroup(device))},
                           {"PEL_WIDTH", text(lanes)},
                           {"PEL_FEATURES", text(0)},
                           {"PEL_FORMAT_MATERIAL", code(PEL_SLOT_MATERIAL, lanes)},
                           {"PEL_FORMAT_POSITION", code(PEL_SLOT_POSITION, lanes)},
                           {"PEL_FORMAT_DEPTH", plan.images[PEL_SLOT_POSITION] ? text(0) : code(PEL_SLOT_DEPTH, lanes)},
                           {"PEL_FORMAT_NORMAL", code(normalSlot(plan), lanes)},
                           {"PEL_NORMAL_SLOT", text(int(normalSlot(plan)))}};
    };
    blurProgram_ = mapProgram_ = shadowProgram_ = cl::Program();
    if (features & PEL_FEATURE_BLUR_NORMALS) {
        cl::Defines all = common(width);
        all.erase("PEL_FORMAT_NORMAL");
        all.erase("PEL_NORMAL_SLOT");
        all["PEL_FORMAT_NORMAL_SHADING"] = code(PEL_SLOT_NORMAL_SHADING, width);
        blurProgram_ = device.programs().get("shading/blur_normals.cl", all);
    }
    if (features & PEL_FEATURE_NORMAL_MAP) {
        const ImageView& tangent = plan.images[PEL_SLOT_TANGENT];
        cl::Defines all = common(1);
        all["PEL_FORMAT_POSITION"] = all["PEL_FORMAT_DEPTH"] = text(0);
        all["PEL_FORMAT_UV"] = code(PEL_SLOT_UV, 1);
        all["PEL_FORMAT_UV_GRADIENT"] = code(PEL_SLOT_UV_GRADIENT, 1);
        all["PEL_FORMAT_TANGENT"] = code(PEL_SLOT_TANGENT, 1);
        all["PEL_TANGENT_COMPONENTS"] = text(tangent.info().components);
        all["PEL_TANGENT_UNORM"] =
            text(int(tangent.format > PEL_FORMAT_RGBA16F && tangent.format != PEL_FORMAT_PLANAR_RGB32F));
        all["PEL_FORMAT_NORMAL_MAP"] = text(formatCode(plan.materials.at(mappedMaterials_[0]).normalMap[0], 1));
        mapProgram_ = device.programs().get("shading/normal_map.cl", all);
    }
    if (features & PEL_FEATURE_FILTER_SHADOW) {
        cl::Defines all = common(width);
        uint32_t bits = (plan.options.countPixels ? PEL_BIT_COUNT : 0) | (plan.options.disableSkipping ? PEL_BIT_NO_SKIPPING : 0);
        uint32_t map = 0, content = 0;
        for (uint32_t light : filteredLights_) {
            map |= mapFormatCode(plan.lights[light]);
            content = plan.lights[light].params.shadowContent;
            bits |= formFeatures(plan.lights[light].params) & (PEL_BIT_SHADOW_CUBE | PEL_BIT_SHADOW_CASCADES);
        }
        all["PEL_FEATURES"] = text(bits);
        all["PEL_FORMAT_SHADOW_MAP"] = text(map);
        all["PEL_SHADOW_CONTENT"] = text(content);
        all["PEL_BOUNDS"] = text(int(!boundedMaps_.empty()));
        cl::ProgramKey key{{"shading/wide_shadow.cl"}, all};
        if (!boundedMaps_.empty()) {
            key.files.push_back("shading/shadow_bounds.cl");
            key.defines["PEL_BOUNDS_GROUP"] = text(boundsGroup);
        }
        shadowProgram_ = device.programs().get(key);
    }
}

size_t ShadePasses::upload(Device& device, const ShaderState& plan) {
    scratchRow_.reset();  // whatever is sent now says row 0
    lightConstants_.resize(filteredLights_.size());
    mapConstants_.resize(mappedMaterials_.size());
    sent_.resize(filteredLights_.size() + mappedMaterials_.size());
    size_t bytes = 0;
    for (size_t k = 0; k < filteredLights_.size(); ++k) {
        const ShaderLight& light = plan.lights[filteredLights_[k]];
        std::vector<PelWideShadow> maps;
        for (uint32_t i = 0; i < cascadesOf(light); ++i) maps.push_back(describeWideShadow(light, filteredLights_[k], i));
        for (const BoundedMap& map : boundedMaps_)
            if (map.filtered == k) maps[map.cascade].bounds = map.offset;
        bytes += send(device, maps, lightConstants_[k], sent_[k]);
    }
    const bool fallback = !(features_ & PEL_FEATURE_BLUR_NORMALS);
    for (size_t k = 0; k < mappedMaterials_.size(); ++k)
        bytes += send(device, std::vector{describeNormalMap(plan, mappedMaterials_[k], fallback && k == 0)}, mapConstants_[k],
                      sent_[filteredLights_.size() + k]);
    return bytes;
}

void ShadePasses::prepare(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                          uint32_t tiles, std::vector<cl::Event>& events) const {
    if (!blurProgram_) return;
    cl::Launch prepare(blurProgram_, "prepare_normals");
    prepare.arg(tables.frameMemory()).arg(list).arg(memoryOf(plan.images[PEL_SLOT_MATERIAL]));
    prepare.arg(memoryOf(plan.images[PEL_SLOT_NORMAL_SHADING]));
    prepare.arg(memoryOf(plan.images[PEL_SLOT_POSITION])).arg(memoryOf(plan.images[PEL_SLOT_DEPTH]));
    prepare.arg(normals_->memory()).arg(positions_->memory()).arg(tags_->memory()).arg(cl_uint(planeValues_));
    events.push_back(device.launch(prepare, tileRange(device, tiles)));
    enqueueBlur(device, plan, tables, list, tiles, false, events);
}

void ShadePasses::enqueue(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                          const cl::Memory& counters, uint32_t tiles, std::vector<cl::Event>& events) const {
    const cl::Range range = tileRange(device, tiles);
    if (blurProgram_) enqueueBlur(device, plan, tables, list, tiles, true, events);
    for (size_t k = 0; k < mappedMaterials_.size(); ++k) {
        cl::Launch launch(mapProgram_, "normal_map");
        launch.arg(tables.frameMemory()).arg(tables.materials()).arg(list);
        for (PelImageSlot slot :
             {PEL_SLOT_MATERIAL, normalSlot(plan), PEL_SLOT_UV, PEL_SLOT_UV_GRADIENT, PEL_SLOT_TANGENT})
            launch.arg(memoryOf(plan.images[slot]));
        launch.arg(mapConstants_[k]).arg(memoryOf(plan.materials.at(mappedMaterials_[k]).normalMap[0]));
        launch.arg(normals_->memory()).arg(cl_uint(planeValues_));
        events.push_back(device.launch(launch, range));
    }
    for (const BoundedMap& map : boundedMaps_) {
        cl::Launch launch(shadowProgram_, "shadow_bounds");
        launch.arg(tables.frameMemory()).arg(list).arg(lightConstants_[map.filtered]).arg(cl_uint(map.cascade));
        launch.arg(memoryOf(*shadowCascade(plan.lights[filteredLights_[map.filtered]], map.cascade).map)).arg(bounds_->memory());
        events.push_back(device.launch(launch, {{map.blocks, 1, 1}, {boundsGroup, 1, 1}}));
    }
    for (size_t k = 0; k < filteredLights_.size(); ++k) {
        const ShaderLight& light = plan.lights[filteredLights_[k]];
        cl::Launch launch(shadowProgram_, "wide_shadow");
        launch.arg(tables.frameMemory()).arg(tables.materials()).arg(tables.lights()).arg(list).arg(counters);
        for (PelImageSlot slot : {PEL_SLOT_MATERIAL, normalSlot(plan), PEL_SLOT_POSITION, PEL_SLOT_DEPTH})
            launch.arg(memoryOf(plan.images[slot]));
        launch.arg(lightConstants_[k]).arg(cl_uint(filteredLights_[k]));
        for (uint32_t i = 0; i < PEL_CASCADES; ++i) {
            const bool read = i < cascadesOf(light);
            launch.arg(read ? memoryOf(*shadowCascade(light, i).map) : cl::Memory());
        }
        launch.arg(bounds_ ? bounds_->memory() : cl::Memory()).arg(wideShadows_->memory());
        events.push_back(device.launch(launch, range));
    }
}

void ShadePasses::enqueueBlur(Device& device, const ShaderState& plan, const ShadeTables& tables, const cl::Memory& list,
                              uint32_t tiles, bool alongY, std::vector<cl::Event>& events) const {
    const cl::Memory &from = alongY ? between_->memory() : normals_->memory(),
                     &to = alongY ? normals_->memory() : between_->memory();
    cl::Launch blur(blurProgram_, "blur_normals");
    blur.arg(tables.frameMemory()).arg(tables.materials()).arg(list).arg(memoryOf(plan.images[PEL_SLOT_MATERIAL]));
    blur.arg(from).arg(positions_->memory()).arg(tags_->memory()).arg(to).arg(cl_uint(planeValues_)).arg(cl_uint(alongY));
    events.push_back(device.launch(blur, tileRange(device, tiles)));
}

size_t ShadePasses::scratchBytes() const {
    size_t bytes = 0;
    for (const Ref<Buffer>& buffer : {normals_, wideShadows_, positions_, between_, tags_, bounds_})
        if (buffer) bytes += buffer->bytes();
    for (const auto& sent : sent_) bytes += sent.size();
    return bytes;
}

PelWideShadow describeWideShadow(const ShaderLight& light, uint32_t index, uint32_t cascade) {
    const PelLight& l = light.params;
    const ShadowCascade from = shadowCascade(light, cascade);
    const float(&matrix)[16] = *from.worldToShadow;
    PelWideShadow to{};
    std::copy_n(matrix, 16, to.worldToShadow);
    to.projection = l.shadowProjection;
    to.depthA = l.shadowDepthA;
    to.depthB = l.shadowDepthB;
    to.depthRange = from.depthRange;
    to.exponent = float(l.shadowExponent / std::log(2.0));
    if (l.shadowExponent != 0) to.perExponent = float(std::log(2.0) / l.shadowExponent);
    to.minDeviation = l.shadowMinDeviation;
    to.bleeding = l.shadowBleeding;
    to.bias = l.shadowBias;
    to.softness = l.shadowSoftness;
    to.coneSlope = l.shadowConeSlope;
    to.maxTexels = float(l.shadowFilterTexels);
    to.cascades = l.shadowCascades;
    to.map = describeImage(*from.map);
    to.out = describeImage(light.images[PEL_LIGHT_WIDE_SHADOW]);
    if (isCube(l)) return to;
    struct Vec {
        double x, y, z;
        Vec scaled(double s) const { return {x * s, y * s, z * s}; }
        Vec minus(Vec b) const { return {x - b.x, y - b.y, z - b.z}; }
        double dot(Vec b) const { return x * b.x + y * b.y + z * b.z; }
        Vec cross(Vec b) const { return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x}; }
        double length() const { return std::sqrt(dot(*this)); }
        void to(float (&out)[3]) const { out[0] = float(x), out[1] = float(y), out[2] = float(z); }
    };
    const auto row = [&](int r) {
        const float* m = matrix + 4 * r;
        return Vec{m[0], m[1], m[2]};
    };
    const bool perspective = l.shadowProjection == PEL_SHADOW_PERSPECTIVE;
    const double w = perspective ? row(3).length() : matrix[15];
    // Along a ray of the light u and v stay what they are; across it they grow by 1 / extent per length.
    Vec forward = perspective ? row(3).scaled(1 / w) : row(0).cross(row(1));
    if (!perspective) {
        const double length = forward.length(), sign = row(2).dot(forward) * w * from.depthRange < 0 ? -1 : 1;
        forward = forward.scaled(sign / length);
        to.zPerLength = float(row(2).dot(forward) / w);
    }
    const Vec right = row(0).minus(forward.scaled(row(0).dot(forward))),
              down = row(1).minus(forward.scaled(row(1).dot(forward)));
    const double u = right.length(), v = down.length(), skew = right.dot(down) / (u * v);
    if (!(u > 0 && v > 0 && std::isfinite(forward.length()) && std::abs(skew) < 0.999 && (perspective || to.zPerLength != 0)))
        invalidArgument("PelLight ", index, cascade ? text(".cascadeToShadow[", cascade - 1, "]") : ".worldToShadow",
                        " is singular: a wide shadow cannot be filtered from its shadow map");
    right.scaled(1 / u).to(to.right);
    down.scaled(1 / v).to(to.down);
    forward.to(to.forward);
    to.extent[0] = float(std::abs(w) / u);
    to.extent[1] = float(std::abs(w) / v);
    to.centre[0] = float(row(0).dot(forward) / w);
    to.centre[1] = float(row(1).dot(forward) / w);
    return to;
}

}  // namespace pel
