// Look-up tables, texel by texel: of skin, by form and axis, shadow and specular; of every kind of profile.
#include "io/choice_keys.h"
#include "measure/true_texels.h"

#include "stability.h"

namespace stability {
namespace {

using reference::Rgb;
using shade_test::vectorOf;

// A profile on the device and in the oracle, from the same floats.
struct Source {
    Profile ours;
    reference::ProfilePtr truth;
    std::string where;
};

Source gaussians(const Point& p) {
    Dice dice(1 + uint32_t(p[0] * 1000));
    const int count = 1 + int(p[1] * 7.999);
    const double widest = logBetween(p[2], 0.05, 50);
    std::vector<PelGaussian> ours;
    std::vector<reference::Gaussian> truth;
    for (int i = 0; i < count; ++i) {
        const PelGaussian g{float(widest * widest * logBetween(i ? dice.uniform() : 1, 1e-4, 1)),
                            {float(dice.uniform()), float(dice.uniform()), float(dice.uniform())}};
        ours.push_back(g);
        truth.push_back({g.variance, vectorOf(g.weight)});
    }
    return {Profile::gaussians(ours), reference::gaussiansProfile(truth),
            text("%.0f Gaussians, widest %.3g mm", count, widest)};
}

Source burley(const Point& p) {
    float path[3], albedo[3];
    for (int c = 0; c < 3; ++c) {
        path[c] = float(logBetween(p[2], 0.05, 20) * logBetween(p[1], 1, 1.0 / (1 + 2 * c)));
        albedo[c] = float(std::clamp(p[0] - 0.15 * c, 0.0, 1.0));
    }
    return {Profile::burley(path, albedo), reference::burleyProfile(vectorOf(path), vectorOf(albedo)),
            text("mean free path %.3g to %.3g mm, albedo %.3g", path[0], path[2], albedo[0])};
}

Source dipole(const Point& p) {
    float absorption[3], scattering[3];
    for (int c = 0; c < 3; ++c) {
        scattering[c] = float(logBetween(p[2], 0.05, 20) * (1 + 0.3 * c));
        absorption[c] = float(scattering[c] * logBetween(p[0], 1e-3, 3) * (1 + c));
    }
    const float eta = float(between(p[1], 1.05, 2));
    return {Profile::dipole(absorption, scattering, eta),
            reference::dipoleProfile(vectorOf(absorption), vectorOf(scattering), eta),
            text("absorption %.3g /mm, scattering %.3g /mm, eta %.3g", absorption[0], scattering[0], eta)};
}

Source measuredTable(const Point& p) {
    Dice dice(1 + uint32_t(p[0] * 1000));
    const int count = 2 + int(p[1] * 30);
    std::vector<float> distances, values;
    double at = p[2] < 0.5 ? 0 : dice.uniform();
    for (int i = 0; i < count; ++i, at += logBetween(dice.uniform(), 0.05, 1)) {
        distances.push_back(float(at));
        for (int c = 0; c < 3; ++c) values.push_back(float(dice.uniform() * std::exp(-at / (1 + c))));
    }
    std::vector<double> d(distances.begin(), distances.end());
    std::vector<Rgb> R;
    for (size_t i = 0; i < d.size(); ++i) R.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    return {Profile::table(distances, values), reference::tableProfile(d, R),
            text("%.0f distances up to %.3g mm", count, d.back())};
}

// Skin of the library's own.
Source skin() {
    return {{}, reference::skinProfile(), ""};
}

// Every texel, or a few of them (`all` false) where the oracle is slow.
template <class Desc>
Case tableCase(const Desc& given, const Source& source, bool all, const std::string& where,
               std::function<void(Desc&, Jitter&)> move) {
    const auto desc = std::make_shared<Desc>(given);
    desc->profile = source.ours.get();
    std::vector<size_t> chosen;
    const size_t count = given.width * given.height;
    for (size_t i = all ? 0 : count / 7; i < count; i += all ? 1 : count / 5) chosen.push_back(i);
    const auto measured = [=] {
        const std::vector<float> texels = Lut(device(), *desc).template read<float>(PEL_LUT_FLOAT);
        std::vector<float> some;
        for (size_t i : chosen) some.insert(some.end(), &texels[3 * i], &texels[3 * i] + 3);
        return some;
    };
    const auto truth = [=] {
        std::vector<double> t(3 * chosen.size());
        const bench::TexelAt at = bench::trueTexels(*desc, source.truth);
        inParallel(chosen.size(), [&](size_t k) {
            const Rgb rgb = at(int(chosen[k] % desc->width), int(chosen[k] / desc->width));
            for (int c = 0; c < 3; ++c) t[3 * k + size_t(c)] = rgb[c];
        });
        return t;
    };
    return {[=](Jitter& j) { move(*desc, j); }, measured, truth,
            (source.where.empty() ? "" : source.where + ": ") + where};
}

Case curvatureCase(const PelCurvatureLutDesc& desc, const Source& source, bool all) {
    return tableCase<PelCurvatureLutDesc>(desc, source, all,
                                          text("radii %.3g to %.3g mm, diffusion radius %.3g mm",
                                               desc.radiusMin, desc.radiusMax, desc.diffusionRadius) +
                                              ", " + std::string(io::curvatureForms[desc.form]),
                                          [](PelCurvatureLutDesc& d, Jitter& j) {
                                              d.radiusMin = j(d.radiusMin), d.radiusMax = j(d.radiusMax);
                                              d.diffusionRadius = j(d.diffusionRadius);
                                          });
}

Case shadowCase(const PelShadowLutDesc& desc, const Source& source, bool all) {
    return tableCase<PelShadowLutDesc>(
        desc, source, all,
        text("widths %.3g to %.3g mm, diffusion radius %.3g mm, sharpening %.3g", desc.widthMin,
             desc.widthMax, desc.diffusionRadius, desc.sharpening),
        [](PelShadowLutDesc& d, Jitter& j) {
            d.widthMin = j(d.widthMin), d.widthMax = j(d.widthMax);
            d.diffusionRadius = j(d.diffusionRadius), d.sharpening = std::max(1.0f, j(d.sharpening));
        });
}

constexpr const char* curvatureRange =
    "radii 0.01 to 10,000 mm, ratio of the two 1.1 to 10,000; diffusion radius 0.1 to 100 mm";

// Of any form if `form` is negative.
Operation curvatureTable(const std::string& name, int form, PelLutAxis axis, size_t points) {
    return {{"curvature table, " + name, std::string(curvatureRange) + (form < 0 ? "; all forms" : ""),
             Unit::absolute, tolerance::lutTexelGaussians, form < 0 ? 4u : 3u, points},
            [=](const std::vector<Point>& at) {
                const Point& p = at[0];
                PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                desc.form = PelCurvatureForm(form < 0 ? int(p[3] * 3.999) : form), desc.axis = axis;
                desc.width = 15, desc.height = axis == PEL_AXIS_ROOT ? 5 : 6;
                desc.radiusMin = float(logBetween(p[0], 0.01, 1000));
                desc.radiusMax = std::min(1e4f, float(desc.radiusMin * logBetween(p[1], 1.1, 1e4)));
                desc.radiusMax = std::max(desc.radiusMax, 1.1f * desc.radiusMin);
                desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
                return curvatureCase(desc, skin(), true);
            }};
}

Operation shadowTable() {
    return {{"shadow table", "widths 0.1 to 10,000 mm; diffusion radius 0.1 to 100 mm; sharpening 1 to 100",
             Unit::absolute, tolerance::lutTexelGaussians, 4, 400},
            [](const std::vector<Point>& at) {
                const Point& p = at[0];
                PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
                desc.width = 31, desc.height = 6;
                desc.widthMin = float(logBetween(p[0], 0.1, 1000));
                desc.widthMax = float(desc.widthMin * logBetween(p[1], 1.1, 10));
                desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
                desc.sharpening = float(logBetween(p[3], 1, 100));
                return shadowCase(desc, skin(), true);
            }};
}

Operation specularTable() {
    return {
        {"specular table", "1 to 2,000 by 1 to 200 texels: roughness from 0.0025", Unit::absolute,
         tolerance::lutTexelGaussians, 2, 100},
        [](const std::vector<Point>& at) {
            PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
            desc.width = uint32_t(logBetween(at[0][0], 1, 2000));
            desc.height = uint32_t(logBetween(at[0][1], 1, 200));
            const auto measured = [=] {
                const auto texels = Lut(device(), desc).read<float>(PEL_LUT_FLOAT);
                std::vector<float> one;
                for (size_t i = 0; i < texels.size(); i += 3) one.push_back(texels[i]);
                return one;
            };
            const auto truth = [=] {
                std::vector<double> t(size_t(desc.width) * desc.height);
                inParallel(t.size(), [&](size_t i) {
                    t[i] = reference::beckmannEncoded((double(i % desc.width) + 0.5) / desc.width,
                                                      (double(i / desc.width) + 0.5) / desc.height);
                });
                return t;
            };
            // The result depends only on two whole numbers.
            return Case{[](Jitter&) {}, measured, truth, text("%.0f x %.0f texels", desc.width, desc.height)};
        }};
}

Operation tables(const char* name, const char* range, Source (*make)(const Point&), double limit,
                 size_t points) {
    return {{std::string("tables of ") + name,
             std::string(range) + "; radii 0.05 to 10,000 of the profile's; four forms, and shadow",
             Unit::absolute, limit, 7, points},
            [make](const std::vector<Point>& at) {
                const Point& p = at[0];
                const Source source = make(p);
                const double radius = source.truth->radius();
                if (p[3] > 0.8) {
                    PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
                    desc.width = 15, desc.height = 5, desc.diffusionRadius = float(radius);
                    desc.widthMin = float(radius * logBetween(p[4], 0.5, 10));
                    desc.widthMax = float(desc.widthMin * logBetween(p[5], 1.1, 20));
                    desc.sharpening = float(logBetween(p[6], 1, 100));
                    return shadowCase(desc, source, false);
                }
                PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                desc.form = PelCurvatureForm(p[3] * 4.999), desc.axis = PEL_AXIS_ROOT;
                desc.width = 15, desc.height = 5, desc.diffusionRadius = float(radius);
                desc.radiusMin = float(radius * logBetween(p[4], 0.05, 10));
                desc.radiusMax = float(desc.radiusMin * logBetween(p[5], 1.1, 1000));
                return curvatureCase(desc, source, false);
            }};
}

}  // namespace

std::vector<Operation> tableOperations() {
    return {curvatureTable("arc", PEL_FORM_ARC, PEL_AXIS_LINEAR, 500),
            curvatureTable("ring", PEL_FORM_RING, PEL_AXIS_LINEAR, 500),
            curvatureTable("half-ring", PEL_FORM_HALF_RING, PEL_AXIS_LINEAR, 400),
            curvatureTable("sphere", PEL_FORM_SPHERE, PEL_AXIS_LINEAR, 150),
            curvatureTable("root axis", -1, PEL_AXIS_ROOT, 250),
            shadowTable(),
            specularTable(),
            tables("Gaussians", "1 to 8 Gaussians, the widest 0.05 to 50 mm", gaussians,
                   tolerance::lutTexelGaussians, 400),
            tables("Burley's profile", "mean free path 0.01 to 20 mm, albedo 0 to 1", burley,
                   tolerance::lutTexelOther, 60),
            tables("the dipole", "scattering 0.05 to 32 /mm, absorption 0.001 to 9 of it, eta 1.05 to 2",
                   dipole, tolerance::lutTexelOther, 80),
            tables("measurements", "2 to 32 distances, values at random", measuredTable,
                   tolerance::lutTexelOther, 80)};
}

}  // namespace stability
