// OpenCL that is found at run time. opencl_loader.cpp stands in the place of libOpenCL where PELLUCID_LOAD_OPENCL is on: a program
// then starts on machines without OpenCL, and says what is missing once it asks for a device.
#pragma once
#include <string>

namespace pel::cl {

// Why no library was found that lists OpenCL's devices, with what to do; "" if one was found, or if this build is linked with one.
std::string whyNoLoader();

}  // namespace pel::cl
