// Where the library is linked with OpenCL's loader, which is there before anything runs.
#include "cl/opencl_loader.h"

namespace pel::cl {

std::string whyNoLoader() {
    return {};
}

}  // namespace pel::cl
