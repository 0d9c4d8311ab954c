// C++ over pellucid.h: handles that count themselves, exceptions for errors. Header only; no binary interface
// of its own. The C header documents every call; the names here are the same without the prefix.
#ifndef PELLUCID_HPP
#define PELLUCID_HPP
#include <pellucid/pellucid.h>

#include <array>
#include <cmath>
#include <cstddef>
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
    // Not on a temporary: `desc.profile = Profile::named("jade").get()` would refer to a released profile.
    H get() const& { return h_; }
    H get() const&& = delete;
    explicit operator bool() const { return h_ != nullptr; }
    void setName(const std::string& name) const { check(pelSetName(h_, name.c_str())); }

  protected:
    H* out() {
        *this = Handle();
        return &h_;
    }
    // A T with the handle that a call of the C interface creates.
    template <class T, class Create, class... Arguments>
    static T made(Create create, Arguments... arguments) {
        T object{H()};
        check(create(arguments..., object.out()));
        return object;
    }
    // `value`, filled in by a call of the C interface.
    template <class Value>
    Value filled(PelError (*call)(H, Value*), Value value) const {
        check(call(h_, &value));
        return value;
    }
    H h_ = nullptr;
};

class Event : public Handle<PelEvent, pelEventRetain, pelEventRelease> {
  public:
    using Handle::Handle;
    void wait() const { check(pelEventWait(h_)); }
    bool isDone() const { return filled(pelEventIsDone, 0) != 0; }
};

class Device : public Handle<PelDevice, pelDeviceRetain, pelDeviceRelease> {
  public:
    // The standard device, or the one that `selector` names; see pelDeviceCreate.
    explicit Device(const std::string& selector = "") { check(pelDeviceCreate(selector.c_str(), out())); }
    explicit Device(const PelDeviceDesc& desc) { check(pelDeviceCreateWith(&desc, out())); }
    // Without a device, to be assigned later.
    explicit Device(std::nullptr_t) {}
    static Device fromCl(void* context, void* deviceId, void* queue) {
        Device device(nullptr);
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
    PelDeviceInfo info() const { return filled(pelDeviceGetInfo, pelDeviceInfoDefaults()); }
    PelDeviceStats stats() const { return filled(pelDeviceGetStats, pelDeviceStatsDefaults()); }
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
        return made<Buffer>(pelBufferCreateFromHost, device.get(), memory, bytes);
    }
    static Buffer fromCl(const Device& device, void* clMem) {
        return made<Buffer>(pelBufferCreateFromCl, device.get(), clMem);
    }
    size_t bytes() const { return filled(pelBufferGetSize, size_t(0)); }
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
    void* map() const { return filled<void*>(pelBufferMap, nullptr); }
    void unmap() const { check(pelBufferUnmap(h_)); }
};

// A C structure and an object that it refers to, kept alive with it. Functions return one if they are passed
// a temporary, because the structure alone would refer to a destroyed object. It does not convert to the
// structure.
template <class Struct, class Kept>
class Owning {
  public:
    Owning(Kept kept, const Struct& made) : kept_(std::move(kept)), made_(made) {}
    Struct* operator->() & { return &made_; }
    const Struct* operator->() const& { return &made_; }
    // Valid for as long as this object.
    const Struct& operator*() const& { return made_; }
    const Struct& operator*() const&& = delete;

  private:
    Kept kept_;
    Struct made_;
};

// Parameter type of functions: either of the two, by reference or by pointer; nullptr where the call allows
// NULL.
template <class Struct, class Kept>
class StructRef {
  public:
    StructRef(const Struct& made) : made_(&made) {}
    StructRef(const Struct* made) : made_(made) {}
    StructRef(const Owning<Struct, Kept>& made) : made_(&*made) {}
    StructRef(const Owning<Struct, Kept>* made) : made_(made ? &**made : nullptr) {}
    StructRef(std::nullptr_t) {}
    const Struct* get() const { return made_; }

  private:
    const Struct* made_ = nullptr;
};

// Named so that hosts may have an Image of their own.
using OwnedImage = Owning<PelImageDesc, Buffer>;
using OwnedVertices = Owning<PelVertexView, Buffer>;
using ImageRef = StructRef<PelImageDesc, Buffer>;
using VerticesRef = StructRef<PelVertexView, Buffer>;

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

