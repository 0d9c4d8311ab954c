// Look-up tables of skin: every form and axis, shadow, specular.
#include "tables.h"

namespace stability {
namespace {

constexpr const char* curvatureRange =
    "radii 0.01 to 10,000 mm, ratio of the two 1.1 to 10,000; diffusion radius 0.1 to 100 mm";

void radii(PelCurvatureLutDesc& desc, const Point& p) {
    desc.radiusMin = float(logBetween(p[0], 0.01, 1000));
    desc.radiusMax = std::min(1e4f, float(desc.radiusMin * logBetween(p[1], 1.1, 1e4)));
    desc.radiusMax = std::max(desc.radiusMax, 1.1f * desc.radiusMin);
    desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
}

Operation curvatureTable(const char* name, PelCurvatureForm form, size_t points) {
    return operation({name, curvatureRange, Unit::absolute, tolerance::lutTexelGaussians, 3, points},
                     [form](const Point& p) {
                         PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                         desc.form = form, desc.width = 15, desc.height = 6;
                         radii(desc, p);
                         return std::make_unique<CurvatureTable>(desc, reference::skinProfile(), true);
                     });
}

Operation rootAxis() {
    return operation({"curvature table, root axis", std::string(curvatureRange) + "; all forms",
                      Unit::absolute, tolerance::lutTexelGaussians, 4, 250},
                     [](const Point& p) {
                         PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
                         desc.form = PelCurvatureForm(p[3] * 3.999), desc.axis = PEL_AXIS_ROOT;
                         desc.width = 15, desc.height = 5;
                         radii(desc, p);
                         return std::make_unique<CurvatureTable>(desc, reference::skinProfile(), true);
                     });
}

Operation shadowTable() {
    return operation(
        {"shadow table", "widths 0.1 to 10,000 mm; diffusion radius 0.1 to 100 mm; sharpening 1 to 100",
         Unit::absolute, tolerance::lutTexelGaussians, 4, 400},
        [](const Point& p) {
            PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
            desc.width = 31, desc.height = 6;
            desc.widthMin = float(logBetween(p[0], 0.1, 1000));
            desc.widthMax = float(desc.widthMin * logBetween(p[1], 1.1, 10));
            desc.diffusionRadius = float(logBetween(p[2], 0.1, 100));
            desc.sharpening = float(logBetween(p[3], 1, 100));
            return std::make_unique<ShadowTable>(desc, reference::skinProfile());
        });
}

class SpecularTable : public Case {
  public:
    explicit SpecularTable(const Point& p) {
        desc_.width = uint32_t(logBetween(p[0], 1, 2000));
        desc_.height = uint32_t(logBetween(p[1], 1, 200));
    }
    void move(Jitter&) override {}  // two whole numbers are all it hangs on
    std::vector<float> measured() override {
        const auto texels = Lut(device(), desc_).read<float>(PEL_LUT_FLOAT);
        std::vector<float> one;
        for (size_t i = 0; i < texels.size(); i += 3) one.push_back(texels[i]);
        return one;
    }
    std::vector<double> truth() override {
        std::vector<double> t(size_t(desc_.width) * desc_.height);
        inParallel(desc_.height, [&](size_t y) {
            for (uint32_t x = 0; x < desc_.width; ++x)
                t[y * desc_.width + x] =
                    reference::beckmannEncoded((x + 0.5) / desc_.width, (double(y) + 0.5) / desc_.height);
        });
        return t;
    }
    std::string where() override { return text("%.0f x %.0f texels", desc_.width, desc_.height); }

  private:
    PelSpecularLutDesc desc_ = pelSpecularLutDescDefaults();
};

}  // namespace

std::vector<Operation> tableOperations() {
    std::vector<Operation> all{curvatureTable("curvature table, arc", PEL_FORM_ARC, 500),
                               curvatureTable("curvature table, ring", PEL_FORM_RING, 500),
                               curvatureTable("curvature table, half-ring", PEL_FORM_HALF_RING, 400),
                               curvatureTable("curvature table, sphere", PEL_FORM_SPHERE, 150),
                               rootAxis(),
                               shadowTable()};
    all.push_back(operation({"specular table", "1 to 2,000 by 1 to 200 texels: roughness from 0.0025",
                             Unit::absolute, tolerance::lutTexelGaussians, 2, 100},
                            [](const Point& p) { return std::make_unique<SpecularTable>(p); }));
    return all;
}

}  // namespace stability
