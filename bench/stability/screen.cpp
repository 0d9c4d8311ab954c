// Passes over neighbouring pixels: curvature from a G-buffer, blurred normals.
#include "reference/screen.h"

#include "stability.h"

namespace stability {
namespace {

using reference::Vec3;

// The middle of a sphere's picture, so that no step to a neighbour comes near an edge of depth, where a
// decision turns.
class ScreenCurvature : public Case {
  public:
    explicit ScreenCurvature(const Point& p) {
        const double radius = logBetween(p[0], 0.01, 1e4), step = 1 / logBetween(p[1], 10, 300),
                     away = p[2] < 0.1 ? 0 : logBetween(p[2], 1e-3, 100),
                     aside = std::clamp(1.4 * (p[3] - 0.5), -0.7 + 16 * step, 0.7 - 16 * step);
        for (uint32_t i = 0; i < width * height; ++i) {
            const double x = std::clamp(aside + (i % width - 16.0) * step, -0.95, 0.95),
                         y = (i / width - 4.0) * step * 0.75,
                         z = std::sqrt(std::max(0.01, 1 - x * x - y * y));
            for (double v : {x, y, z}) normals_.push_back(float(v));
            for (double v : {x + away, y, z}) positions_.push_back(float(radius * v));
        }
        where_ = text("radius %.3g, %.3g pixels, %.2g radii away", radius, 1 / step, away);
    }
    void move(Jitter& j) override { j(normals_), j(positions_); }
    std::vector<float> measured() override {
        PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
        params.edge = 1;  // no step is too steep
        const Buffer n(device(), normals_), at(device(), positions_), out(device(), width * height * 4);
        const PelImageDesc places = imageDesc(at, PEL_FORMAT_RGB32F, width, height);
        screenCurvature(device(), params, imageDesc(n, PEL_FORMAT_RGB32F, width, height), &places, nullptr,
                        nullptr, imageDesc(out, PEL_FORMAT_R32F, width, height));
        return out.readAll<float>();
    }
    std::vector<double> truth() override {
        reference::ScreenImage image{width, height, {}, {}, {}};
        for (size_t i = 0; i < normals_.size(); i += 3) {
            image.normals.push_back({normals_[i], normals_[i + 1], normals_[i + 2]});
            image.positions.push_back({positions_[i], positions_[i + 1], positions_[i + 2]});
        }
        return reference::screenCurvature(image, 1 + 1e-9);
    }
    std::string where() override { return where_; }

  private:
    static constexpr uint32_t width = 33, height = 9;
    std::vector<float> normals_, positions_;
    std::string where_;
};

class BlurredNormals : public Case {
  public:
    explicit BlurredNormals(const Point& p) : pixel_(logBetween(p[0], 0.05, 5)) {
        frame_ = shade_test::reliefFrame(uint32_t(1 + p[2] * 40), 53, 29, float(pixel_));
        shade_test::showBlurredNormal(frame_);
        frame_.options.blurNormals = 1;
        for (auto& [id, m] : frame_.materials) m.diffusionRadius = float(logBetween(p[1], 0.1, 30) / id);
    }
    void move(Jitter& j) override {
        j(frame_.slots[PEL_SLOT_NORMAL_SHADING].values), j(frame_.slots[PEL_SLOT_POSITION].values);
    }
    std::vector<float> measured() override {
        const std::vector<float> shown = shade_test::shade(device(), frame_, shade_test::tables());
        std::vector<float> n;
        for (size_t i = 0; i < frame_.pixels(); ++i) {
            const Vec3 v = shade_test::shownNormal(shown, i);
            for (int c = 0; c < 3; ++c) n.push_back(float(v[c]));
        }
        return n;
    }
    std::vector<double> truth() override {
        std::vector<bool> doubtful;
        const auto normals = reference::blurredNormals(shade_test::surfaceOf(frame_), &doubtful);
        std::vector<double> t;
        for (size_t i = 0; i < normals.size(); ++i)
            for (int c = 0; c < 3; ++c) t.push_back(normals[i] && !doubtful[i] ? (*normals[i])[c] : NAN);
        return t;
    }
    std::string where() override {
        return text("diffusion radius %.3g mm, pixels %.3g mm apart", frame_.materials[1].diffusionRadius,
                    pixel_);
    }

  private:
    double pixel_;
    shade_test::Frame frame_;
};

}  // namespace

std::vector<Operation> screenOperations() {
    Operation screen =
        operation({"curvature from a G-buffer",
                   "radius 0.01 to 10,000 units, 10 to 300 pixels; up to 100 radii away from the origin",
                   Unit::largest, tolerance::finePixels, 4, 8000},
                  [](const Point& p) { return std::make_unique<ScreenCurvature>(p); });
    screen.axis = Axis{1, 10, 300, "pixels per radius"};
    Operation blurred = operation({"blurred normals",
                                   "diffusion radius 0.1 to 30 mm, pixels 0.05 to 5 mm apart; a cliff, a "
                                   "hole, two materials, normals at random",
                                   Unit::absolute, tolerance::shadeTerm, 3, 500},
                                  [](const Point& p) { return std::make_unique<BlurredNormals>(p); });
    return {screen, blurred};
}

}  // namespace stability
