// Lists and selects OpenCL devices, and names the workarounds that each needs.
#pragma once
#include <cstring>
#include <vector>

#include "cl/handle.h"

namespace pel::cl {

// Every device of every platform, GPUs and CPUs, in the order in which OpenCL lists them.
std::vector<cl_device_id> allDevices();

// Describes a device; index is its position in allDevices(), or UINT32_MAX.
PelDeviceInfo describe(cl_device_id device, uint32_t index);

// The position in allDevices() that a selector means (see pelDeviceCreate).
uint32_t selectDevice(const char* selector);

// The string that query(size, destination, needed size) returns.
template <class Query>
std::string queryString(const char* function, const Query& query) {
    size_t size = 0;
    check(query(0, nullptr, &size), function);
    std::string value(size, '\0');
    check(query(size, value.data(), nullptr), function);
    value.resize(std::strlen(value.c_str()));  // without the NUL
    return value;
}

bool isPocl(cl_device_id device);

// Whether the driver keeps compiled programs on disk itself, or they are not worth keeping.
bool keepsPrograms(cl_device_id device);

std::string platformName(cl_device_id device);
std::string platformVersion(cl_device_id device);
std::string infoString(cl_device_id device, cl_device_info what);

}  // namespace pel::cl
