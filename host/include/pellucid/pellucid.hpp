// C++ over pellucid.h: handles that count themselves, exceptions for errors. Header only; no binary interface
// of its own. The C header documents every call; the names here are the same without the prefix.
#pragma once
#include <pellucid/pellucid.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace pellucid {

class Error : public std::runtime_error {
  public:
    Error(PelError code, const std::string& message) : std::runtime_error(message), code_(code) {}
    PelError code() const { return code_; }

  private:
    PelError code_;
};

inline void check(PelError code) {
    if (code != PEL_SUCCESS) throw Error(code, pelGetErrorMessage());
}

// Shared ownership of one C handle.
template <class H, void (*Retain)(H), void (*Release)(H)>
class Handle {
  public:
    Handle() = default;
    explicit Handle(H owned) : h_(owned) {}
    Handle(const Handle& other) : h_(other.h_) {
        if (h_) Retain(h_);
    }
    Handle(Handle&& other) noexcept : h_(std::exchange(other.h_, nullptr)) {}
    Handle& operator=(Handle other) noexcept {
        std::swap(h_, other.h_);
        return *this;
    }
    ~Handle() {
        if (h_) Release(h_);
    }
    H get() const { return h_; }
    explicit operator bool() const { return h_ != nullptr; }

  protected:
    H* out() {
        *this = Handle();
        return &h_;
    }
    H h_ = nullptr;
};

class Event : public Handle<PelEvent, pelEventRetain, pelEventRelease> {
  public:
    using Handle::Handle;
    void wait() const { check(pelEventWait(h_)); }
    bool isDone() const {
        int done = 0;
        check(pelEventIsDone(h_, &done));
        return done != 0;
    }
};

class Device : public Handle<PelDevice, pelDeviceRetain, pelDeviceRelease> {
  public:
    Device() = default;
    // "": the standard device; see pelDeviceCreate.
    explicit Device(const std::string& selector) { check(pelDeviceCreate(selector.c_str(), out())); }
    static Device fromCl(void* context, void* deviceId, void* queue) {
        Device device;
        check(pelDeviceCreateFromCl(context, deviceId, queue, device.out()));
        return device;
    }
    static std::vector<PelDeviceInfo> all() {
        uint32_t count = 0;
        check(pelDeviceCount(&count));
        std::vector<PelDeviceInfo> infos(count, pelDeviceInfoDefaults());
        for (uint32_t i = 0; i < count; ++i) check(pelDeviceEnumerate(i, &infos[i]));
        return infos;
    }
    PelDeviceInfo info() const {
        PelDeviceInfo info = pelDeviceInfoDefaults();
        check(pelDeviceGetInfo(h_, &info));
        return info;
    }
    PelDeviceStats stats() const {
        PelDeviceStats stats = pelDeviceStatsDefaults();
        check(pelDeviceGetStats(h_, &stats));
        return stats;
    }
    void finish() const { check(pelDeviceFinish(h_)); }
    void setProgress(PelProgressCallback callback, void* user) const {
        check(pelDeviceSetProgress(h_, callback, user));
    }
};

class Buffer : public Handle<PelBuffer, pelBufferRetain, pelBufferRelease> {
  public:
    using Handle::Handle;
    Buffer(const Device& device, size_t bytes, const void* initial = nullptr) {
        check(pelBufferCreate(device.get(), bytes, initial, out()));
    }
    template <class T>
    Buffer(const Device& device, const std::vector<T>& initial)
        : Buffer(device, initial.size() * sizeof(T), initial.data()) {}
    static Buffer fromHost(const Device& device, void* memory, size_t bytes) {
        Buffer buffer;
        check(pelBufferCreateFromHost(device.get(), memory, bytes, buffer.out()));
        return buffer;
    }
    static Buffer fromCl(const Device& device, void* clMem) {
        Buffer buffer;
        check(pelBufferCreateFromCl(device.get(), clMem, buffer.out()));
        return buffer;
    }
    size_t bytes() const {
        size_t bytes = 0;
        check(pelBufferGetSize(h_, &bytes));
        return bytes;
    }
    void read(void* destination, size_t bytes, size_t offset = 0, const PelSubmit* submit = nullptr) const {
        check(pelBufferRead(h_, offset, bytes, destination, submit));
    }
    template <class T>
    std::vector<T> readAll() const {
        std::vector<T> values(bytes() / sizeof(T));
        read(values.data(), values.size() * sizeof(T));
        return values;
    }
    void write(const void* source, size_t bytes, size_t offset = 0, const PelSubmit* submit = nullptr) const {
        check(pelBufferWrite(h_, offset, bytes, source, submit));
    }
    void* map() const {
        void* memory = nullptr;
        check(pelBufferMap(h_, &memory));
        return memory;
    }
    void unmap() const { check(pelBufferUnmap(h_)); }
};

