// The caustic of a cornea (PEL_LUT_EYE). Beside kernels/eye/eye_lut.cl.
#pragma once
#include "lut/lut.h"

namespace pel {

// Throws PEL_ERROR_INVALID_ARGUMENT for a description outside what pellucid.h documents. Work is enqueued, not waited for.
Ref<Lut> integrateEyeLut(Ref<Device> device, const PelEyeLutDesc& desc);

}  // namespace pel
