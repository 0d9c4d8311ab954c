// What settings of PEL_SCATTERING_AUTO cost on a device, and which of them keeps to
// PelShaderOptions.timeBudget.
#pragma once
#include "core/device.h"
#include "shading/shader_state.h"

namespace pel {

struct TunedSetting {
    PelScattering method;
    double targetError;         // share of white; 0 where the method has none
    double perPixel, perFrame;  // ns beyond plain lighting: per pixel of the materials, and of the frame
    double error;               // RMS against light, share of white
    bool halfRate = false;      // PelShaderOptions.halfRate, of light alone
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

// After chooseMethods(): where materials came to scatter on the screen, they get the method and the state the
// targetError that are nearest to light within options.timeBudget. `pixels`: of those materials; counted in
// the material image, and set, if it is 0. `warnings`: more of them, one a line.
TakenSetting keepToBudget(ShaderState& state, uint32_t methods, Device& device, uint64_t& pixels,
                          std::string& warnings);

}  // namespace pel