inline PelImageDesc imageDesc(const Buffer& buffer, PelFormat format, uint32_t width, uint32_t height,
                              uint64_t byteOffset = 0) {
    PelImageDesc desc = pelImageDescDefaults();
    desc.buffer = buffer.get();
    desc.format = format;
    desc.width = width;
    desc.height = height;
    desc.byteOffset = byteOffset;
    return desc;
}

inline PelVertexView vertexView(const Buffer& buffer, uint32_t count, uint64_t byteOffset = 0,
                                uint32_t byteStride = 0) {
    return PelVertexView{buffer.get(), byteOffset, byteStride, count};
}

class MeshTopology : public Handle<PelMeshTopology, pelMeshTopologyRetain, pelMeshTopologyRelease> {
  public:
    using Handle::Handle;
    MeshTopology() = default;
    MeshTopology(const Device& device, const PelMeshTopologyDesc& desc, PelMeshReport* report = nullptr) {
        check(pelMeshTopologyCreate(device.get(), &desc, out(), report));
    }
    static MeshTopology load(const Device& device, const void* bytes, size_t size,
                             PelMeshReport* report = nullptr) {
        MeshTopology topology;
        check(pelMeshTopologyLoad(device.get(), bytes, size, topology.out(), report));
        return topology;
    }
    std::vector<char> save() const {
        size_t size = 0;
        check(pelMeshTopologySave(h_, nullptr, &size));
        std::vector<char> bytes(size);
        check(pelMeshTopologySave(h_, bytes.data(), &size));
        return bytes;
    }
    void normals(const PelVertexView& positions, const PelVertexView& result,
                 const PelSubmit* submit = nullptr) const {
        check(pelMeshNormals(h_, &positions, &result, submit));
    }
    // With normals made from the positions.
    void curvature(const PelCurvatureParams& params, const PelVertexView& positions, const PelVertexView& result,
                   PelMeshReport* report = nullptr, const PelSubmit* submit = nullptr) const {
        check(pelMeshCurvature(h_, &params, &positions, nullptr, &result, report, submit));
    }
    void curvature(const PelCurvatureParams& params, const PelVertexView& positions,
                   const PelVertexView& normals, const PelVertexView& result, PelMeshReport* report = nullptr,
                   const PelSubmit* submit = nullptr) const {
        check(pelMeshCurvature(h_, &params, &positions, &normals, &result, report, submit));
    }
    float uvScale(const PelVertexView& positions, const PelVertexView& uvs) const {
        float scale = 0;
        check(pelMeshUvScale(h_, &positions, &uvs, &scale));
        return scale;
    }
};

// Writes the triangles to `indices`, turned where neighbours disagree; `normals` may be NULL.
inline PelMeshOrientation orientMesh(const PelMeshTopologyDesc& desc, uint32_t* indices,
                                     const float* normals = nullptr, uint32_t normalStride = 0) {
    PelMeshOrientation found = pelMeshOrientationDefaults();
    check(pelMeshOrient(&desc, normals, normalStride, indices, &found));
    return found;
}

class LiveMesh : public Handle<PelLiveMesh, pelLiveMeshRetain, pelLiveMeshRelease> {
  public:
    using Handle::Handle;
    LiveMesh() = default;
    LiveMesh(const MeshTopology& topology, const PelCurvatureParams& params) {
        check(pelLiveMeshCreate(topology.get(), &params, out()));
    }
    // All vertices. normals NULL: they are made.
    void update(const PelVertexView& positions, const PelVertexView* normals, const PelVertexView& curvature,
                const PelSubmit* submit = nullptr) const {
        check(pelLiveMeshUpdate(h_, &positions, normals, &curvature, nullptr, 0, submit));
    }
    // Only `changed`, which may be empty.
    void update(const PelVertexView& positions, const PelVertexView* normals, const PelVertexView& curvature,
                const std::vector<PelVertexRange>& changed, const PelSubmit* submit = nullptr) const {
        static constexpr PelVertexRange none{};
        check(pelLiveMeshUpdate(h_, &positions, normals, &curvature, changed.empty() ? &none : changed.data(),
                                uint32_t(changed.size()), submit));
    }
    PelLiveMeshStats stats() const {
        PelLiveMeshStats stats = pelLiveMeshStatsDefaults();
        check(pelLiveMeshGetStats(h_, &stats));
        return stats;
    }
};

