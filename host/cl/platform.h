// Lists OpenCL devices, selects one, and knows the workarounds that each needs.
#pragma once
#include <string>
#include <vector>

#include "cl/handle.h"

namespace pel::cl {

// Every device of every platform, GPUs and CPUs, in the order in which OpenCL lists them.
std::vector<cl_device_id> allDevices();

// Describes a device; index is its position in allDevices(), or UINT32_MAX.
PelDeviceInfo describe(cl_device_id device, uint32_t index);

// The position in allDevices() that a selector means (see pelDeviceCreate).
uint32_t selectDevice(const char* selector);

bool isPocl(cl_device_id device);

// Whether the driver keeps compiled programs on disk itself, or they are not worth keeping.
bool keepsPrograms(cl_device_id device);

std::string platformName(cl_device_id device);
std::string platformVersion(cl_device_id device);
std::string infoString(cl_device_id device, cl_device_info what);

}  // namespace pel::cl
