// EGL and OpenGL 4.5 for the renderer: a context without a window, programs, textures, targets.
#pragma once
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <GL/glcorearb.h>

#include <string>
#include <vector>

namespace gl {

// Current in this thread until the process ends. Throws std::runtime_error where there is none.
void makeContext();

struct Texture {
    GLuint name = 0;
    GLenum internalFormat = 0, format = 0, type = 0;  // format and type: of its texels in memory
    GLsizei width = 0, height = 0;
    size_t bytes = 0;
};

Texture texture(GLsizei width, GLsizei height, GLenum internalFormat);

struct Target {
    GLuint framebuffer = 0;
    GLsizei width = 0, height = 0;
    void begin(bool depthTest) const;  // cleared to 0, depth to 1
};

// Draws into the textures, with a depth buffer of its own.
Target target(const std::vector<Texture>& textures);

// Throws std::runtime_error with the compiler's message.
GLuint program(const std::string& vertex, const std::string& fragment);

// Three corners that cover the target, of a program that reads `inputs` at units 0, 1, ...
void drawOver(GLuint program, const std::vector<Texture>& inputs);

}  // namespace gl