// Any of positions, depth and ids may be NULL, but not both of the first two.
inline void screenCurvature(const Device& device, const PelScreenCurvatureParams& params,
                            const PelImageDesc& normals, const PelImageDesc* positions,
                            const PelImageDesc* depth, const PelImageDesc* ids, const PelImageDesc& curvature,
                            const PelSubmit* submit = nullptr) {
    check(pelScreenCurvature(device.get(), &params, &normals, positions, depth, ids, &curvature, submit));
}

// RGB per point: pelSurfaceIntegral.
inline void surfaceIntegral(const Device& device, const PelSurfaceIntegralDesc& desc,
                            const PelSubmit* submit = nullptr) {
    check(pelSurfaceIntegral(device.get(), &desc, submit));
}

class Profile : public Handle<PelProfile, pelProfileRetain, pelProfileRelease> {
  public:
    using Handle::Handle;
    static Profile skin() {
        Profile p;
        check(pelProfileCreateSkin(p.out()));
        return p;
    }
    static Profile gaussians(const std::vector<PelGaussian>& gaussians) {
        Profile p;
        check(pelProfileCreateGaussians(gaussians.data(), uint32_t(gaussians.size()), p.out()));
        return p;
    }
    static Profile burley(const float (&meanFreePath)[3], const float (&albedo)[3],
                          PelBurleyFit fit = PEL_BURLEY_DIFFUSE_TRANSMISSION) {
        Profile p;
        check(pelProfileCreateBurley(meanFreePath, albedo, fit, p.out()));
        return p;
    }
    static Profile burleyDistance(const float (&distance)[3]) {
        Profile p;
        check(pelProfileCreateBurleyDistance(distance, p.out()));
        return p;
    }
    // A material of the library.
    static Profile named(const std::string& name) {
        Profile p;
        check(pelProfileCreateNamed(name.c_str(), p.out()));
        return p;
    }
    static std::vector<std::string> libraryNames() {
        std::vector<std::string> names;
        for (uint32_t i = 0; const char* name = pelProfileLibraryName(i); ++i) names.push_back(name);
        return names;
    }
    static Profile dipole(const float (&absorption)[3], const float (&reducedScattering)[3], float eta) {
        Profile p;
        check(pelProfileCreateDipole(absorption, reducedScattering, eta, p.out()));
        return p;
    }
    // values: RGB per distance.
    static Profile table(const std::vector<float>& distances, const std::vector<float>& values) {
        if (values.size() != 3 * distances.size())
            throw Error(PEL_ERROR_INVALID_ARGUMENT, "a table needs three values per distance");
        Profile p;
        check(pelProfileCreateTable(distances.data(), values.data(), uint32_t(distances.size()), p.out()));
        return p;
    }
    PelProfileInfo info() const {
        PelProfileInfo info = pelProfileInfoDefaults();
        check(pelProfileGetInfo(h_, &info));
        return info;
    }
    void setName(const std::string& name) const { check(pelProfileSetName(h_, name.c_str())); }
    // RGB per distance.
    std::vector<double> transmission(const std::vector<double>& distances) const {
        std::vector<double> values(3 * distances.size());
        check(pelProfileTransmission(h_, distances.data(), uint32_t(distances.size()), values.data()));
        return values;
    }
    std::vector<double> radial(const std::vector<double>& distances) const {
        std::vector<double> values(3 * distances.size());
        check(pelProfileEvaluate(h_, distances.data(), uint32_t(distances.size()), values.data(), nullptr));
        return values;
    }
    std::vector<double> lineSpread(const std::vector<double>& distances) const {
        std::vector<double> values(3 * distances.size());
        check(pelProfileEvaluate(h_, distances.data(), uint32_t(distances.size()), nullptr, values.data()));
        return values;
    }
};

