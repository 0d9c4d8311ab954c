#include "eye/eye_lut.h"

#include "lut/lut_check.h"

namespace pel {

Ref<Lut> integrateEyeLut(Ref<Device>, const PelEyeLutDesc& desc) {
    checkEyeDesc(desc);
    fail(PEL_ERROR_UNSUPPORTED, "this build of the library does not integrate tables of eyes yet");
}

}  // namespace pel