// For a temporary buffer, which it keeps alive.
inline OwnedImage imageDesc(Buffer&& buffer, PelFormat format, uint32_t width, uint32_t height,
                            uint64_t byteOffset = 0) {
    const PelImageDesc desc =
        imageDesc(static_cast<const Buffer&>(buffer), format, width, height, byteOffset);
    return OwnedImage(std::move(buffer), desc);
}

inline PelVertexView vertexView(const Buffer& buffer, uint32_t count, uint64_t byteOffset = 0,
                                uint32_t byteStride = 0) {
    return PelVertexView{buffer.get(), byteOffset, byteStride, count};
}

inline OwnedVertices vertexView(Buffer&& buffer, uint32_t count, uint64_t byteOffset = 0,
                                uint32_t byteStride = 0) {
    const PelVertexView view = vertexView(static_cast<const Buffer&>(buffer), count, byteOffset, byteStride);
    return OwnedVertices(std::move(buffer), view);
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
    void normals(const VerticesRef& positions, const VerticesRef& result,
                 const PelSubmit* submit = nullptr) const {
        check(pelMeshNormals(h_, positions.get(), result.get(), submit));
    }
    // With normals made from the positions.
    void curvature(const PelCurvatureParams& params, const VerticesRef& positions, const VerticesRef& result,
                   PelMeshReport* report = nullptr, const PelSubmit* submit = nullptr) const {
        check(pelMeshCurvature(h_, &params, positions.get(), nullptr, result.get(), report, submit));
    }
    void curvature(const PelCurvatureParams& params, const VerticesRef& positions, const VerticesRef& normals,
                   const VerticesRef& result, PelMeshReport* report = nullptr,
                   const PelSubmit* submit = nullptr) const {
        check(pelMeshCurvature(h_, &params, positions.get(), normals.get(), result.get(), report, submit));
    }
    float uvScale(const VerticesRef& positions, const VerticesRef& uvs) const {
        float scale = 0;
        check(pelMeshUvScale(h_, positions.get(), uvs.get(), &scale));
        return scale;
    }
};

// Writes the triangles to `indices`, reversed where neighbours disagree; `normals` may be NULL.
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
    // Updates all vertices. normals NULL: they are made from the positions.
    void update(const VerticesRef& positions, const VerticesRef& normals, const VerticesRef& curvature,
                const PelSubmit* submit = nullptr) const {
        check(pelLiveMeshUpdate(h_, positions.get(), normals.get(), curvature.get(), nullptr, 0, submit));
    }
    // Only `changed`, which may be empty.
    void update(const VerticesRef& positions, const VerticesRef& normals, const VerticesRef& curvature,
                const std::vector<PelVertexRange>& changed, const PelSubmit* submit = nullptr) const {
        static constexpr PelVertexRange none{};
        check(pelLiveMeshUpdate(h_, positions.get(), normals.get(), curvature.get(),
                                changed.empty() ? &none : changed.data(), uint32_t(changed.size()), submit));
    }
    PelLiveMeshStats stats() const { return filled(pelLiveMeshGetStats, pelLiveMeshStatsDefaults()); }
};

// Any of positions, depth and ids may be NULL, but not both of the first two.
inline void screenCurvature(const Device& device, const PelScreenCurvatureParams& params,
                            const ImageRef& normals, const ImageRef& positions, const ImageRef& depth,
                            const ImageRef& ids, const ImageRef& curvature,
                            const PelSubmit* submit = nullptr) {
    check(pelScreenCurvature(device.get(), &params, normals.get(), positions.get(), depth.get(), ids.get(),
                             curvature.get(), submit));
}

// RGB per point: pelSurfaceIntegral.
inline void surfaceIntegral(const Device& device, const PelSurfaceIntegralDesc& desc,
                            const PelSubmit* submit = nullptr) {
    check(pelSurfaceIntegral(device.get(), &desc, submit));
}

inline PelSkinInfo skinInfo(const PelSkin& skin) {
    PelSkinInfo info = pelSkinInfoDefaults();
    check(pelSkinGetInfo(&skin, &info));
    return info;
}

