#include "renderer.h"

#include <pellucid/pellucid_conventions.hpp>

namespace {

constexpr GLsizei mapSize = 1024;
constexpr size_t numLights = 3;
constexpr PelConvention convention = {PEL_CLIP_DEPTH_ZERO_TO_ONE, 0 /* y up */, 0 /* highest row first */,
                                      1 /* columns */};

Float3 cross(const Float3& a, const Float3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

float dot(const Float3& a, const Float3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Float3 normalized(const Float3& a) {
    const float s = 1 / std::sqrt(dot(a, a));
    return {a[0] * s, a[1] * s, a[2] * s};
}

Matrix operator*(const Matrix& a, const Matrix& b) {
    Matrix out{};
    for (size_t column = 0; column < 4; ++column)
        for (size_t row = 0; row < 4; ++row)
            for (size_t k = 0; k < 4; ++k) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    return out;
}

Matrix lookAt(const Float3& eye, const Float3& at) {
    const Float3 back = normalized({eye[0] - at[0], eye[1] - at[1], eye[2] - at[2]});
    const Float3 right = normalized(cross({0, 1, 0}, back)), up = cross(back, right);
    return {right[0], up[0], back[0], 0, right[1],         up[1],         back[1],         0,
            right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1};
}

Matrix perspective(float degrees, float aspect, float near, float far) {
    const float t = 1 / std::tan(degrees * 3.14159265f / 360);
    return {t / aspect, 0, 0, 0, 0, t, 0, 0, 0, 0, far / (near - far), -1, 0, 0, near * far / (near - far),
            0};
}

Matrix parallel(float half, float near, float far) {
    return {1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, 1 / (near - far), 0, 0, 0, near / (near - far), 1};
}

const char* sceneVertices = R"(
uniform mat4 viewProjection;
uniform vec2 turn;  // cosine and sine
layout(location = 0) in vec3 p; layout(location = 1) in vec3 n; layout(location = 2) in float m;
out vec3 normal, own; flat out float id;
vec3 turned(vec3 v) { return vec3(turn.x * v.x + turn.y * v.z, v.y, turn.x * v.z - turn.y * v.x); }
void main() {
    normal = m == 4 ? n : turned(n), own = n, id = m;
    gl_Position = viewProjection * vec4(m == 4 ? p : turned(p), 1);
})";

const char* depthFragments = "out float depth; void main() { depth = gl_FragCoord.z; }";

const char* gbufferFragments = R"(
in vec3 normal, own; flat in float id;
layout(location = 0) out float depth;
layout(location = 1) out vec4 normalId;
layout(location = 2) out vec4 albedo;
void main() {
    depth = gl_FragCoord.z;
    normalId = vec4(normalize(normal), id);
    vec3 iris = mix(vec3(0.01), vec3(0.13, 0.2, 0.24), smoothstep(0.018, 0.03, 1 - own.z));
    vec3 eye = mix(iris, vec3(0.7, 0.66, 0.62), smoothstep(0.12, 0.14, 1 - own.z));
    vec3 colors[5] = vec3[](vec3(0), vec3(0.64, 0.4, 0.3), eye, vec3(0.5, 0.3, 0.25), vec3(0.06, 0.07, 0.09));
    albedo = vec4(colors[int(id)], 1);
})";

const char* cover =
    "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }";

const char* lightingFragments = R"(
layout(binding = 0) uniform sampler2D depths; layout(binding = 1) uniform sampler2D normalIds;
layout(binding = 2) uniform sampler2D albedos; layout(binding = 3) uniform sampler2D maps[3];
uniform mat4 toWorld, toShadow[3];
uniform vec4 place[3];  // w = 1: a position, 0: a direction
uniform vec3 axis[3], color[3], ambient;
uniform vec2 cone[3];   // cosines: dark, bright
out vec4 radiance;
float lit(sampler2D map, vec4 at) {
    vec3 p = at.xyz / at.w;
    if (any(notEqual(clamp(p, 0, 1), p))) return 1;  // beyond the map
    vec2 texel = p.xy * textureSize(map, 0) - 0.5, part = fract(texel);
    vec4 z;
    for (int i = 0; i < 4; ++i) z[i] = texelFetch(map, ivec2(texel) + ivec2(i & 1, i >> 1), 0).r;
    vec4 open = vec4(greaterThan(z, vec4(p.z - 0.002)));
    return mix(mix(open.x, open.y, part.x), mix(open.z, open.w, part.x), part.y);
}
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 normalId = texelFetch(normalIds, pixel, 0);
    radiance = vec4(0, 0, 0, 1);
    if (normalId.w == 1) return;  // skin: Pellucid's
    vec2 size = textureSize(depths, 0);
    vec2 clip = vec2(2, -2) * gl_FragCoord.xy / size + vec2(-1, 1);
    vec4 p = toWorld * vec4(clip, texelFetch(depths, pixel, 0).r, 1);
    p /= p.w;
    vec3 sum = ambient;
    for (int i = 0; i < 3; ++i) {
        vec3 way = place[i].xyz - place[i].w * p.xyz;
        float fall = place[i].w == 1 ? 1 / dot(way, way) : 1;
        float open = lit(maps[i], toShadow[i] * p);
        open *= smoothstep(cone[i].x, cone[i].y, dot(axis[i], -normalize(way)));
        sum += color[i] * fall * open * max(dot(normalize(way), normalId.xyz), 0);
    }
    radiance.rgb = texelFetch(albedos, pixel, 0).rgb * sum;
})";

