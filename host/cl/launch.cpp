#include "cl/launch.h"

namespace pel::cl {

Launch::Launch(const Program& program, const char* kernel) : name_(kernel) {
    cl_int code = CL_SUCCESS;
    kernel_ = Kernel(clCreateKernel(program.get(), kernel, &code));
    if (code != CL_SUCCESS) check(code, text("clCreateKernel(", kernel, ")").c_str());
}

Launch& Launch::raw(const void* value, size_t bytes) {
    const cl_int code = clSetKernelArg(kernel_.get(), next_, bytes, value);
    if (code != CL_SUCCESS) check(code, text("clSetKernelArg(", name_, ", ", next_, ")").c_str());
    ++next_;
    return *this;
}

Event Launch::enqueue(cl_command_queue queue, const Range& range) {
    std::array<size_t, 3> global{};
    for (int d = 0; d < 3; ++d) {
        if (range.items[d] == 0) return {};
        global[d] = (range.items[d] + range.group[d] - 1) / range.group[d] * range.group[d];
    }
    cl_event event = nullptr;
    const cl_int code = clEnqueueNDRangeKernel(queue, kernel_.get(), 3, nullptr, global.data(),
                                               range.group.data(), 0, nullptr, &event);
    if (code != CL_SUCCESS) check(code, text("clEnqueueNDRangeKernel(", name_, ")").c_str());
    return Event(event);
}

}  // namespace pel::cl