class Profile : public Handle<PelProfile, pelProfileRetain, pelProfileRelease> {
  public:
    using Handle::Handle;
    static Profile skin() { return made<Profile>(pelProfileCreateSkin); }
    static Profile gaussians(const std::vector<PelGaussian>& gaussians) {
        return made<Profile>(pelProfileCreateGaussians, gaussians.data(), uint32_t(gaussians.size()));
    }
    static Profile burley(const float (&meanFreePath)[3], const float (&albedo)[3],
                          PelBurleyFit fit = PEL_BURLEY_DIFFUSE_TRANSMISSION) {
        return made<Profile>(pelProfileCreateBurley, meanFreePath, albedo, fit);
    }
    static Profile burleyDistance(const float (&distance)[3]) {
        return made<Profile>(pelProfileCreateBurleyDistance, distance);
    }
    static Profile skinLayers(const PelSkin& skin) {
        return made<Profile>(pelProfileCreateSkinLayers, &skin);
    }
    // A material of the library.
    static Profile named(const std::string& name) {
        return made<Profile>(pelProfileCreateNamed, name.c_str());
    }
    static std::vector<std::string> libraryNames() {
        std::vector<std::string> names;
        for (uint32_t i = 0; const char* name = pelProfileLibraryName(i); ++i) names.push_back(name);
        return names;
    }
    static Profile dipole(const float (&absorption)[3], const float (&reducedScattering)[3], float eta) {
        return made<Profile>(pelProfileCreateDipole, absorption, reducedScattering, eta);
    }
    // values: RGB per distance.
    static Profile table(const std::vector<float>& distances, const std::vector<float>& values) {
        if (values.size() != 3 * distances.size())
            throw Error(PEL_ERROR_INVALID_ARGUMENT, "a table needs three values per distance");
        Profile p;
        check(pelProfileCreateTable(distances.data(), values.data(), uint32_t(distances.size()), p.out()));
        return p;
    }
    PelProfileInfo info() const { return filled(pelProfileGetInfo, pelProfileInfoDefaults()); }
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
    void set(PelImageSlot slot, const ImageRef& image) { check(pelScatterSetImage(h_, slot, image.get())); }
    void clear(PelImageSlot slot) { check(pelScatterSetImage(h_, slot, nullptr)); }
    // Any of positions, depth and ids may be NULL, but not both of the first two.
    void execute(const PelScatterParams& params, const ImageRef& irradiance, const ImageRef& positions,
                 const ImageRef& depth, const ImageRef& ids, const ImageRef& scattered,
                 const PelSubmit* submit = nullptr) {
        check(pelScatterExecute(h_, &params, irradiance.get(), positions.get(), depth.get(), ids.get(),
                                scattered.get(), submit));
    }
    // Builds the programs of such an execution before it (pelWarmUpPrograms). Returns how many were missing.
    uint32_t warmUp(const Device& device, const PelScatterParams& params, const ImageRef& irradiance,
                    const ImageRef& positions, const ImageRef& depth, const ImageRef& ids,
                    const ImageRef& scattered) const {
        PelScatterWork scatter = pelScatterWorkDefaults();
        scatter.scatter = h_;
        scatter.params = &params;
        scatter.irradiance = irradiance.get();
        scatter.positions = positions.get();
        scatter.depth = depth.get();
        scatter.ids = ids.get();
        scatter.out = scattered.get();
        PelWarmUp work = pelWarmUpDefaults();
        work.scatters = &scatter;
        work.numScatters = 1;
        uint32_t built = 0;
        check(pelWarmUpPrograms(device.get(), &work, &built));
        return built;
    }
    PelScatterStats stats() const { return filled(pelScatterGetStats, pelScatterStatsDefaults()); }
};

// Scattering in the texture of a mesh.
class TextureScatter : public Handle<PelTextureScatter, pelTextureScatterRetain, pelTextureScatterRelease> {
  public:
    using Handle::Handle;
    TextureScatter(const Device& device, const PelTextureScatterDesc& desc) {
        check(pelTextureScatterCreate(device.get(), &desc, out()));
    }
    void setPositions(const VerticesRef& positions, const PelSubmit* submit = nullptr) {
        check(pelTextureScatterSetPositions(h_, positions.get(), submit));
    }
    void draw(const VerticesRef& values, bool unit, const ImageRef& image,
              const PelSubmit* submit = nullptr) {
        check(pelTextureScatterDraw(h_, values.get(), unit, image.get(), submit));
    }
    void execute(const PelTextureScatterParams& params, const ImageRef& irradiance, const ImageRef& albedo,
                 const ImageRef& scattered, const PelSubmit* submit = nullptr) {
        check(pelTextureScatterExecute(h_, &params, irradiance.get(), albedo.get(), scattered.get(), submit));
    }
    PelTextureScatterStats stats() const {
        return filled(pelTextureScatterGetStats, pelTextureScatterStatsDefaults());
    }
};

