// The same pass as a straight OpenCL port: one work-item is one pixel, every term of every pixel. In good faith for a CPU:
// look-ups in buffers (through images and samplers PoCL takes five times longer), products instead of pow.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <stdexcept>
#include <string>

#include "baseline_shade.h"

namespace baseline {
namespace {

const char* source = R"(
typedef struct Settings {
    float toLight[3], light[3], camera[3], ambient[9][3], worldToShadow[16], depthRange, rowsCurvature[2], rowsShadow[2];
    float penumbraPerCosine, sharpening, deepScatter[3], deepScatterRadius, normalOffset, filterRadius;
    int taps;
    float specular, roughness, f0;
} Settings;

float sat(float x) { return clamp(x, 0.0f, 1.0f); }

// Bilinear between texel centres, clamped at the border.
float3 look(__global const float4* texels, int2 size, float2 uv) {
    const float2 last = convert_float2(size - 1), at = clamp(uv * convert_float2(size) - 0.5f, (float2)(0.0f), last);
    const int2 i = convert_int2(at), j = min(i + 1, size - 1);
    const float2 f = at - convert_float2(i);
    return mix(mix(texels[i.y * size.x + i.x], texels[i.y * size.x + j.x], f.x),
               mix(texels[j.y * size.x + i.x], texels[j.y * size.x + j.x], f.x), f.y).xyz;
}

float depthAt(__global const float* map, int size, float2 uv) {
    const float2 at = clamp(uv * (float)size - 0.5f, (float2)(0.0f), (float2)((float)(size - 1)));
    const int2 i = convert_int2(at), j = min(i + 1, (int2)(size - 1));
    const float2 f = at - convert_float2(i);
    return mix(mix(map[i.y * size + i.x], map[i.y * size + j.x], f.x), mix(map[j.y * size + i.x], map[j.y * size + j.x], f.x), f.y);
}

float irradiance(__constant Settings* s, float3 n, int c) {
    const float basis[9] = {1, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3 * n.z * n.z - 1, n.x * n.z, n.x * n.x - n.y * n.y};
    float sum = 0;
    for (int i = 0; i < 9; ++i) sum += s->ambient[i][c] * basis[i];
    return max(sum, 0.0f);
}

__kernel void shade(int width, int height, __constant Settings* s, __constant float* disk, __global const uchar* id,
                    __global const float* position, __global const float* geometric, __global const float* shading,
                    __global const float* blurred, __global const float* curvature, __global const float* albedo,
                    __global const float* wide, __global const float4* lutCurvature, int2 sizeCurvature,
                    __global const float4* lutShadow, int2 sizeShadow, __global const float* map, int mapSize,
                    __global float* out) {
    const int x = get_global_id(0), y = get_global_id(1);
    if (x >= width || y >= height) return;
    const int i = y * width + x;
    if (!id[i]) return;
    const float3 l = vload3(0, s->toLight), ng = vload3(i, geometric), n = vload3(i, shading), nb = vload3(i, blurred);
    const float3 p = vload3(i, position), light = vload3(0, s->light);
    const float bl = dot(nb, l), nl = dot(n, l), w = wide[i];
    const float3 delta = look(lutCurvature, sizeCurvature, (float2)(0.5f * bl + 0.5f, s->rowsCurvature[0] * curvature[i] +
                              s->rowsCurvature[1])) - max(bl, 0.0f);
    const float away = sat(1 - bl) * sat(1 - bl);
    const float3 cosines = (float3)(sat(bl), sat(dot(l, normalize(mix(n, nb, 0.3f + 0.7f * away)))),
                                    sat(dot(l, normalize(mix(n, nb, away)))));
    const float3 direct = clamp(delta + cosines, 0.0f, 1.0f);
    const float3 shadow = look(lutShadow, sizeShadow, (float2)(w, s->rowsShadow[0] * sat(dot(ng, l)) *
                               s->penumbraPerCosine + s->rowsShadow[1]));
    float3 diffuse = (float3)(irradiance(s, nb, 0), irradiance(s, normalize(mix(n, nb, 0.3f)), 1), irradiance(s, n, 2));
    diffuse += light * direct * shadow;
    if (s->taps) {
        const float3 q = p - s->normalOffset * ng;
        float4 h;
        h.x = dot(vload4(0, s->worldToShadow), (float4)(q, 1));
        h.y = dot(vload4(1, s->worldToShadow), (float4)(q, 1));
        h.z = dot(vload4(2, s->worldToShadow), (float4)(q, 1));
        h.w = dot(vload4(3, s->worldToShadow), (float4)(q, 1));
        h /= h.w;
        float sum = 0;
        for (int k = 0; k < s->taps; ++k)
            sum += max((h.z - depthAt(map, mapSize, h.xy + s->filterRadius * vload2(k, disk))) * s->depthRange, 0.0f);
        const float t = sum / s->taps;
        diffuse += light * vload3(0, s->deepScatter) * exp(-t * t / (2 * s->deepScatterRadius * s->deepScatterRadius)) *
                   sat(0.3f - bl);
    }
    const float3 v = normalize(vload3(0, s->camera) - p), h = l + v, unit = normalize(h);
    const float nh = dot(n, unit), nh2 = nh * nh, m2 = s->roughness * s->roughness;
    const float lobe = nh > 0 ? exp((nh2 - 1) / (nh2 * m2)) / (m2 * nh2 * nh2) : 0.0f;
    const float base = 1 - dot(v, unit), base2 = base * base, fresnel = s->f0 + (1 - s->f0) * base2 * base2 * base;
    const float specular = s->specular * max(nl, 0.0f) * max(lobe * fresnel / dot(h, h), 0.0f) *
                           smoothstep(0.0f, 1.0f, w * s->sharpening + 0.5f * (1 - s->sharpening));
    vstore3(vload3(i, albedo) * diffuse + specular * light, i, out);
}
)";

void check(cl_int code) {
    if (code != CL_SUCCESS) throw std::runtime_error("OpenCL error " + std::to_string(code));
}

// ShadeSettings up to its taps' table, as the kernel's Settings lays them out.
constexpr size_t settingsBytes = offsetof(ShadeSettings, f0) + sizeof(float);

}  // namespace

