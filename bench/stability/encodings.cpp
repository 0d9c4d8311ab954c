// Tables as half floats and in FaceWorks' eight bits: how far a code is from the nearest to the truth.
#include "tables.h"

namespace stability {
namespace {

class Encoded : public Case {
  public:
    Encoded(const Point& p, PelLutEncoding encoding, int kind) : encoding_(encoding), kind_(kind) {
        c_.form = PelCurvatureForm(p[2] * 3.999);
        c_.width = s_.width = uint32_t(between(p[3], 5, 40)), c_.height = s_.height = 4;
        c_.radiusMin = float(logBetween(p[0], 0.05, 100)),
        c_.radiusMax = c_.radiusMin * float(logBetween(p[1], 1.1, 100));
        s_.widthMin = float(logBetween(p[0], 0.5, 100)),
        s_.widthMax = s_.widthMin * float(logBetween(p[1], 1.1, 10));
        s_.sharpening = float(logBetween(p[2], 1, 20));
    }
    void move(Jitter& j) override {
        c_.radiusMin = j(c_.radiusMin), c_.radiusMax = j(c_.radiusMax);
        s_.widthMin = j(s_.widthMin), s_.widthMax = j(s_.widthMax),
        s_.sharpening = std::max(1.0f, j(s_.sharpening));
    }
    // Differences are made here; the truth is 0.
    std::vector<float> measured() override {
        const Lut lut = kind_ ? Lut(device(), s_) : Lut(device(), c_);
        const auto halves = encoding_ == PEL_LUT_HALF ? lut.read<uint16_t>(encoding_) : std::vector<uint16_t>();
        const auto bytes = encoding_ == PEL_LUT_HALF ? std::vector<uint8_t>() : lut.read<uint8_t>(encoding_);
        std::vector<float> beyond(3 * texels());
        inParallel(texels(), [&](size_t i) {
            const reference::Rgb truth = texel(i), steps = eightBits(truth, i);
            for (size_t c = 0; c < 3; ++c) {
                if (encoding_ == PEL_LUT_HALF) {
                    beyond[3 * i + c] = float(beyondHalf(halves[3 * i + c], truth[int(c)]));
                } else {
                    beyond[3 * i + c] = float(std::max(0.0, std::abs(bytes[4 * i + c] - steps[int(c)]) - 0.5));
                }
            }
        });
        return beyond;
    }
    std::vector<double> truth() override { return std::vector<double>(3 * texels(), 0.0); }
    std::string where() override {
        return kind_ ? text("widths %.3g to %.3g mm, sharpening %.3g, %.0f texels", s_.widthMin, s_.widthMax,
                            s_.sharpening, s_.width)
                     : text("radii %.3g to %.3g mm, %.0f texels", c_.radiusMin, c_.radiusMax, c_.width) +
                           ", " + formNames[c_.form];
    }

  private:
    size_t texels() const { return size_t(c_.width) * c_.height; }
    reference::Rgb texel(size_t i) const {
        const int x = int(i % c_.width), y = int(i / c_.width);
        static const auto skin = reference::skinProfile();
        if (kind_)
            return reference::shadowTexel({int(s_.width), 4, s_.widthMin, s_.widthMax, 2.7, s_.sharpening},
                                          *skin, x, y);
        const reference::CurvatureLutSpec spec{trueForms[c_.form], int(c_.width), 4, c_.radiusMin, c_.radiusMax};
        return reference::curvatureTexel(spec, *reference::profileForRadius(skin, 2.7), x, y);
    }
    reference::Rgb eightBits(const reference::Rgb& truth, size_t i) const {
        const int x = int(i % c_.width);
        return kind_ ? reference::faceworksShadowSteps(truth, x, int(c_.width))
                     : reference::faceworksCurvatureSteps(truth, -1 + (x + 0.5) * 2 / c_.width);
    }

    PelLutEncoding encoding_;
    int kind_;
    PelCurvatureLutDesc c_ = pelCurvatureLutDescDefaults();
    PelShadowLutDesc s_ = pelShadowLutDescDefaults();
};

Operation encoded(const char* name, PelLutEncoding encoding, int kind, const tolerance::Tolerance& limit) {
    return operation(
        {name, kind ? "widths 0.5 to 1,000 mm, sharpening 1 to 20" : "all forms, radii 0.05 to 10,000 mm",
         encoding == PEL_LUT_HALF ? Unit::rounding : Unit::steps, limit, 4, 200},
        [=](const Point& p) { return std::make_unique<Encoded>(p, encoding, kind); });
}

}  // namespace

std::vector<Operation> encodingOperations() {
    return {encoded("curvature table as half floats", PEL_LUT_HALF, 0, tolerance::lutTexelGaussians),
            encoded("shadow table as half floats", PEL_LUT_HALF, 1, tolerance::lutTexelGaussians),
            encoded("curvature table in 8 bits", PEL_LUT_FACEWORKS8, 0, tolerance::byteBoundary),
            encoded("shadow table in 8 bits", PEL_LUT_FACEWORKS8, 1, tolerance::byteBoundary)};
}

}  // namespace stability
