// Electrical power of a device while something runs on it, where a counter of energy can be read.
#pragma once
#include <functional>
#include <optional>
#include <pellucid/pellucid.hpp>

#include "timing.h"

namespace pellucid::bench {

using Clock = std::function<double()>;        // milliseconds
using EnergyMeter = std::function<double()>;  // joules since some moment; no function: it cannot be read

// Of all processor packages, from the counters of Linux (powercap) in `folder`; not of memory.
EnergyMeter packageEnergy(const std::string& folder);

// Of an NVIDIA GPU by NVML, loaded as `library`; of the only one if none is at `busId` ("00000000:C1:00.0").
EnergyMeter nvidiaEnergy(const std::string& busId, const std::string& library = "libnvidia-ml.so.1",
                         const Clock& now = milliseconds);

// `powercap`: the folder of packageEnergy(), which stands for a CPU.
EnergyMeter energyOf(const Device& device, const std::string& powercap);

// Watts while `work` runs again and again, for 0.4 s or more: counters move in steps of up to 0.1 s. Nothing
// where the meter does not move, or a run takes more than 4 s.
std::optional<double> meanWatts(const EnergyMeter& joules, const std::function<void()>& work,
                                const Clock& now = milliseconds);

}  // namespace pellucid::bench