struct ShadePort::State {
    cl_context context;
    cl_command_queue queue;
    cl_program program = nullptr;
    cl_kernel kernel = nullptr;
    std::vector<cl_mem> memory;
    size_t width, height, outBytes;

    cl_mem buffer(size_t bytes, const void* data) {
        cl_int code;
        memory.push_back(clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, bytes,
                                        const_cast<void*>(data), &code));
        check(code);
        return memory.back();
    }
    cl_mem table(const ShadeTable& t) {
        std::vector<float> four(size_t(t.width) * t.height * 4);
        for (size_t i = 0; i < four.size() / 4; ++i)
            for (int c = 0; c < 3; ++c) four[4 * i + c] = t.texels[3 * i + c];
        return buffer(four.size() * sizeof(float), four.data());
    }
    ~State() {
        if (kernel) clReleaseKernel(kernel);
        if (program) clReleaseProgram(program);
        for (cl_mem m : memory) clReleaseMemObject(m);
    }
};

ShadePort::ShadePort(void* context, void* device, void* queue, const ShadeFrame& f, const ShadeSettings& s,
                     const ShadeTable& curvature, const ShadeTable& shadow)
    : state_(std::make_unique<State>()) {
    State& st = *state_;
    st.context = cl_context(context);
    st.queue = cl_command_queue(queue);
    st.width = size_t(f.width);
    st.height = size_t(f.height);
    cl_int code;
    st.program = clCreateProgramWithSource(st.context, 1, &source, nullptr, &code);
    check(code);
    auto id = cl_device_id(device);
    check(clBuildProgram(st.program, 1, &id, "-cl-std=CL1.2", nullptr, nullptr));
    st.kernel = clCreateKernel(st.program, "shade", &code);
    check(code);
    cl_uint next = 0;
    const auto number = [&](cl_int value) { check(clSetKernelArg(st.kernel, next++, sizeof value, &value)); };
    const auto memory = [&](cl_mem m) { check(clSetKernelArg(st.kernel, next++, sizeof m, &m)); };
    number(f.width);
    number(f.height);
    memory(st.buffer(settingsBytes, &s));
    const float none[2] = {0, 0};
    memory(s.disk.empty() ? st.buffer(sizeof none, none) : st.buffer(s.disk.size() * 4, s.disk.data()));
    memory(st.buffer(f.id.size(), f.id.data()));
    for (const auto* image :
         {&f.position, &f.geometric, &f.shading, &f.blurred, &f.curvature, &f.albedo, &f.wide})
        memory(st.buffer(image->size() * 4, image->data()));
    for (const ShadeTable* table : {&curvature, &shadow}) {
        memory(st.table(*table));
        const cl_int2 size = {{table->width, table->height}};
        check(clSetKernelArg(st.kernel, next++, sizeof size, &size));
    }
    memory(st.buffer(f.map.size() * sizeof(float), f.map.data()));
    number(f.mapSize);
    const std::vector<float> zero(f.position.size());
    st.outBytes = zero.size() * 4;
    memory(st.buffer(st.outBytes, zero.data()));
}

ShadePort::~ShadePort() = default;

void ShadePort::run() {
    const size_t group[2] = {16, 4};
    const size_t global[2] = {(state_->width + 15) / 16 * 16, (state_->height + 3) / 4 * 4};
    check(clEnqueueNDRangeKernel(state_->queue, state_->kernel, 2, nullptr, global, group, 0, nullptr, nullptr));
    check(clFinish(state_->queue));
}

std::vector<float> ShadePort::result() {
    std::vector<float> out(state_->outBytes / 4);
    check(clEnqueueReadBuffer(state_->queue, state_->memory.back(), CL_TRUE, 0, state_->outBytes, out.data(),
                              0, nullptr, nullptr));
    return out;
}

}  // namespace baseline
