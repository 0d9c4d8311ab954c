// OpenCL that is found at run time. With PELLUCID_LOAD_OPENCL, opencl_loader.cpp stands in for libOpenCL: a
// program starts on machines without OpenCL, and reports what is missing when it creates a device.
#pragma once
#include <string>

namespace pel::cl {

// Why no library that lists devices was found, with what to do; "" if one was, or this build links one.
std::string whyNoLoader();

}  // namespace pel::cl
