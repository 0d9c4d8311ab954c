// The defaults of a material, and the tables that follow from its profile.
#pragma once
#include "shading/shader_state.h"

namespace pel {

// The tables of profiles, each made when it is first wanted and kept as long as a material has its profile:
// setting the same material again costs nothing.
class ProfileTables {
  public:
    struct Tables {
        Ref<Profile> profile;
        float filterWidth;           // mm, of the wide shadow
        Ref<Lut> transmission;       // one row over the root of thickness, mm
        Ref<Lut> curvature, shadow;  // once withTables has made them
    };
    Tables& get(const Ref<Device>& device, Profile& profile, float filterWidth);
    // Releases tables that no material has.
    void keepOnly(const std::map<uint32_t, ShaderMaterial>& materials);

  private:
    std::vector<Tables> all_;
};

// The mean free path of the profile's medium in the profile's unit, per channel; 0: unknown.
double meanFreePath(const Profile& profile, int channel);
// sqrt(1 - albedo of a single scattering), 0.02 to 0.95, of the medium with a mean free path of `lengths`
// times Burley's length (docs/mathematics.md, section 14).
double mediumAbsorption(double lengths);
double mediumAbsorption(const Profile& profile, int channel);
// The slope and the saturation of the gain of a curved body (kernels/lib/shading/curvature_gain.clh).
void describeGain(const Profile& profile, float (&slope)[3], float (&saturation)[3]);
constexpr double windowOfPath = 2.75;  // length over which curvature is measured, in mean free paths

// The thickness at the end of the transmission's row, mm, where no light comes through.
double transmissionReach(const Profile& profile);

// Fills in material.params and its tables from material.given (see PelMaterial). Throws
// PEL_ERROR_INVALID_ARGUMENT for what the profile cannot provide.
void resolveMaterial(ShaderMaterial& material, const Ref<Device>& device, const PelShaderOptions& options,
                     ProfileTables& tables);

// Sets the tables of their profiles for materials that are shaded by tables and have none.
void withTables(ShaderState& state, const Ref<Device>& device, ProfileTables& tables);

// Sentences, one a line, about settings that are unlikely or have no effect (pelShaderGetWarnings). `given`:
// as the caller set it, `state`: with the methods that auto chose.
std::string warningsOf(const ShaderState& given, const ShaderState& state, uint32_t features);

}  // namespace pel