// Scattering alone: irradiance in, scattered irradiance out.
class Scatter : public Handle<PelScatter, pelScatterRetain, pelScatterRelease> {
  public:
    using Handle::Handle;
    explicit Scatter(const Device& device) { check(pelScatterCreate(device.get(), out())); }
    void setMaterial(uint32_t id, const Profile& profile, float scale = 1) {
        check(pelScatterSetMaterial(h_, id, profile.get(), scale));
    }
    // How an id that has a material scatters.
    void setControls(uint32_t id, const PelScatterControls& controls) {
        check(pelScatterSetControls(h_, id, &controls));
    }
    // PEL_SLOT_SCATTER_WEIGHT, _IRRADIANCE_BACK or _ALBEDO, for all executions from now on.
    void set(PelImageSlot slot, const PelImageDesc& image) { check(pelScatterSetImage(h_, slot, &image)); }
    void clear(PelImageSlot slot) { check(pelScatterSetImage(h_, slot, nullptr)); }
    // Any of positions, depth and ids may be NULL, but not both of the first two.
    void execute(const PelScatterParams& params, const PelImageDesc& irradiance,
                 const PelImageDesc* positions, const PelImageDesc* depth, const PelImageDesc* ids,
                 const PelImageDesc& scattered, const PelSubmit* submit = nullptr) {
        check(pelScatterExecute(h_, &params, &irradiance, positions, depth, ids, &scattered, submit));
    }
    PelScatterStats stats() const {
        PelScatterStats stats = pelScatterStatsDefaults();
        check(pelScatterGetStats(h_, &stats));
        return stats;
    }
};

// Scattering in the texture of a mesh.
class TextureScatter : public Handle<PelTextureScatter, pelTextureScatterRetain, pelTextureScatterRelease> {
  public:
    using Handle::Handle;
    TextureScatter(const Device& device, const PelTextureScatterDesc& desc) {
        check(pelTextureScatterCreate(device.get(), &desc, out()));
    }
    void setPositions(const PelVertexView& positions, const PelSubmit* submit = nullptr) {
        check(pelTextureScatterSetPositions(h_, &positions, submit));
    }
    void draw(const PelVertexView& values, bool unit, const PelImageDesc& image,
              const PelSubmit* submit = nullptr) {
        check(pelTextureScatterDraw(h_, &values, unit, &image, submit));
    }
    void execute(const PelTextureScatterParams& params, const PelImageDesc& irradiance,
                 const PelImageDesc* albedo, const PelImageDesc& scattered, const PelSubmit* submit = nullptr) {
        check(pelTextureScatterExecute(h_, &params, &irradiance, albedo, &scattered, submit));
    }
    PelTextureScatterStats stats() const {
        PelTextureScatterStats stats = pelTextureScatterStatsDefaults();
        check(pelTextureScatterGetStats(h_, &stats));
        return stats;
    }
};

class Lut : public Handle<PelLut, pelLutRetain, pelLutRelease> {
  public:
    using Handle::Handle;
    Lut(const Device& device, const PelCurvatureLutDesc& desc, const PelSubmit* submit = nullptr) {
        check(pelCurvatureLutCreate(device.get(), &desc, out(), submit));
    }
    Lut(const Device& device, const PelShadowLutDesc& desc, const PelSubmit* submit = nullptr) {
        check(pelShadowLutCreate(device.get(), &desc, out(), submit));
    }
    Lut(const Device& device, const PelSpecularLutDesc& desc, const PelSubmit* submit = nullptr) {
        check(pelSpecularLutCreate(device.get(), &desc, out(), submit));
    }
    // The caustic of a cornea; pelEyeLutDescOf makes the description of an eye's.
    Lut(const Device& device, const PelEyeLutDesc& desc, const PelSubmit* submit = nullptr) {
        check(pelEyeLutCreate(device.get(), &desc, out(), submit));
    }
    Lut(const Device& device, const PelLutInfo& info, const std::vector<float>& texels) {
        check(pelLutCreateFromTexels(device.get(), &info, texels.data(), texels.size() * sizeof(float), out()));
    }
    PelLutInfo info() const {
        PelLutInfo info = pelLutInfoDefaults();
        check(pelLutGetInfo(h_, &info));
        return info;
    }
    // Texels that PEL_LUT_FACEWORKS8 clips.
    uint64_t clippedTexels() const {
        uint64_t clipped = 0;
        check(pelLutCountClipped(h_, &clipped));
        return clipped;
    }
    // The texels in the element type of the encoding: float, uint16_t (half) or uint8_t.
    template <class T>
    std::vector<T> read(PelLutEncoding encoding) const {
        size_t bytes = 0;
        check(pelLutGetSize(h_, encoding, &bytes));
        std::vector<T> texels(bytes / sizeof(T));
        check(pelLutRead(h_, encoding, texels.data(), bytes, nullptr));
        return texels;
    }
};

