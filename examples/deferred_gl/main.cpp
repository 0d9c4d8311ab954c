// A deferred renderer in OpenGL whose skin is shaded by Pellucid: a head turns before a wall under three
// lights with shadow maps, and each frame becomes a PNG file (`usage` below).
//
// Needs OpenGL 4.5 through EGL, without a window: a GPU's driver, or Mesa without one. Textures are shared
// where a driver has cl_khr_gl_sharing, and copied where none has, or with --copy. --stages also writes the
// images of the first frame. docs/guide/hosts.md walks through it.
#include <png.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "skin.h"

using namespace pellucid;

namespace {

std::vector<Float3> normalsOf(const Device& device, const Mesh& mesh) {
    const std::vector<uint32_t> indices = mesh.triangles();
    PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
    const auto count = uint32_t(mesh.positions.size());
    desc.numVertices = count;
    desc.indices = indices.data();
    desc.numIndices = uint32_t(indices.size());
    const MeshTopology topology(device, desc);
    const Buffer normals(device, count * sizeof(Float3));
    topology.normals(vertexView(Buffer(device, mesh.positions), count), vertexView(normals, count));
    return normals.readAll<Float3>();
}

void writePng(const std::string& path, const Renderer& renderer, const gl::Texture& linear) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(renderer.radiance.width), image.height = png_uint_32(renderer.radiance.height);
    image.format = PNG_FORMAT_RGBA;
    if (!png_image_write_to_file(&image, path.c_str(), 0, renderer.picture(linear).data(), 0, nullptr))
        throw std::runtime_error(path + ": " + image.message);
}

constexpr const char* usage =
    "usage: deferred_gl HEAD.obj FOLDER [--frames N] [--size WxH] [--method auto|none|light|screen] [--copy] "
    "[--stages]";

struct Options {
    std::string head, folder;
    int frames = 60, width = 640, height = 640;
    PelScattering method = PEL_SCATTERING_AUTO;
    bool copy = false, stages = false;
};

Options parsed(int argc, char** argv) {
    Options o;
    const std::pair<const char*, PelScattering> methods[] = {{"auto", PEL_SCATTERING_AUTO},
                                                             {"none", PEL_SCATTERING_NONE},
                                                             {"light", PEL_SCATTERING_LIGHT},
                                                             {"screen", PEL_SCATTERING_SCREEN}};
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i], value = i + 1 < argc ? argv[i + 1] : "";
        char rest = 0;
        bool good = true;
        if (word == "--copy") {
            o.copy = true;
        } else if (word == "--stages") {
            o.stages = true;
        } else if (word == "--frames") {
            good = std::sscanf(value.c_str(), "%d%c", &o.frames, &rest) == 1 && o.frames > 0, ++i;
        } else if (word == "--size") {
            good = std::sscanf(value.c_str(), "%dx%d%c", &o.width, &o.height, &rest) == 2 &&
                   std::min(o.width, o.height) > 0 && std::max(o.width, o.height) <= 8192;
            ++i;
        } else if (word == "--method") {
            const auto* found = std::find_if(std::begin(methods), std::end(methods),
                                             [&](const auto& m) { return value == m.first; });
            good = found != std::end(methods), ++i;
            if (good) o.method = found->second;
        } else {
            good = word[0] != '-' && o.folder.empty();
            (o.head.empty() ? o.head : o.folder) = word;
        }
        if (!good) throw std::runtime_error("cannot use " + word + " " + value + "\n" + usage);
    }
    if (o.folder.empty()) throw std::runtime_error(usage);
    return o;
}

double median(std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) try {
    const Options o = parsed(argc, argv);
    const Mesh head = subdivided(readObj(o.head));
    try {
        gl::makeContext();
    } catch (const std::runtime_error& e) {
        std::fprintf(stderr, "deferred_gl: %s\n", e.what());
        return 77;
    }
    Renderer renderer(head, normalsOf(Device(), head), o.width, o.height);
    SkinPass skin(renderer, o.method, o.copy);
    std::printf("%s draws, %s shades; %zu of %zu textures are shared, the others are copied\n",
                reinterpret_cast<const char*>(glGetString(GL_RENDERER)), skin.device().info().name,
                skin.sharedTextures(), skin.textures());
    std::filesystem::create_directories(o.folder);
    std::vector<double> drawing, copying, shading;
    for (int frame = 0; frame < o.frames; ++frame) {
        const auto start = std::chrono::steady_clock::now();
        renderer.draw(1.2f * std::sin(6.2831853f * float(frame) / float(o.frames)));
        if (o.stages && frame == 0) {
            writePng(o.folder + "/normal.png", renderer, renderer.normalId);
            writePng(o.folder + "/albedo.png", renderer, renderer.albedo);
            writePng(o.folder + "/without-skin.png", renderer, renderer.radiance);
        }
        glFinish();
        const auto drawn = std::chrono::steady_clock::now();
        skin.run();
        const std::chrono::duration<double, std::milli> draw = drawn - start,
                                                        skinned = std::chrono::steady_clock::now() - drawn;
        drawing.push_back(draw.count());
        copying.push_back(skin.copyMilliseconds());
        shading.push_back(skinned.count() - skin.copyMilliseconds());
        char name[32];
        std::snprintf(name, sizeof name, "/frame-%03d.png", frame);
        writePng(o.folder + name, renderer, renderer.radiance);
    }
    std::printf("%d frames of %d x %d, medians: drawing %.1f ms, handing over %.1f ms, skin %.1f ms\n",
                o.frames, o.width, o.height, median(drawing), median(copying), median(shading));
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "deferred_gl: %s\n", e.what());
    return 1;
}
