// The limits of a device: copies and multiply-adds written only to measure them.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <chrono>
#include <stdexcept>

#include "case.h"

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
// The sum of all lanes, with another start in each work-item: compilers leave out unused results, and compute
// equal ones once.
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

// Kernels, two buffers, and the fastest way found to use them.
class Limits {
  public:
    Limits(const Device& device, size_t bytes) : device_(device), bytes_(bytes) {
        void *context = nullptr, *id = nullptr, *queue = nullptr;
        pellucid::check(pelDeviceGetCl(device.get(), &context, &id, &queue));
        queue_ = static_cast<cl_command_queue>(queue);
        cl_int code = CL_SUCCESS;
        program_ = clCreateProgramWithSource(static_cast<cl_context>(context), 1,
                                             const_cast<const char**>(&source_), nullptr, &code);
        check(code, "clCreateProgramWithSource");
        const auto device1 = static_cast<cl_device_id>(id);
        check(clBuildProgram(program_, 1, &device1, "-cl-std=CL1.2", nullptr, nullptr), "clBuildProgram");
        a_ = Buffer(device, bytes);
        b_ = Buffer(device, bytes);
    }
    ~Limits() {
        if (program_) clReleaseProgram(program_);
    }
    Limits(const Limits&) = delete;

    // lanes 0: the driver's own copy.
    void copy(int lanes) {
        if (lanes == 0) {
            check(clEnqueueCopyBuffer(queue_, mem(a_), mem(b_), 0, 0, bytes_, 0, nullptr, nullptr),
                  "clEnqueueCopyBuffer");
            check(clFinish(queue_), "clFinish");
            return;
        }
        Kernel kernel(program_, lanes == 4 ? "copy4" : "copy16");
        kernel.set(0, mem(a_));
        kernel.set(1, mem(b_));
        kernel.run(queue_, bytes_ / (sizeof(float) * size_t(lanes)));
    }
    double multiplyAdd(int lanes, size_t items) {
        Kernel kernel(program_, lanes == 1 ? "chains1" : lanes == 8 ? "chains8" : "chains16");
        const float a = 0.999f, b = 1e-3f;
        kernel.set(0, mem(b_));
        kernel.set(1, a);
        kernel.set(2, b);
        kernel.run(queue_, items);
        return double(items) * lanes * operationsPerLane;
    }

  private:
    struct Kernel {
        cl_kernel kernel;
        Kernel(cl_program program, const char* name) {
            cl_int code = CL_SUCCESS;
            kernel = clCreateKernel(program, name, &code);
            check(code, "clCreateKernel");
        }
        ~Kernel() { clReleaseKernel(kernel); }
        Kernel(const Kernel&) = delete;
        template <class T>
        void set(cl_uint index, const T& value) const {
            check(clSetKernelArg(kernel, index, sizeof value, &value), "clSetKernelArg");
        }
        void run(cl_command_queue queue, size_t items) const {
            const size_t local = 64;
            check(clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &items, &local, 0, nullptr, nullptr),
                  "clEnqueueNDRangeKernel");
            check(clFinish(queue), "clFinish");
        }
    };
    static cl_mem mem(const Buffer& buffer) {
        void* mem = nullptr;
        pellucid::check(pelBufferGetCl(buffer.get(), &mem));
        return static_cast<cl_mem>(mem);
    }

    Device device_;
    size_t bytes_;
    const char* source_ = source;
    cl_command_queue queue_ = nullptr;
    cl_program program_ = nullptr;
    Buffer a_, b_;
};

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::vector<Factory> deviceCases(const Device& device, Size size) {
    const auto limits = std::make_shared<std::shared_ptr<Limits>>();
    const size_t bytes = size_t(size.quick ? 32 : 128) << 20;
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
                const double start = seconds();
                l->copy(lanes);
                if (repeat > 0 && seconds() - start < least) least = seconds() - start, best = lanes;
            }
        Case c;
        c.what = std::to_string(bytes >> 20) + " MiB, " +
                 (best ? "float" + std::to_string(best) : "the driver's own");
        c.items = c.bytes = 2 * double(bytes);
        c.unit = "bytes";
        c.run = [=] { l->copy(best); };
        return c;
    };
    const auto arithmetic = [=] {
        const auto l = open();
        int best = 1;
        double most = 0;
        size_t items = 1024;
        for (const int lanes : {1, 8, 16}) {
            l->multiplyAdd(lanes, items);
            for (int repeat = 0; repeat < 3; ++repeat) {
                const double start = seconds(), rate = l->multiplyAdd(lanes, items) / (seconds() - start);
                if (rate > most) most = rate, best = lanes;
            }
        }
        // About 10 ms a run.
        while (items < (1u << 20) && double(items) * best * operationsPerLane < 0.01 * most) items *= 2;
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
