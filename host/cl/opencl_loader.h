// OpenCL that is found at run time. With PELLUCID_LOAD_OPENCL, opencl_loader.cpp stands in for libOpenCL: a
// program starts on machines without OpenCL, and reports what is missing when it creates a device.
#pragma once
#include <string>

namespace pel::cl {

// Why no library was found that lists OpenCL's devices, with what to do; "" if one was found, or if this
// build links with one.
std::string whyNoLoader();

}  // namespace pel::cl
