// Every type of handle with a way to make, use, count and hold one.
#pragma once
#include "test.h"

namespace handles {

using Handle = void*;

struct Kind {
    std::string name;
    std::function<Handle()> create;
    std::function<void(Handle)> retain, release;
    std::function<PelError(Handle)> use;
    // Makes another object that holds this one, and says whether that one still works.
    std::function<std::function<bool()>(Handle)> hold;
};

inline const pellucid::MeshTopology& triangle() {
    static const pellucid::MeshTopology mesh = [] {
        static const uint32_t indices[3] = {0, 1, 2};
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.numVertices = desc.numIndices = 3;
        desc.indices = indices;
        return pellucid::MeshTopology(device(), desc);
    }();
    return mesh;
}

// `make`: an object of C++, of which the handle is taken.
template <class H, class Make>
Kind kind(const char* name, void (*retain)(H), void (*release)(H), Make make, std::function<PelError(H)> use,
          std::function<std::function<bool()>(H)> hold) {
    return {name,
            [=]() -> Handle {
                const auto made = make();
                retain(made.get());
                return made.get();
            },
            [retain](Handle h) { retain(static_cast<H>(h)); },
            [release](Handle h) { release(static_cast<H>(h)); },
            [use](Handle h) { return use(static_cast<H>(h)); },
            [hold](Handle h) { return hold(static_cast<H>(h)); }};
}

// Reads its statistics or the like.
template <class H, class S>
auto reading(S (*defaults)(), PelError (*get)(H, S*)) {
    return [=](H h) {
        S values = defaults();
        return get(h, &values);
    };
}

// Of objects that no other holds.
inline std::function<bool()> held(void*) {
    return [] { return true; };
}

inline pellucid::Lut smallTable(PelProfile profile = nullptr) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.width = desc.height = 4;
    desc.profile = profile;
    return pellucid::Lut(device(), desc);
}

inline const std::vector<Kind>& kinds() {
    using namespace pellucid;
    static const std::vector<Kind> all{
        kind<PelDevice>(
            "PelDevice", pelDeviceRetain, pelDeviceRelease, [] { return Device(""); }, pelDeviceFinish,
            [](PelDevice h) {
                PelBuffer made = nullptr;
                const int value = 7;
                check(pelBufferCreate(h, sizeof value, &value, &made));
                return [buffer = Buffer(made)] { return buffer.readAll<int>() == std::vector<int>{7}; };
            }),
        kind<PelEvent>(
            "PelEvent", pelEventRetain, pelEventRelease,
            [] {
                PelEvent done = nullptr;
                const PelSubmit submit{nullptr, 0, &done};
                static const Buffer buffer(device(), 16);
                buffer.read(nullptr, 0, 0, &submit);
                return Event(done);
            },
            pelEventWait,
            [](PelEvent h) {  // only the driver holds events
                void* event = nullptr;
                check(pelEventGetCl(h, &event));
                PelEvent other = nullptr;
                check(pelEventCreateFromCl(device().get(), event, &other));
                return [kept = Event(other)] {
                    kept.wait();
                    return kept.isDone();
                };
            }),
        kind<PelBuffer>(
            "PelBuffer", pelBufferRetain, pelBufferRelease, [] { return Buffer(device(), 64); },
            [](PelBuffer h) {
                size_t bytes = 0;
                return pelBufferGetSize(h, &bytes);
            },
            [](PelBuffer h) {
                Shader shader(device());
                PelImageDesc image = pelImageDescDefaults();
                image.buffer = h, image.width = 4, image.height = 4, image.format = PEL_FORMAT_R32F;
                shader.set(PEL_SLOT_THICKNESS, image);
                return [shader] {
                    PelShaderStats stats = pelShaderStatsDefaults();
                    return pelShaderGetStats(shader.get(), &stats) == PEL_SUCCESS;
                };
            }),
        kind<PelMeshTopology>(
            "PelMeshTopology", pelMeshTopologyRetain, pelMeshTopologyRelease,
            [] {
                const std::vector<char> saved = triangle().save();
                return MeshTopology::load(device(), saved.data(), saved.size());
            },
            [](PelMeshTopology h) {
                size_t size = 0;
                return pelMeshTopologySave(h, nullptr, &size);
            },
            [](PelMeshTopology h) {
                PelLiveMesh live = nullptr;
                const PelCurvatureParams params = pelCurvatureParamsDefaults();
                check(pelLiveMeshCreate(h, &params, &live));
                const Buffer positions(device(), std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}),
                    out(device(), 12);
                return [positions, out, mesh = LiveMesh(live)] {
                    mesh.update(vertexView(positions, 3), nullptr, vertexView(out, 3));
                    return out.readAll<float>() == std::vector<float>(3, 0);
                };
            }),
        kind<PelLiveMesh>(
            "PelLiveMesh", pelLiveMeshRetain, pelLiveMeshRelease,
            [] { return LiveMesh(triangle(), pelCurvatureParamsDefaults()); },
            reading(pelLiveMeshStatsDefaults, pelLiveMeshGetStats), held),
        kind<PelLut>(
            "PelLut", pelLutRetain, pelLutRelease, [] { return smallTable(); },
            reading(pelLutInfoDefaults, pelLutGetInfo),
            [](PelLut h) {
                Shader shader(device());
                const PelMaterial material = pelMaterialDefaults();
                check(pelShaderSetMaterial(shader.get(), 1, &material, h, nullptr));
                return [shader] {
                    const PelMaterial again = pelMaterialDefaults();
                    return pelShaderSetMaterial(shader.get(), 1, &again, nullptr, nullptr) == PEL_SUCCESS;
                };
            }),
        kind<PelShader>(
            "PelShader", pelShaderRetain, pelShaderRelease, [] { return Shader(device()); },
            reading(pelShaderStatsDefaults, pelShaderGetStats), held),
        kind<PelScatter>(
            "PelScatter", pelScatterRetain, pelScatterRelease, [] { return Scatter(device()); },
            reading(pelScatterStatsDefaults, pelScatterGetStats), held),
        kind<PelTextureScatter>(
            "PelTextureScatter", pelTextureScatterRetain, pelTextureScatterRelease,
            [] {
                PelTextureScatterDesc desc = pelTextureScatterDescDefaults();
                desc.width = desc.height = 1;
                return TextureScatter(device(), desc);
            },
            reading(pelTextureScatterStatsDefaults, pelTextureScatterGetStats), held),
        kind<PelProfile>(
            "PelProfile", pelProfileRetain, pelProfileRelease, [] { return Profile::skin(); },
            reading(pelProfileInfoDefaults, pelProfileGetInfo),
            [](PelProfile h) {
                return [table = smallTable(h)] { return table.read<float>(PEL_LUT_FLOAT).size() == 48; };
            }),
    };
    return all;
}

// Whether a handle is somebody's, of whatever type.
inline bool isLive(Handle h) {
    for (const Kind& kind : kinds())
        if (kind.use(h) == PEL_SUCCESS) return true;
    return false;
}

}  // namespace handles
