// The cost of settings of PEL_SCATTERING_AUTO on a device, and the choice of one within
// PelShaderOptions.timeBudget.
#pragma once
#include "shading/shader_state.h"

namespace pel {

struct TunedSetting {
    PelScattering method;
    double targetError;         // share of white; 0 where the method has none
    double perPixel, perFrame;  // ns beyond plain lighting: per pixel of the materials, and of the frame
    double error;               // RMS against light, share of white
    bool halfRate = false;      // PelShaderOptions.halfRate, only for light
};

struct Tuning {
    std::vector<TunedSetting> settings;
    bool own = false;  // of this device's record
};

// The record of the device in the file that PELLUCID_TUNING names; the built-in guess where there is none.
// Throws PEL_ERROR_INVALID_ARGUMENT, with the file's name and the line, for a file that cannot be read.
Tuning tuningOf(const PelDeviceInfo& device);

// For PelShaderStats.
struct TakenSetting {
    double targetError = 0, milliseconds = 0, error = 0;
    bool own = false, halfRate = false;
};

// After chooseMethods(): sets the method of materials for which auto chose the screen, and the state's
// targetError, to those nearest to light within options.timeBudget. `pixels`: number of their pixels; if it
// is 0, it is counted in the material image and set. `warnings`: receives further ones, one a line.
TakenSetting keepToBudget(ShaderState& state, uint32_t methods, Device& device, uint64_t& pixels,
                          std::string& warnings);

}  // namespace pel
