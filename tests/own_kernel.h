// Runs kernels of a test that include the library's functions, as a renderer's own kernels do.
#pragma once
#include <CL/cl.h>
#include "test.h"

// What the kernel `evaluate` of `source` writes to its last argument, `count` floats, by work-items that take
// `lanes` of them each. `arguments`: floats, which get a buffer, or numbers.
template <class... Arguments>
std::vector<float> runOwnKernel(const pellucid::Device& device, const std::string& source, int lanes,
                                size_t count, const Arguments&... arguments) {
    // Clang warns of vectors wider than the registers.
    const std::string whole =
        "#ifndef __NV_CL_C_VERSION\n#pragma clang diagnostic ignored \"-Wpsabi\"\n#endif\n" + source;
    const char* text = whole.c_str();
    void *context, *id, *queue;
    pellucid::check(pelDeviceGetCl(device.get(), &context, &id, &queue));
    cl_int code;
    cl_program program = clCreateProgramWithSource(cl_context(context), 1, &text, nullptr, &code);
    const auto cl = cl_device_id(id);
    const std::string options =
        "-cl-std=CL1.2 -I" PELLUCID_SOURCE_DIR "/kernels -DPEL_WIDTH=" + std::to_string(lanes);
    EXPECT_EQ(clBuildProgram(program, 1, &cl, options.c_str(), nullptr, nullptr), CL_SUCCESS);
    cl_kernel kernel = clCreateKernel(program, "evaluate", &code);
    std::vector<pellucid::Buffer> buffers;
    cl_uint number = 0;
    const auto value = [&](const auto& v) {
        EXPECT_EQ(clSetKernelArg(kernel, number++, sizeof v, &v), CL_SUCCESS);
    };
    const auto buffer = [&](pellucid::Buffer made) {
        void* memory = nullptr;
        pellucid::check(pelBufferGetCl(made.get(), &memory));
        value(memory);
        buffers.push_back(std::move(made));
    };
    const auto argument = [&](const auto& v) {
        if constexpr (std::is_arithmetic_v<std::decay_t<decltype(v)>>)
            value(v);
        else
            buffer(pellucid::Buffer(device, v));
    };
    (argument(arguments), ...);
    buffer(pellucid::Buffer(device, count * sizeof(float)));
    const size_t items = count / size_t(lanes);
    EXPECT_EQ(clEnqueueNDRangeKernel(cl_command_queue(queue), kernel, 1, nullptr, &items, nullptr, 0, nullptr,
                                     nullptr),
              CL_SUCCESS);
    EXPECT_EQ(clFinish(cl_command_queue(queue)), CL_SUCCESS);
    clReleaseKernel(kernel);
    clReleaseProgram(program);
    return buffers.back().readAll<float>();
}
