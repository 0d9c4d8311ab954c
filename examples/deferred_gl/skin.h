// Pellucid between the renderer's lighting and its tone mapping: reads the G-buffer and the shadow maps, and
// writes pixels of skin into the radiance.
#pragma once
#define CL_TARGET_OPENCL_VERSION 300
#include <CL/cl.h>

#include <pellucid/pellucid.hpp>

#include "renderer.h"

class SkinPass {
  public:
    // `copy`: does not try to share textures. `method` is by the names of `pellucid shade --method`.
    SkinPass(const Renderer& renderer, PelScattering method, bool copy);
    size_t textures() const { return images_.size(); }
    size_t sharedTextures() const;  // the others are copied
    const pellucid::Device& device() const { return device_; }
    void run();
    double copyMilliseconds() const { return copyMilliseconds_; }  // of the last run

  private:
    struct Image {
        gl::Texture texture;
        pellucid::Buffer buffer;
        cl_mem shared = nullptr;
    };
    bool share();
    void download(const Image& image) const;

    pellucid::Device device_{nullptr};
    std::vector<Image> images_;  // the radiance is the first
    pellucid::Shader shader_;
    cl_context context_ = nullptr;
    cl_command_queue queue_ = nullptr;
    double copyMilliseconds_ = 0;
};