const char* toneFragments = R"(
layout(binding = 0) uniform sampler2D radiance; out vec4 color;
void main() { color = vec4(1 - exp(-1.4 * texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb), 1); })";

}  // namespace

Renderer::Renderer(const Mesh& head, const std::vector<Float3>& normals, GLsizei width, GLsizei height) {
    depthProgram_ = gl::program(sceneVertices, depthFragments);
    gbufferProgram_ = gl::program(sceneVertices, gbufferFragments);
    lightingProgram_ = gl::program(cover, lightingFragments);
    toneProgram_ = gl::program(cover, toneFragments);

    std::vector<float> vertices;
    const auto add = [&](const Float3& p, const Float3& n, Id id) {
        vertices.insert(vertices.end(), {p[0], p[1], p[2], n[0], n[1], n[2], float(id)});
    };
    Float3 low = head.positions[0], high = low;
    for (const Float3& p : head.positions)
        for (size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
    for (size_t v = 0; v < head.positions.size(); ++v) {
        Float3 p = head.positions[v];
        for (size_t i = 0; i < 3; ++i) p[i] -= 0.5f * (low[i] + high[i]);
        add(p, normals[v], Id(head.ids[v]));
    }
    std::vector<uint32_t> indices = head.triangles();
    for (const uint32_t corner : {0, 1, 2, 2, 1, 3})
        indices.push_back(uint32_t(head.positions.size()) + corner);
    for (const float y : {-400.0f, 400.0f})
        for (const float x : {-600.0f, 600.0f}) add({x, y, -220}, {0, 0, 1}, Wall);
    count_ = GLsizei(indices.size());
    GLuint buffers[2];
    glCreateBuffers(2, buffers);
    glNamedBufferStorage(buffers[0], GLsizeiptr(vertices.size() * sizeof(float)), vertices.data(), 0);
    glNamedBufferStorage(buffers[1], GLsizeiptr(indices.size() * sizeof(uint32_t)), indices.data(), 0);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    const GLint sizes[] = {3, 3, 1};
    for (GLuint i = 0; i < 3; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, sizes[i], GL_FLOAT, GL_FALSE, 7 * sizeof(float),
                              reinterpret_cast<const void*>(3 * i * sizeof(float)));
    }

    depth = gl::texture(width, height, GL_R32F);
    normalId = gl::texture(width, height, GL_RGBA16F);
    albedo = gl::texture(width, height, GL_SRGB8_ALPHA8);
    radiance = gl::texture(width, height, GL_RGBA16F);
    gbuffer_ = gl::target({depth, normalId, albedo});
    lit_ = gl::target({radiance});
    shown_ = gl::target({gl::texture(width, height, GL_SRGB8_ALPHA8)});

    viewProjection_ =
        perspective(21, float(width) / float(height), 100, 2000) * lookAt({0, 28, 700}, {0, 28, 0});
    camera = pellucid::cameraFromViewProjection(viewProjection_, convention);
    ambient = pelAmbientDefaults();
    for (float& each : ambient.constant) each = 0.02f;
    // A key from the side, a fill from the other, and a spot from behind that shines through an ear.
    const Matrix views[] = {parallel(220, 100, 900) * lookAt({-420, 190, 160}, {0, 0, 0}),
                            parallel(220, 100, 900) * lookAt({380, 60, 330}, {0, 0, 0}),
                            perspective(45, 1, 100, 900) * lookAt({230, 120, -180}, {0, 0, 0})};
    const Float3 colors[] = {{1.6f, 1.45f, 1.25f}, {0.1f, 0.13f, 0.19f}, {5e4f, 4.4e4f, 3.8e4f}};
    for (size_t i = 0; i < numLights; ++i) {
        PelLight light = pellucid::lightFromViewProjection(views[i], convention);
        std::copy(colors[i].begin(), colors[i].end(), light.color);
        light.spotCosInner = 0.96f, light.spotCosOuter = 0.93f;
        lights.push_back({views[i], light, gl::texture(mapSize, mapSize, GL_R32F)});
        maps_.push_back(gl::target({lights[i].map}));
    }
}

