// Scalar types for structures that host and device share: 4 bytes each, so that both lay them out alike.
#pragma once
#ifdef __OPENCL_VERSION__
typedef uint PelUint32;
#else
#include <cstdint>
typedef uint32_t PelUint32;
#endif
