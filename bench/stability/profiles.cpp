// Profiles as sources of tables: curvature by any form on the root axis, and shadow.
#include "tables.h"

namespace stability {
namespace {

using reference::Rgb;

// A profile on the device and in the oracle, from the same floats.
struct Source {
    Profile ours;
    reference::ProfilePtr truth;
    std::string where;
};
Rgb rgb(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

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
        truth.push_back({g.variance, rgb(g.weight)});
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
    return {Profile::burley(path, albedo), reference::burleyProfile(rgb(path), rgb(albedo)),
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
            reference::dipoleProfile(rgb(absorption), rgb(scattering), eta),
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

// Puts the name of the profile before the description of the table.
template <class Table>
class OfSource : public Table {
  public:
    template <class Desc>
    OfSource(const Desc& desc, const Source& s) : Table(desc, s.truth, false, s.ours), source_(s.where) {}
    std::string where() override { return source_ + ": " + Table::where(); }

  private:
    std::string source_;
};

Operation tables(const char* name, const char* range, Source (*source)(const Point&),
                 const tolerance::Tolerance& limit, size_t points) {
    return operation({std::string("tables of ") + name,
                      std::string(range) + "; radii 0.05 to 10,000 of the profile's; four forms, and shadow",
                      Unit::absolute, limit, 7, points},
                     [source](const Point& p) -> std::unique_ptr<Case> {
                         const Source s = source(p);
                         const double radius = s.truth->radius();
                         if (p[3] > 0.8) {
                             PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
                             desc.width = 15, desc.height = 5, desc.diffusionRadius = float(radius);
                             desc.widthMin = float(radius * logBetween(p[4], 0.5, 10));
                             desc.widthMax = float(desc.widthMin * logBetween(p[5], 1.1, 20));
                             desc.sharpening = float(logBetween(p[6], 1, 100));
                             return std::make_unique<OfSource<ShadowTable>>(desc, s);
                         }
                         PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                         desc.form = PelCurvatureForm(p[3] * 4.999), desc.axis = PEL_AXIS_ROOT;
                         desc.width = 15, desc.height = 5, desc.diffusionRadius = float(radius);
                         desc.radiusMin = float(radius * logBetween(p[4], 0.05, 10));
                         desc.radiusMax = float(desc.radiusMin * logBetween(p[5], 1.1, 1000));
                         return std::make_unique<OfSource<CurvatureTable>>(desc, s);
                     });
}

}  // namespace

std::vector<Operation> profileOperations() {
    return {tables("Gaussians", "1 to 8 Gaussians, the widest 0.05 to 50 mm", gaussians,
                   tolerance::lutTexelGaussians, 400),
            tables("Burley's profile", "mean free path 0.01 to 20 mm, albedo 0 to 1", burley,
                   tolerance::lutTexelOther, 60),
            tables("the dipole", "scattering 0.05 to 32 /mm, absorption 0.001 to 9 of it, eta 1.05 to 2",
                   dipole, tolerance::lutTexelOther, 80),
            tables("measurements", "2 to 32 distances, values at random", measuredTable,
                   tolerance::lutTexelOther, 80)};
}

}  // namespace stability