class Shader : public Handle<PelShader, pelShaderRetain, pelShaderRelease> {
  public:
    using Handle::Handle;
    explicit Shader(const Device& device) { check(pelShaderCreate(device.get(), out())); }
    Shader& set(const PelShaderOptions& options) { return done(pelShaderSetOptions(h_, &options)); }
    Shader& set(PelImageSlot slot, const PelImageDesc& image) {
        return done(pelShaderSetImage(h_, slot, &image));
    }
    Shader& clear(PelImageSlot slot) { return done(pelShaderSetImage(h_, slot, nullptr)); }
    Shader& setMaterial(uint32_t id, const PelMaterial& material, const Lut& curvature = {},
                        const Lut& shadow = {}) {
        return done(pelShaderSetMaterial(h_, id, &material, curvature.get(), shadow.get()));
    }
    // Each level half the size of the one before; none: no normal map.
    Shader& setNormalMap(uint32_t id, const std::vector<PelImageDesc>& levels) {
        return done(pelShaderSetNormalMap(h_, id, levels.data(), uint32_t(levels.size())));
    }
    // What PEL_SCATTERING_TEXTURE samples.
    Shader& setScatteredTexture(uint32_t id, const PelImageDesc& texture) {
        return done(pelShaderSetScatteredTexture(h_, id, &texture));
    }
    Shader& clearScatteredTexture(uint32_t id) { return done(pelShaderSetScatteredTexture(h_, id, nullptr)); }
    // Makes a material that is set an eye. Without a table it is made.
    Shader& setEye(uint32_t id, const PelEye& eye, const Lut& caustics = {}) {
        return done(pelShaderSetEye(h_, id, &eye, caustics.get()));
    }
    Shader& clearEye(uint32_t id) { return done(pelShaderSetEye(h_, id, nullptr, nullptr)); }
    Shader& setIrisTexture(uint32_t id, const PelImageDesc& texture) {
        return done(pelShaderSetIrisTexture(h_, id, &texture));
    }
    Shader& clearIrisTexture(uint32_t id) { return done(pelShaderSetIrisTexture(h_, id, nullptr)); }
    Shader& setReflectionCube(const PelImageDesc& faces) {
        return done(pelShaderSetReflectionCube(h_, &faces));
    }
    Shader& clearReflectionCube() { return done(pelShaderSetReflectionCube(h_, nullptr)); }
    Shader& set(const std::vector<PelLight>& lights) {
        return done(pelShaderSetLights(h_, lights.data(), uint32_t(lights.size())));
    }
    Shader& set(uint32_t light, PelLightSlot slot, const PelImageDesc& image) {
        return done(pelShaderSetLightImage(h_, light, slot, &image));
    }
    Shader& set(const PelAmbient& ambient) { return done(pelShaderSetAmbient(h_, &ambient)); }
    Shader& setAmbientCube(const PelImageDesc& faces) { return done(pelShaderSetAmbientCube(h_, &faces)); }
    Shader& clearAmbientCube() { return done(pelShaderSetAmbientCube(h_, nullptr)); }
    Shader& set(const PelCamera& camera) { return done(pelShaderSetCamera(h_, &camera)); }
    Shader& commit() { return done(pelShaderCommit(h_)); }
    void execute(const PelSubmit* submit = nullptr) const { check(pelShaderExecute(h_, submit)); }
    PelMaterial material(uint32_t id) const {
        PelMaterial material = pelMaterialDefaults();
        check(pelShaderGetMaterial(h_, id, &material));
        return material;
    }
    std::string warnings() const {
        const char* text = "";
        check(pelShaderGetWarnings(h_, &text));
        return text;
    }
    PelShaderStats stats() const {
        PelShaderStats stats = pelShaderStatsDefaults();
        check(pelShaderGetStats(h_, &stats));
        return stats;
    }

  private:
    Shader& done(PelError code) {
        check(code);
        return *this;
    }
};

// Builds programs before they are needed (pelWarmUpPrograms): those of the groups (PelProgramGroup bits), and those that the
// shaders would build at their commit. Returns how many were not there before.
inline uint32_t warmUpPrograms(const Device& device, uint32_t groups, const std::vector<Shader>& shaders = {},
                               uint32_t threads = 0) {
    std::vector<PelShader> handles;
    for (const Shader& shader : shaders) handles.push_back(shader.get());
    PelWarmUp work = pelWarmUpDefaults();
    work.groups = groups;
    work.shaders = handles.data();
    work.numShaders = uint32_t(handles.size());
    work.threads = threads;
    uint32_t built = 0;
    check(pelWarmUpPrograms(device.get(), &work, &built));
    return built;
}

}  // namespace pellucid
