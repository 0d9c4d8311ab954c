#include "skin.h"

#include <CL/cl_gl.h>

#include <algorithm>
#include <chrono>
#include <cstring>

using namespace pellucid;

namespace {

PelFormat formatOf(const gl::Texture& texture) {
    return texture.internalFormat == GL_R32F           ? PEL_FORMAT_R32F
           : texture.internalFormat == GL_SRGB8_ALPHA8 ? PEL_FORMAT_RGBA8_SRGB
                                                       : PEL_FORMAT_RGBA16F;
}

bool hasGlSharing(cl_device_id device) {
    size_t size = 0;
    if (clGetDeviceInfo(device, CL_DEVICE_EXTENSIONS, 0, nullptr, &size)) return false;
    std::string names(size, ' ');
    clGetDeviceInfo(device, CL_DEVICE_EXTENSIONS, size, names.data(), nullptr);
    return names.find("cl_khr_gl_sharing") != std::string::npos;
}

}  // namespace

// Looks for an OpenCL device that can share textures of the current OpenGL context.
bool SkinPass::share() {
    cl_platform_id platforms[16];
    cl_uint numPlatforms = 0;
    if (clGetPlatformIDs(16, platforms, &numPlatforms)) return false;
    for (cl_uint p = 0; p < numPlatforms && p < 16; ++p) {
        cl_device_id devices[16];
        cl_uint numDevices = 0;
        if (clGetDeviceIDs(platforms[p], CL_DEVICE_TYPE_ALL, 16, devices, &numDevices)) continue;
        for (cl_uint d = 0; d < numDevices && d < 16; ++d) {
            if (!hasGlSharing(devices[d])) continue;
            const cl_context_properties properties[] = {
                CL_GL_CONTEXT_KHR,
                reinterpret_cast<cl_context_properties>(eglGetCurrentContext()),
                CL_EGL_DISPLAY_KHR,
                reinterpret_cast<cl_context_properties>(eglGetCurrentDisplay()),
                CL_CONTEXT_PLATFORM,
                reinterpret_cast<cl_context_properties>(platforms[p]),
                0};
            cl_int error = CL_SUCCESS;
            context_ = clCreateContext(properties, 1, &devices[d], nullptr, nullptr, &error);
            if (!context_) continue;  // OpenGL draws on another device
            queue_ = clCreateCommandQueueWithProperties(context_, devices[d], nullptr, &error);
            if (queue_) {
                device_ = Device::fromCl(context_, devices[d], queue_);
                return true;
            }
            clReleaseContext(context_);
            context_ = nullptr;
        }
    }
    return false;
}

SkinPass::SkinPass(const Renderer& renderer, PelScattering method, bool copy) {
    std::vector<gl::Texture> textures = {renderer.radiance, renderer.depth, renderer.normalId,
                                         renderer.albedo};
    for (const Light& light : renderer.lights) textures.push_back(light.map);
    if (copy || !share()) device_ = Device("");
    for (const gl::Texture& texture : textures) {
        Image image{texture, {}};
        cl_int error = CL_SUCCESS;
        // A driver shares the formats that it lists, some without sRGB.
        if (context_)
            image.shared =
                clCreateFromGLTexture(context_, images_.empty() ? CL_MEM_READ_WRITE : CL_MEM_READ_ONLY,
                                      GL_TEXTURE_2D, 0, texture.name, &error);
        image.buffer = image.shared ? Buffer::fromCl(device_, image.shared) : Buffer(device_, texture.bytes);
        images_.push_back(std::move(image));
    }
    const auto described = [](const Image& image) {
        return imageDesc(image.buffer, formatOf(image.texture), uint32_t(image.texture.width),
                         uint32_t(image.texture.height));
    };
    PelImageDesc ids = described(images_[2]);  // the fourth of four halfs
    ids.format = PEL_FORMAT_R16F, ids.byteOffset = 6, ids.pixelStride = 8;
    shader_ = Shader(device_);
    shader_.set(PEL_SLOT_RADIANCE, described(images_[0]))
        .set(PEL_SLOT_DEPTH, described(images_[1]))
        .set(PEL_SLOT_NORMAL_SHADING, described(images_[2]))
        .set(PEL_SLOT_MATERIAL, ids)
        .set(PEL_SLOT_ALBEDO, described(images_[3]));
    const Profile profile = Profile::named("skin-burley");
    PelMaterial skin = material(profile, {1, 1, 1});
    skin.scattering = method;
    skin.specularModel = PEL_SPECULAR_GGX;
    skin.specular = 1;
    skin.roughness = 0.4f;
    shader_.setMaterial(Skin, skin);
    std::vector<PelLight> lights;
    for (const Light& light : renderer.lights) lights.push_back(light.light);
    shader_.set(lights);
    for (size_t i = 0; i < lights.size(); ++i)
        shader_.set(uint32_t(i), PEL_LIGHT_SHADOW_MAP, described(images_[4 + i]));
    shader_.set(renderer.ambient).set(renderer.camera);
    // Camera and lights do not move here. If they move, set them and commit in each frame.
    shader_.commit();
}

void SkinPass::download(const Image& image) const {
    void* memory = image.buffer.map();  // the buffer itself where the device is the CPU
    glGetTextureImage(image.texture.name, 0, image.texture.format, image.texture.type,
                      GLsizei(image.texture.bytes), memory);
    image.buffer.unmap();
}

void SkinPass::run() {
    std::vector<cl_mem> shared;
    const auto start = std::chrono::steady_clock::now();
    for (const Image& image : images_) {
        if (image.shared)
            shared.push_back(image.shared);
        else
            download(image);
    }
    if (!shared.empty()) {
        glFinish();  // cl_khr_gl_event does without
        clEnqueueAcquireGLObjects(queue_, cl_uint(shared.size()), shared.data(), 0, nullptr, nullptr);
    }
    const auto middle = std::chrono::steady_clock::now();
    shader_.execute();
    const auto done = std::chrono::steady_clock::now();
    if (!shared.empty()) {
        clEnqueueReleaseGLObjects(queue_, cl_uint(shared.size()), shared.data(), 0, nullptr, nullptr);
        clFinish(queue_);
    }
    if (!images_[0].shared) {
        const gl::Texture& radiance = images_[0].texture;
        glTextureSubImage2D(radiance.name, 0, 0, 0, radiance.width, radiance.height, radiance.format,
                            radiance.type, images_[0].buffer.map());
        images_[0].buffer.unmap();
    }
    const std::chrono::duration<double, std::milli> copies =
        middle - start + (std::chrono::steady_clock::now() - done);
    copyMilliseconds_ = copies.count();
}

size_t SkinPass::sharedTextures() const {
    return size_t(std::ranges::count_if(images_, [](const Image& i) { return i.shared != nullptr; }));
}
