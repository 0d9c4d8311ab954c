// For builds that link OpenCL's loader, which is then loaded with the library.
#include "cl/opencl_loader.h"

namespace pel::cl {

std::string whyNoLoader() {
    return {};
}

}  // namespace pel::cl
