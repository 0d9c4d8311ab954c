// PelProfile: diffusion profiles (section 1 of the mathematics) in double precision.
#pragma once
#include <memory>
#include <span>

#include "core/object.h"
#include "core/three.h"
#include "fields/captured_frame.h"

namespace pel {

constexpr double pi = std::numbers::pi;

using Rgb = Three;
inline constexpr const char* channelNames[] = {"red", "green", "blue"};

// weight * exp(-d^2 / 2 variance) / (2 pi variance) as energy per area, and with the same weight
// exp(-s^2 / 2 variance) / sqrt(2 pi variance) as line spread.
struct GaussianTerm {
    double variance;  // length^2; mm^2 for skin
    Rgb weight;
};

// The implementation of a kind of profile; lengths in the profile's unit.
class ProfileShape {
  public:
    virtual ~ProfileShape() = default;
    virtual Rgb radial(double distance) const = 0;      // energy per area, > 0
    virtual Rgb lineSpread(double distance) const = 0;  // energy per length
    virtual Rgb width() const = 0;                      // standard deviation of the line spread, length
    // The sum of Gaussians that represents the profile on the device, variances rising. Exact for skin and
    // gaussians, within 1e-6 for burley and dipole, empty for tables.
    virtual std::vector<GaussianTerm> gaussians() const { return {}; }
    // Distances where the slope of a tabulated radial profile changes, length, rising; empty for other kinds.
    virtual std::vector<double> knots() const { return {}; }
    virtual bool singular() const { return false; }  // the radial profile grows like 1/d
    // The share of R beyond a distance; > 0.
    virtual Rgb transmission(double distance) const = 0;
    virtual Rgb meanFreePath() const { return {}; }  // length; 0: unknown
    // The same of the medium that reflects as much as the profile's, with isotropic scattering.
    virtual Rgb mediumPath() const { return meanFreePath(); }
};

// The mean free path over Burley's length of the medium with s = sqrt(1 - its albedo) (docs/mathematics.md,
// section 14).
double mediumPathOver(double s);

class Profile final : public Object {
  public:
    static constexpr Kind kind = Kind::profile;

    static Ref<Profile> skin();
    static Ref<Profile> gaussians(const PelGaussian* gaussians, uint32_t count);
    static Ref<Profile> burley(const float* meanFreePath, const float* albedo, PelBurleyFit fit);
    static Ref<Profile> burleyDistance(const float* distance);
    static Ref<Profile> dipole(const float* absorption, const float* reducedScattering, float eta);
    static Ref<Profile> table(const float* distances, const float* values, uint32_t count);

    const ProfileShape& shape() const { return *shape_; }
    double radius() const { return radius_; }
    const std::vector<GaussianTerm>& terms() const { return terms_; }
    PelProfileInfo info() const;
    std::string name() const {
        std::lock_guard lock(nameMutex_);
        return name_;
    }
    void setName(const char* name);
    void setSource(const char* source) { source_ = source; }  // static storage; before the profile is used
    // The composition of skin of pelProfileCreateSkinLayers; NULL for other profiles.
    const PelSkin* pigments() const { return pigments_ ? &*pigments_ : nullptr; }
    void setPigments(const PelSkin& skin) { pigments_ = skin; }  // before the profile is used
    ProfileRecipe recipe() const;
    // Distance within which 99.9 % of the light of each channel leaves.
    double reach() const;

    // Without a radius, that of the channel that scatters widest.
    Profile(PelProfileKind profileKind, std::unique_ptr<ProfileShape> shape,
            std::optional<double> radius = {});

  private:
    ~Profile() override = default;
    PelProfileKind profileKind_;
    double radius_;  // length
    std::unique_ptr<ProfileShape> shape_;
    std::vector<GaussianTerm> terms_;
    mutable std::atomic<double> reach_{0};  // 0: not yet computed
    mutable std::mutex nameMutex_;          // guards the name only, which may change
    std::string name_;
    const char* source_ = "";
    std::optional<PelSkin> pigments_;
    ProfileRecipe recipe_;  // the numbers that it was created from
};

// Sums of Gaussians, in any order and scale. Weights are scaled to a sum of 1 per channel.
class GaussianShape : public ProfileShape {
  public:
    explicit GaussianShape(std::vector<GaussianTerm> terms);
    Rgb radial(double distance) const override;
    Rgb lineSpread(double distance) const override;
    Rgb width() const override;
    Rgb transmission(double distance) const override;
    std::vector<GaussianTerm> gaussians() const override { return terms_; }

  private:
    template <class F>
    Rgb sum(F&& f) const;
    std::vector<GaussianTerm> terms_;
};

// Lengths in mm. dipole: absorption and reduced scattering (1/mm) and eta; burley: mean free path and albedo.
struct LibraryProfile {
    const char* name;
    PelProfileKind kind;
    const char* source;
    float first[3], second[3], eta;
};

// "skin" first.
std::span<const LibraryProfile> profileLibrary();

// Throws PEL_ERROR_INVALID_ARGUMENT, with a list of the library, for an unknown name.
Ref<Profile> namedProfile(const char* name);

}  // namespace pel
