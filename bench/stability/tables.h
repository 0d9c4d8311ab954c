// Tables of any profile on the device, and texel by texel from the oracle.
#pragma once
#include "reference/lut.h"

#include "stability.h"

namespace stability {

constexpr reference::Form trueForms[] = {reference::Form::arc, reference::Form::ring,
                                         reference::Form::halfRing, reference::Form::sphere};
constexpr const char* formNames[] = {"arc", "ring", "half-ring", "sphere"};

// Every texel, or a few of them (`all` false) where the oracle is slow.
inline std::vector<size_t> chosenTexels(size_t count, bool all) {
    std::vector<size_t> chosen;
    for (size_t i = all ? 0 : count / 7; i < count; i += all ? 1 : count / 5) chosen.push_back(i);
    return chosen;
}
inline std::vector<float> texelsOf(const Lut& lut, const std::vector<size_t>& chosen) {
    const std::vector<float> texels = lut.read<float>(PEL_LUT_FLOAT);
    std::vector<float> some;
    for (size_t i : chosen) some.insert(some.end(), &texels[3 * i], &texels[3 * i] + 3);
    return some;
}
template <class Texel>
std::vector<double> truthOf(const std::vector<size_t>& chosen, Texel texel) {
    std::vector<double> t(3 * chosen.size());
    inParallel(chosen.size(), [&](size_t k) {
        const reference::Rgb rgb = texel(chosen[k]);
        for (int c = 0; c < 3; ++c) t[3 * k + size_t(c)] = rgb[c];
    });
    return t;
}

class CurvatureTable : public Case {
  public:
    CurvatureTable(const PelCurvatureLutDesc& desc, reference::ProfilePtr profile, bool all,
                   Profile ours = {})
        : desc_(desc),
          profile_(std::move(profile)),
          ours_(std::move(ours)),
          texels_(chosenTexels(desc.width * desc.height, all)) {
        desc_.profile = ours_.get();
    }
    void move(Jitter& j) override {
        desc_.radiusMin = j(desc_.radiusMin), desc_.radiusMax = j(desc_.radiusMax);
        desc_.diffusionRadius = j(desc_.diffusionRadius);
    }
    std::vector<float> measured() override { return texelsOf(Lut(device(), desc_), texels_); }
    std::vector<double> truth() override {
        const auto scaled = reference::profileForRadius(profile_, desc_.diffusionRadius);
        const reference::CurvatureLutSpec spec{trueForms[desc_.form], int(desc_.width), int(desc_.height),
                                               desc_.radiusMin, desc_.radiusMax};
        return truthOf(texels_, [&](size_t i) {
            const int x = int(i % desc_.width), y = int(i / desc_.width);
            if (desc_.axis == PEL_AXIS_LINEAR) return reference::curvatureTexel(spec, *scaled, x, y);
            const double s = -1 + 2.0 * x / (desc_.width - 1), least = std::sqrt(1 / double(desc_.radiusMax)),
                         most = std::sqrt(1 / double(desc_.radiusMin)),
                         root = least + y / (desc_.height - 1.0) * (most - least);
            return reference::curvatureD(spec.form, *scaled, s * std::abs(s), 1 / (root * root));
        });
    }
    std::string where() override {
        return text("radii %.3g to %.3g mm, diffusion radius %.3g mm", desc_.radiusMin, desc_.radiusMax,
                    desc_.diffusionRadius) +
               ", " + formNames[desc_.form];
    }

  private:
    PelCurvatureLutDesc desc_;
    reference::ProfilePtr profile_;
    Profile ours_;
    std::vector<size_t> texels_;
};

class ShadowTable : public Case {
  public:
    // Widths and sharpening refer to the diffusion radius of desc, lengths of the profile to its own.
    ShadowTable(const PelShadowLutDesc& desc, reference::ProfilePtr profile, bool all = true,
                Profile ours = {})
        : desc_(desc),
          profile_(std::move(profile)),
          ours_(std::move(ours)),
          texels_(chosenTexels(desc.width * desc.height, all)) {
        desc_.profile = ours_.get();
    }
    void move(Jitter& j) override {
        desc_.widthMin = j(desc_.widthMin), desc_.widthMax = j(desc_.widthMax);
        desc_.diffusionRadius = j(desc_.diffusionRadius),
        desc_.sharpening = std::max(1.0f, j(desc_.sharpening));
    }
    std::vector<float> measured() override { return texelsOf(Lut(device(), desc_), texels_); }
    std::vector<double> truth() override {
        const reference::ShadowLutSpec spec{int(desc_.width), int(desc_.height),     desc_.widthMin,
                                            desc_.widthMax,   desc_.diffusionRadius, desc_.sharpening};
        return truthOf(texels_, [&](size_t i) {
            return reference::shadowTexel(spec, *profile_, int(i % desc_.width), int(i / desc_.width));
        });
    }
    std::string where() override {
        return text("widths %.3g to %.3g mm, diffusion radius %.3g mm, sharpening %.3g", desc_.widthMin,
                    desc_.widthMax, desc_.diffusionRadius, desc_.sharpening);
    }

  private:
    PelShadowLutDesc desc_;
    reference::ProfilePtr profile_;
    Profile ours_;
    std::vector<size_t> texels_;
};

}  // namespace stability
