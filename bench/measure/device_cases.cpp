// The limits of a device: copies and multiply-adds written only to measure them.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "measure.h"
#include "timing.h"

namespace pellucid::bench {
namespace {

constexpr const char* source = R"(
#define COPY(T, name) \
    __kernel void name(__global const T* a, __global T* b) { b[get_global_id(0)] = a[get_global_id(0)]; }
COPY(float4, copy4)
COPY(float16, copy16)
#define STEP(x) x = mad(x, a, b);
#define ALL STEP(c0) STEP(c1) STEP(c2) STEP(c3) STEP(c4) STEP(c5) STEP(c6) STEP(c7)
#define CHAINS(T, name)                                                        \
    __kernel void name(__global float* out, float a, float b) {                \
        T c0 = (T)(a + 1e-3f * get_global_id(0)), c1 = c0 + 1, c2 = c0 + 2;    \
        T c3 = c0 + 3, c4 = c0 + 4, c5 = c0 + 5, c6 = c0 + 6, c7 = c0 + 7;     \
        for (int i = 0; i < 256; ++i) { ALL ALL }                              \
        T s = c0 + c1 + c2 + c3 + c4 + c5 + c6 + c7;                           \
        out[get_global_id(0)] = SUM_##T(s);                                    \
    }
#define SUM_float(s) s
// The sum of all lanes, with another start in each work-item: compilers drop unused and equal results.
#define SUM_float8(s) dot(s.lo + s.hi, (float4)(1.0f))
#define SUM_float16(s) dot(s.lo.lo + s.lo.hi + s.hi.lo + s.hi.hi, (float4)(1.0f))
CHAINS(float, chains1)
CHAINS(float8, chains8)
CHAINS(float16, chains16)
)";
constexpr double operationsPerLane = 256 * 2 * 8 * 2;

void check(cl_int code, const char* call) {
    if (code != CL_SUCCESS) throw std::runtime_error(std::string(call) + " gave " + std::to_string(code));
}

// A program and two buffers.
class Limits {
  public:
    Limits(const Device& device, size_t bytes)
        : device_(device), bytes_(bytes), a_(device, bytes), b_(device, bytes) {
        void *context = nullptr, *id = nullptr, *queue = nullptr;
        pellucid::check(pelDeviceGetCl(device.get(), &context, &id, &queue));
        queue_ = static_cast<cl_command_queue>(queue);
        const auto device1 = static_cast<cl_device_id>(id);
        const char* text = source;
        cl_int code = CL_SUCCESS;
        const cl_program program =
            clCreateProgramWithSource(static_cast<cl_context>(context), 1, &text, nullptr, &code);
        check(code, "clCreateProgramWithSource");
        program_.reset(program, clReleaseProgram);
        check(clBuildProgram(program, 1, &device1, "-cl-std=CL1.2", nullptr, nullptr), "clBuildProgram");
    }

    // lanes 0: the driver's own copy.
    void copy(int lanes) {
        const cl_mem from = mem(a_), to = mem(b_);
        if (lanes)
            return run("copy" + std::to_string(lanes), bytes_ / (sizeof(float) * size_t(lanes)), from, to);
        check(clEnqueueCopyBuffer(queue_, from, to, 0, 0, bytes_, 0, nullptr, nullptr),
              "clEnqueueCopyBuffer");
        check(clFinish(queue_), "clFinish");
    }
    double multiplyAdd(int lanes, size_t items) {
        run("chains" + std::to_string(lanes), items, mem(b_), 0.999f, 1e-3f);
        return double(items) * lanes * operationsPerLane;
    }

  private:
    template <class... Arguments>
    void run(const std::string& name, size_t items, const Arguments&... arguments) {
        cl_int code = CL_SUCCESS;
        const cl_kernel kernel = clCreateKernel(program_.get(), name.c_str(), &code);
        check(code, "clCreateKernel");
        const std::shared_ptr<void> release(kernel,
                                            [](void* k) { clReleaseKernel(static_cast<cl_kernel>(k)); });
        cl_uint index = 0;
        (check(clSetKernelArg(kernel, index++, sizeof arguments, &arguments), "clSetKernelArg"), ...);
        const size_t local = 64;
        check(clEnqueueNDRangeKernel(queue_, kernel, 1, nullptr, &items, &local, 0, nullptr, nullptr),
              "clEnqueueNDRangeKernel");
        check(clFinish(queue_), "clFinish");
    }
    static cl_mem mem(const Buffer& buffer) {
        void* mem = nullptr;
        pellucid::check(pelBufferGetCl(buffer.get(), &mem));
        return static_cast<cl_mem>(mem);
    }

    Device device_;
    size_t bytes_;
    Buffer a_, b_;
    cl_command_queue queue_ = nullptr;
    std::shared_ptr<std::remove_pointer_t<cl_program>> program_;
};

}  // namespace

std::vector<Factory> deviceCases(const Device& device, bool quick) {
    const auto limits = std::make_shared<std::shared_ptr<Limits>>();
    const size_t bytes = size_t(quick ? 32 : 128) << 20;
    const auto open = [=] {
        if (!*limits) *limits = std::make_shared<Limits>(device, bytes);
        return *limits;
    };
    const auto copy = [=] {
        const auto l = open();
        int best = 0;
        double least = INFINITY;
        for (int repeat = 0; repeat < 3; ++repeat)
            for (const int lanes : {0, 4, 16}) {
                const double start = milliseconds();
                l->copy(lanes);
                if (repeat > 0 && milliseconds() - start < least)
                    least = milliseconds() - start, best = lanes;
            }
        return Case{.what = std::to_string(bytes >> 20) + " MiB, " +
                            (best ? "float" + std::to_string(best) : "the driver's own"),
                    .items = 2 * double(bytes),
                    .unit = "bytes",
                    .bytes = 2 * double(bytes),
                    .run = [=] { l->copy(best); }};
    };
    const auto arithmetic = [=] {
        const auto l = open();
        int best = 1;
        double most = 0;
        size_t items = 1024;
        for (const int lanes : {1, 8, 16}) {
            l->multiplyAdd(lanes, items);
            for (int repeat = 0; repeat < 3; ++repeat) {
                const double start = milliseconds(),
                             rate = l->multiplyAdd(lanes, items) / (milliseconds() - start);
                if (rate > most) most = rate, best = lanes;
            }
        }
        // About 10 ms a run.
        while (items < (1u << 20) && double(items) * best * operationsPerLane < 10 * most) items *= 2;
        Case c;
        c.what = "multiply-add, float" + (best > 1 ? std::to_string(best) : std::string()) + ", 8 chains";
        c.items = c.operations = l->multiplyAdd(best, items);
        c.unit = "operations";
        c.run = [=] { l->multiplyAdd(best, items); };
        return c;
    };
    return {{copyName, "device", copy}, {arithmeticName, "device", arithmetic}};
}

}  // namespace pellucid::bench