using Float3 = std::array<float, 3>;

// A material of a profile, whose tables, widths and transmission follow from it.
inline PelMaterial material(const Profile& profile, const Float3& albedo) {
    PelMaterial made = pelMaterialDefaults();
    made.profile = profile.get();
    for (size_t c = 0; c < 3; ++c) made.albedo[c] = albedo[c];
    return made;
}
using OwnedMaterial = Owning<PelMaterial, Profile>;
using MaterialRef = StructRef<PelMaterial, Profile>;
inline OwnedMaterial material(Profile&& profile, const Float3& albedo) {
    const PelMaterial made = material(static_cast<const Profile&>(profile), albedo);
    return OwnedMaterial(std::move(profile), made);
}

// Lights without a shadow. `color`: PelLight.color. `toLight` may have any length.
inline PelLight directionalLight(const Float3& toLight, const Float3& color) {
    PelLight light = pelLightDefaults();
    light.type = PEL_LIGHT_DIRECTIONAL;
    const float length =
        std::sqrt(toLight[0] * toLight[0] + toLight[1] * toLight[1] + toLight[2] * toLight[2]);
    for (size_t i = 0; i < 3; ++i) light.toLight[i] = toLight[i] / length, light.color[i] = color[i];
    return light;
}
inline PelLight pointLight(const Float3& position, const Float3& color) {
    PelLight light = pelLightDefaults();
    light.type = PEL_LIGHT_POINT;
    for (size_t i = 0; i < 3; ++i) light.position[i] = position[i], light.color[i] = color[i];
    return light;
}
inline PelLight sphereLight(const Float3& center, float radius, const Float3& color) {
    PelLight light = pointLight(center, color);
    light.type = PEL_LIGHT_SPHERE;
    light.radius = radius;
    return light;
}
// It shines along halfWidth x halfHeight.
inline PelLight rectangleLight(const Float3& center, const Float3& halfWidth, const Float3& halfHeight,
                               const Float3& color) {
    PelLight light = pointLight(center, color);
    light.type = PEL_LIGHT_RECTANGLE;
    for (size_t i = 0; i < 3; ++i) light.halfWidth[i] = halfWidth[i], light.halfHeight[i] = halfHeight[i];
    return light;
}
inline PelCamera cameraAt(const Float3& position) {
    PelCamera camera = pelCameraDefaults();
    for (size_t i = 0; i < 3; ++i) camera.position[i] = position[i];
    return camera;
}

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
        check(
            pelLutCreateFromTexels(device.get(), &info, texels.data(), texels.size() * sizeof(float), out()));
    }
    PelLutInfo info() const { return filled(pelLutGetInfo, pelLutInfoDefaults()); }
    // Texels that PEL_LUT_FACEWORKS8 clips.
    uint64_t clippedTexels() const { return filled(pelLutCountClipped, uint64_t(0)); }
    // The texels in the element type of the encoding: float, uint16_t (half) or uint8_t.
    template <class T>
    std::vector<T> read(PelLutEncoding encoding) const {
        size_t bytes = 0;
        check(pelLutGetSize(h_, encoding, &bytes));
        std::vector<T> texels(bytes / sizeof(T));
        check(pelLutRead(h_, encoding, texels.data(), bytes, nullptr));
        return texels;
    }
    // Tables of one kind and size, one below the other, in `bytes` bytes (pelLutReadStack).
    static void readStack(const Device& device, const std::vector<PelLutInfo>& tables,
                          PelLutEncoding encoding, void* destination, size_t bytes) {
        check(pelLutReadStack(device.get(), tables.data(), uint32_t(tables.size()), encoding, destination,
                              bytes));
    }
};

