// A small deferred renderer: shadow maps, G-buffer, its own lighting of all that is not skin, tone mapping.
#pragma once
#include <pellucid/pellucid.h>

#include "gl.h"
#include "mesh.h"

using Matrix = std::array<float, 16>;  // columns one after another, as OpenGL's

struct Light {
    Matrix viewProjection;  // that its shadow map is drawn with
    PelLight light;         // the same, as Pellucid sees it
    gl::Texture map;        // R32F: depth
};

class Renderer {
  public:
    // `head` stands at the origin and looks to +z.
    Renderer(const Mesh& head, const std::vector<Float3>& normals, GLsizei width, GLsizei height);

    // What Pellucid is given, all with the highest row first.
    gl::Texture depth;     // R32F, 0 at the near plane
    gl::Texture normalId;  // RGBA16F: normal in world space, id
    gl::Texture albedo;    // sRGB
    gl::Texture radiance;  // RGBA16F, linear
    std::vector<Light> lights;
    PelCamera camera;
    PelAmbient ambient;

    // The head turned by `angle` about the vertical axis: everything above but the light on skin.
    void draw(float angle);
    // sRGB, RGBA, highest row first, of an image of the G-buffer's size.
    std::vector<uint8_t> picture(const gl::Texture& linear) const;

  private:
    void drawScene(GLuint program, const Matrix& viewProjection) const;

    GLsizei count_ = 0;  // of indices
    float angle_ = 0;
    Matrix viewProjection_{};
    std::vector<gl::Target> maps_;
    gl::Target gbuffer_, lit_, shown_;
    GLuint depthProgram_ = 0, gbufferProgram_ = 0, lightingProgram_ = 0, toneProgram_ = 0;
};