void Renderer::drawScene(GLuint program, const Matrix& viewProjection) const {
    glUseProgram(program);
    glUniformMatrix4fv(glGetUniformLocation(program, "viewProjection"), 1, GL_FALSE, viewProjection.data());
    glUniform2f(glGetUniformLocation(program, "turn"), std::cos(angle_), std::sin(angle_));
    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

void Renderer::draw(float angle) {
    angle_ = angle;
    glClearColor(1, 1, 1, 1);
    for (size_t i = 0; i < numLights; ++i) {
        maps_[i].begin(true);
        drawScene(depthProgram_, lights[i].viewProjection);
    }
    glClearColor(0, 0, 0, 0);
    gbuffer_.begin(true);
    drawScene(gbufferProgram_, viewProjection_);

    lit_.begin(false);
    const auto uniform = [&](const std::string& name) {
        return glGetUniformLocation(lightingProgram_, name.c_str());
    };
    glUseProgram(lightingProgram_);
    glUniformMatrix4fv(uniform("toWorld"), 1, GL_TRUE, camera.inverseViewProjection);
    glUniform3fv(uniform("ambient"), 1, ambient.constant);
    const GLint units[numLights] = {3, 4, 5};
    glUniform1iv(uniform("maps"), numLights, units);
    for (size_t i = 0; i < numLights; ++i) {
        const PelLight& light = lights[i].light;
        const bool far = light.type == PEL_LIGHT_DIRECTIONAL;
        const float* at = far ? light.toLight : light.position;
        const std::string index = "[" + std::to_string(i) + "]";
        glUniformMatrix4fv(uniform("toShadow" + index), 1, GL_TRUE, light.worldToShadow);
        glUniform4f(uniform("place" + index), at[0], at[1], at[2], far ? 0.0f : 1.0f);
        glUniform3fv(uniform("color" + index), 1, light.color);
        glUniform3fv(uniform("axis" + index), 1, light.spotDirection);
        glUniform2f(uniform("cone" + index), far ? -3 : light.spotCosOuter, far ? -2 : light.spotCosInner);
    }
    gl::drawOver(lightingProgram_, {depth, normalId, albedo, lights[0].map, lights[1].map, lights[2].map});
}

std::vector<uint8_t> Renderer::picture(const gl::Texture& linear) const {
    shown_.begin(false);
    gl::drawOver(toneProgram_, {linear});
    std::vector<uint8_t> pixels(size_t(4) * radiance.width * radiance.height);
    glReadPixels(0, 0, radiance.width, radiance.height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    return pixels;
}
