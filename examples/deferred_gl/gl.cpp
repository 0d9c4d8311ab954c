#include "gl.h"

#include <EGL/eglext.h>

#include <stdexcept>

namespace gl {
namespace {

// `made`, or its log as an exception. The calls are those of shaders or of programs.
GLuint checked(GLuint made, GLenum status, decltype(&glGetShaderiv) get,
               decltype(&glGetShaderInfoLog) getLog) {
    GLint good = 0;
    get(made, status, &good);
    if (good) return made;
    char message[2048] = "";
    getLog(made, sizeof message, nullptr, message);
    throw std::runtime_error(message);
}

GLuint compiled(GLenum kind, const std::string& body) {
    const std::string source = "#version 450 core\n" + body;
    const char* text = source.c_str();
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    return checked(shader, GL_COMPILE_STATUS, glGetShaderiv, glGetShaderInfoLog);
}

}  // namespace

void makeContext() {
    EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (!display) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    EGLContext context = EGL_NO_CONTEXT;
    if (display && eglInitialize(display, nullptr, nullptr) && eglBindAPI(EGL_OPENGL_API))
        context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, version);
    if (!context || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        throw std::runtime_error("EGL gives no OpenGL 4.5 without a window");
    // The first row of every image is its highest, and depth goes from 0 to 1: what Pellucid reads.
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_FRAMEBUFFER_SRGB);
    GLuint vertices = 0;
    glCreateVertexArrays(1, &vertices);
    glBindVertexArray(vertices);
}

Texture texture(GLsizei width, GLsizei height, GLenum internalFormat) {
    Texture made{0, internalFormat, GL_RGBA, GL_HALF_FLOAT, width, height, size_t(8) * width * height};
    if (internalFormat == GL_SRGB8_ALPHA8) made.type = GL_UNSIGNED_BYTE, made.bytes /= 2;
    if (internalFormat == GL_R32F) made.format = GL_RED, made.type = GL_FLOAT, made.bytes /= 2;
    glCreateTextures(GL_TEXTURE_2D, 1, &made.name);
    glTextureStorage2D(made.name, 1, internalFormat, width, height);
    glTextureParameteri(made.name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(made.name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return made;
}

Target target(const std::vector<Texture>& textures) {
    Target made{0, textures[0].width, textures[0].height};
    GLuint depth = 0;
    glCreateFramebuffers(1, &made.framebuffer);
    glCreateRenderbuffers(1, &depth);
    glNamedRenderbufferStorage(depth, GL_DEPTH_COMPONENT32F, made.width, made.height);
    glNamedFramebufferRenderbuffer(made.framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    std::vector<GLenum> buffers;
    for (const Texture& each : textures) {
        buffers.push_back(GLenum(GL_COLOR_ATTACHMENT0 + buffers.size()));
        glNamedFramebufferTexture(made.framebuffer, buffers.back(), each.name, 0);
    }
    glNamedFramebufferDrawBuffers(made.framebuffer, GLsizei(buffers.size()), buffers.data());
    if (glCheckNamedFramebufferStatus(made.framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw std::runtime_error("OpenGL cannot draw into these formats together");
    return made;
}

void Target::begin(bool depthTest) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    (depthTest ? glEnable : glDisable)(GL_DEPTH_TEST);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

GLuint program(const std::string& vertex, const std::string& fragment) {
    const GLuint made = glCreateProgram();
    glAttachShader(made, compiled(GL_VERTEX_SHADER, vertex));
    glAttachShader(made, compiled(GL_FRAGMENT_SHADER, fragment));
    glLinkProgram(made);
    return checked(made, GL_LINK_STATUS, glGetProgramiv, glGetProgramInfoLog);
}

void drawOver(GLuint program, const std::vector<Texture>& inputs) {
    glUseProgram(program);
    for (size_t i = 0; i < inputs.size(); ++i) glBindTextureUnit(GLuint(i), inputs[i].name);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace gl
