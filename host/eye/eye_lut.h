// Caustic tables (PEL_LUT_EYE). Beside kernels/eye/eye_lut.cl.
#pragma once
#include "lut/lut.h"

namespace pel {

// Throws PEL_ERROR_INVALID_ARGUMENT if the parts of the eye do not fit together or if its table would take
// too long; the message names fields of `structure`.
void checkEyeLutWork(const PelEyeLutDesc& desc, const char* structure);

// Checks `desc` first. Work is enqueued; if `interruptible`, long work is split, and the progress callback
// may cancel it between two parts.
Ref<Lut> integrateEyeLut(Ref<Device> device, const PelEyeLutDesc& desc, bool interruptible = false);

}  // namespace pel
