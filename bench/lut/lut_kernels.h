// Kernels of look-up tables, run by themselves: with other node counts than the library takes, and beside
// plain sampling (sampled_luts.cl) and the device's limits (device_limits.cl). For benchmarks.
#pragma once
#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/lut.h"
#include "shared/lut_integral.h"

namespace bench {

inline void check(cl_int code, const char* what) {
    if (code != CL_SUCCESS)
        throw std::runtime_error(std::string(what) + ": OpenCL error " + std::to_string(code));
}

// The first device, one in-order queue with profiling. Everything lives until the program ends.
class Runner {
  public:
    static constexpr int width = 16;  // PEL_WIDTH

    Runner() {
        cl_platform_id platform;
        check(clGetPlatformIDs(1, &platform, nullptr), "clGetPlatformIDs");
        check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device_, nullptr), "clGetDeviceIDs");
        cl_int code;
        context_ = clCreateContext(nullptr, 1, &device_, nullptr, nullptr, &code);
        check(code, "clCreateContext");
        queue_ = clCreateCommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE, &code);
        check(code, "clCreateCommandQueue");
    }
    cl_command_queue queue() const { return queue_; }

    cl_kernel kernel(const std::string& file, const std::string& name, const std::string& defines = "") {
        std::ifstream in(file);
        std::stringstream text;
        text << in.rdbuf();
        const std::string source = text.str();
        const char* pointer = source.c_str();
        cl_int code;
        cl_program program = clCreateProgramWithSource(context_, 1, &pointer, nullptr, &code);
        check(code, file.c_str());
        const std::string options =
            "-cl-std=CL1.2 -I " PELLUCID_SOURCE_DIR "/kernels -DPEL_WIDTH=" + std::to_string(width) + " " +
            defines;
        check(clBuildProgram(program, 1, &device_, options.c_str(), nullptr, nullptr), file.c_str());
        cl_kernel made = clCreateKernel(program, name.c_str(), &code);
        check(code, name.c_str());
        return made;
    }
    template <class T>
    cl_mem upload(const std::vector<T>& values) {
        cl_int code;
        cl_mem memory = clCreateBuffer(context_, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR,
                                       values.size() * sizeof(T), const_cast<T*>(values.data()), &code);
        check(code, "clCreateBuffer");
        return memory;
    }
    cl_mem memory(size_t bytes) {
        cl_int code;
        cl_mem made = clCreateBuffer(context_, CL_MEM_READ_WRITE, bytes, nullptr, &code);
        check(code, "clCreateBuffer");
        return made;
    }
    template <class... Arguments>
    void arguments(cl_kernel kernel, const Arguments&... values) {
        cl_uint i = 0;
        (check(clSetKernelArg(kernel, i++, sizeof values, &values), "clSetKernelArg"), ...);
    }
    // Device seconds.
    double run(cl_kernel kernel, size_t items, size_t rows, size_t group) {
        cl_event event;
        const size_t global[2] = {items, rows}, local[2] = {group, 1};
        check(clEnqueueNDRangeKernel(queue_, kernel, 2, nullptr, global, group ? local : nullptr, 0, nullptr,
                                     &event),
              "clEnqueueNDRangeKernel");
        check(clWaitForEvents(1, &event), "clWaitForEvents");
        cl_ulong start = 0, end = 0;
        clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_START, sizeof start, &start, nullptr);
        clGetEventProfilingInfo(event, CL_PROFILING_COMMAND_END, sizeof end, &end, nullptr);
        clReleaseEvent(event);
        return double(end - start) * 1e-9;
    }

  private:
    cl_device_id device_;
    cl_context context_;
    cl_command_queue queue_;
};

// A 512x512 table of form arc, skin, r = 1 to 100 mm, linear axis.
struct ArcTable {
    static constexpr int side = 512;
    CurvatureLutParams params{side,           side, 6, PEL_LUT_AXIS_LINEAR, 0.01f * 2.7f, 0.99f * 2.7f / side,
                              float(10 / 2.7)};
    std::vector<LutGaussian> gaussians{
        {0.080f / 2.7f, 0.233f, 0.455f, 0.649f}, {0.220f / 2.7f, 0.100f, 0.336f, 0.344f},
        {0.432f / 2.7f, 0.118f, 0.198f, 0},      {0.753f / 2.7f, 0.113f, 0.007f, 0.007f},
        {1.411f / 2.7f, 0.358f, 0.004f, 0},      {2.722f / 2.7f, 0.078f, 0, 0}};
    static double u(int x) { return -1 + (x + 0.5) * 2 / side; }
    static double radius(int y) { return 1 / (0.01 + (y + 0.5) * 0.99 / side); }  // mm
};

inline double nodeAngle(int j, int nodes) {
    return std::numbers::pi / 2 * std::pow(double(j) / nodes, 4);
}

inline std::vector<LutNode> meshOfNodes(int nodes) {
    std::vector<LutNode> mesh;
    for (int j = 0; j <= nodes; ++j) {
        const double angle = nodeAngle(j, nodes), s = std::sin(angle / 2);
        mesh.push_back({float(angle), float(std::sin(angle)), float(std::cos(angle)), float(2 * s * s)});
    }
    return mesh;
}

inline std::vector<LutColumn> columnsOf(int nodes) {
    std::vector<LutColumn> columns;
    for (int x = 0; x < ArcTable::side / 2; ++x) {
        const double elevation = -ArcTable::u(x), angle = std::asin(elevation);
        int j = nodes - 1;
        while (j > 0 && nodeAngle(j, nodes) > angle) --j;
        const double step = nodeAngle(j + 1, nodes) - nodeAngle(j, nodes),
                     t = (angle - nodeAngle(j, nodes)) / step;
        columns.push_back({float((1 + 2 * t) * (1 - t) * (1 - t)), float(-step * t * (1 - t) * (1 - t)),
                           float(t * t * (3 - 2 * t)), float(step * t * t * (1 - t)), float(elevation), j});
    }
    return columns;
}

}  // namespace bench