class Shader : public Handle<PelShader, pelShaderRetain, pelShaderRelease> {
  public:
    using Handle::Handle;
    explicit Shader(const Device& device) { check(pelShaderCreate(device.get(), out())); }
    Shader& set(const PelShaderOptions& options) { return done(pelShaderSetOptions(h_, &options)); }
    Shader& set(PelImageSlot slot, const ImageRef& image) {
        return done(pelShaderSetImage(h_, slot, image.get()));
    }
    Shader& clear(PelImageSlot slot) { return done(pelShaderSetImage(h_, slot, nullptr)); }
    Shader& setMaterial(uint32_t id, const MaterialRef& material, const Lut& curvature = {},
                        const Lut& shadow = {}) {
        return done(pelShaderSetMaterial(h_, id, material.get(), curvature.get(), shadow.get()));
    }
    // Each level half the size of the one before; none: no normal map.
    Shader& setNormalMap(uint32_t id, const std::vector<PelImageDesc>& levels) {
        return done(pelShaderSetNormalMap(h_, id, levels.data(), uint32_t(levels.size())));
    }
    // A map of one level.
    Shader& setNormalMap(uint32_t id, const OwnedImage& level) {
        return done(pelShaderSetNormalMap(h_, id, &*level, 1));
    }
    // The texture that PEL_SCATTERING_TEXTURE samples.
    Shader& setScatteredTexture(uint32_t id, const ImageRef& texture) {
        return done(pelShaderSetScatteredTexture(h_, id, texture.get()));
    }
    Shader& clearScatteredTexture(uint32_t id) { return done(pelShaderSetScatteredTexture(h_, id, nullptr)); }
    // Turns a material that is set into an eye. Without `caustics` the table is made.
    Shader& setEye(uint32_t id, const PelEye& eye, const Lut& caustics = {}) {
        return done(pelShaderSetEye(h_, id, &eye, caustics.get()));
    }
    Shader& clearEye(uint32_t id) { return done(pelShaderSetEye(h_, id, nullptr, nullptr)); }
    Shader& setIrisTexture(uint32_t id, const ImageRef& texture) {
        return done(pelShaderSetIrisTexture(h_, id, texture.get()));
    }
    Shader& clearIrisTexture(uint32_t id) { return done(pelShaderSetIrisTexture(h_, id, nullptr)); }
    Shader& setReflectionCube(const ImageRef& faces) {
        return done(pelShaderSetReflectionCube(h_, faces.get()));
    }
    // `axes`: 9 numbers, or nullptr.
    Shader& setEnvironment(const ImageRef& image, const float* axes = nullptr) {
        return done(pelShaderSetEnvironment(h_, image.get(), axes));
    }
    Shader& clearEnvironment() { return done(pelShaderSetEnvironment(h_, nullptr, nullptr)); }
    Shader& clearReflectionCube() { return done(pelShaderSetReflectionCube(h_, nullptr)); }
    Shader& set(const std::vector<PelLight>& lights) {
        return done(pelShaderSetLights(h_, lights.data(), uint32_t(lights.size())));
    }
    Shader& set(const PelLight& light) { return done(pelShaderSetLights(h_, &light, 1)); }  // the only one
    Shader& set(uint32_t light, PelLightSlot slot, const ImageRef& image) {
        return done(pelShaderSetLightImage(h_, light, slot, image.get()));
    }
    Shader& set(const PelAmbient& ambient) { return done(pelShaderSetAmbient(h_, &ambient)); }
    Shader& setAmbientCube(const ImageRef& faces) { return done(pelShaderSetAmbientCube(h_, faces.get())); }
    Shader& clearAmbientCube() { return done(pelShaderSetAmbientCube(h_, nullptr)); }
    Shader& set(const PelCamera& camera) { return done(pelShaderSetCamera(h_, &camera)); }
    Shader& commit() { return done(pelShaderCommit(h_)); }
    void execute(const PelSubmit* submit = nullptr) const { check(pelShaderExecute(h_, submit)); }
    PelMaterial material(uint32_t id) const {
        PelMaterial material = pelMaterialDefaults();
        check(pelShaderGetMaterial(h_, id, &material));
        return material;
    }
    std::string warnings() const { return filled<const char*>(pelShaderGetWarnings, ""); }
    PelShaderStats stats() const { return filled(pelShaderGetStats, pelShaderStatsDefaults()); }
    std::vector<PelPassStats> passes() const { return listed(pelShaderGetPasses, pelPassStatsDefaults()); }
    std::vector<PelPassMemory> memory() const { return listed(pelShaderGetMemory, pelPassMemoryDefaults()); }

  private:
    template <class T>
    std::vector<T> listed(PelError (*read)(PelShader, T*, uint32_t*), const T& each) const {
        std::vector<T> all(24, each);
        uint32_t count = uint32_t(all.size());
        check(read(h_, all.data(), &count));
        all.resize(count);
        return all;
    }
    Shader& done(PelError code) {
        check(code);
        return *this;
    }
};

// Builds programs before they are needed (pelWarmUpPrograms): those of the groups (PelProgramGroup bits), and
// those that the shaders would build at their commit. Returns the number of programs built.
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

#endif  // PELLUCID_HPP
