// Passes over neighbouring pixels: curvature from a G-buffer, blurred normals.
#include "reference/curvature.h"

#include "stability.h"

namespace stability {
namespace {

using reference::Vec3;

// The middle of a sphere's picture, where no step to a neighbour is near the decision about edges of depth.
Case screenCurvatureCase(const Point& p) {
    constexpr uint32_t width = 33, height = 9;
    struct Images {
        std::vector<float> normals, positions;
    };
    const auto of = std::make_shared<Images>();
    const double radius = logBetween(p[0], 0.01, 1e4), step = 1 / logBetween(p[1], 10, 300),
                 away = p[2] < 0.1 ? 0 : logBetween(p[2], 1e-3, 100),
                 aside = std::clamp(1.4 * (p[3] - 0.5), -0.7 + 16 * step, 0.7 - 16 * step);
    for (uint32_t i = 0; i < width * height; ++i) {
        const double x = std::clamp(aside + (i % width - 16.0) * step, -0.95, 0.95),
                     y = (i / width - 4.0) * step * 0.75, z = std::sqrt(std::max(0.01, 1 - x * x - y * y));
        for (double v : {x, y, z}) of->normals.push_back(float(v));
        for (double v : {x + away, y, z}) of->positions.push_back(float(radius * v));
    }
    const auto measured = [=] {
        PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
        params.edge = 1;  // no step is too steep
        const Buffer n(device(), of->normals), at(device(), of->positions), out(device(), width * height * 4);
        const PelImageDesc places = imageDesc(at, PEL_FORMAT_RGB32F, width, height);
        screenCurvature(device(), params, imageDesc(n, PEL_FORMAT_RGB32F, width, height), &places, nullptr,
                        nullptr, imageDesc(out, PEL_FORMAT_R32F, width, height));
        return out.readAll<float>();
    };
    const auto truth = [=] {
        reference::ScreenImage image{width, height, {}, {}, {}};
        for (size_t i = 0; i < of->normals.size(); i += 3) {
            image.normals.push_back({of->normals[i], of->normals[i + 1], of->normals[i + 2]});
            image.positions.push_back({of->positions[i], of->positions[i + 1], of->positions[i + 2]});
        }
        return reference::screenCurvature(image, 1 + 1e-9);
    };
    return {[=](Jitter& j) { j(of->normals), j(of->positions); }, measured, truth,
            text("radius %.3g, %.3g pixels, %.2g radii away", radius, 1 / step, away)};
}

Case blurredNormalsCase(const Point& p) {
    const double pixel = logBetween(p[0], 0.05, 5);
    const auto frame = std::make_shared<shade_test::Frame>(
        shade_test::reliefFrame(uint32_t(1 + p[2] * 40), 53, 29, float(pixel)));
    shade_test::showBlurredNormal(*frame);
    frame->options.blurNormals = 1;
    for (auto& [id, m] : frame->materials) m.diffusionRadius = float(logBetween(p[1], 0.1, 30) / id);
    const auto measured = [=] {
        const std::vector<float> shown = shade_test::shade(device(), *frame, shade_test::tables());
        std::vector<float> n;
        for (size_t i = 0; i < frame->pixels(); ++i) {
            const Vec3 v = shade_test::shownNormal(shown, i);
            for (int c = 0; c < 3; ++c) n.push_back(float(v[c]));
        }
        return n;
    };
    const auto truth = [=] {
        std::vector<bool> doubtful;
        const auto normals = reference::blurredNormals(shade_test::surfaceOf(*frame), &doubtful);
        std::vector<double> t;
        for (size_t i = 0; i < normals.size(); ++i)
            for (int c = 0; c < 3; ++c) t.push_back(normals[i] && !doubtful[i] ? (*normals[i])[c] : NAN);
        return t;
    };
    const auto move = [=](Jitter& j) {
        j(frame->slots[PEL_SLOT_NORMAL_SHADING].values), j(frame->slots[PEL_SLOT_POSITION].values);
    };
    return {
        move, measured, truth,
        text("diffusion radius %.3g mm, pixels %.3g mm apart", frame->materials[1].diffusionRadius, pixel)};
}

}  // namespace

std::vector<Operation> screenOperations() {
    return {{{"curvature from a G-buffer",
              "radius 0.01 to 10,000 units, 10 to 300 pixels; up to 100 radii away from the origin",
              Unit::largest, tolerance::finePixels, 4, 8000},
             [](const std::vector<Point>& at) { return screenCurvatureCase(at[0]); },
             1,
             Axis{1, 10, 300, "pixels per radius"}},
            {{"blurred normals",
              "diffusion radius 0.1 to 30 mm, pixels 0.05 to 5 mm apart; a cliff, a hole, two materials, "
              "normals at random",
              Unit::absolute, tolerance::shadeTerm, 3, 500},
             [](const std::vector<Point>& at) { return blurredNormalsCase(at[0]); }}};
}

}  // namespace stability
