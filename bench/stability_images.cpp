#include "reference/screen.h"

#include "stability.h"

namespace stability {
namespace {

// A frame of pixels that all lie in one neighbourhood of the inputs; the search moves and narrows it.
Operation shading(const char* name, bool specularOnly) {
    return {name,
            "albedo, curvature -0.1 to 1.2 /mm, wide shadow, normals up to 25 degrees apart, roughness 0.05 "
            "to 0.45, N.L and V.H at all "
            "angles; three kinds of light; all terms",
            "absolute, relative above 1", 6, [=](const Point& p, std::string& where) {
                shade_test::Frame f = shade_test::randomFrame(uint32_t(1 + p[0] * 40), 61, 31, 3);
                for (auto& [id, m] : f.materials) {
                    m.roughness = float(logBetween(p[1], 0.05, 0.3));
                    m.specular = specularOnly ? 1.0f : float(p[2]);
                    m.deepScatterRadius = float(logBetween(p[3], 1, 40));
                    m.diffusionRadius = float(logBetween(p[4], 0.5, 20));
                    m.thicknessTaps = 32;
                }
                for (float& v : f.slots[PEL_SLOT_CURVATURE].values) v = float(p[5]) + 0.1f * v;
                const std::vector<float> out = shade_test::shade(device(), f, shade_test::tables());
                where = text(
                    "roughness %.3g, specular %.3g, deep scatter radius %.3g mm, diffusion radius %.3g mm",
                    f.materials[1].roughness, f.materials[1].specular, f.materials[1].deepScatterRadius,
                    f.materials[1].diffusionRadius);
                // Relative to the brightest radiance where that is above 1: a sharp lobe reaches hundreds.
                double worst = 0;
                for (size_t i = 0; i < f.pixels(); ++i) {
                    const reference::Rgb sum = shade_test::truth(f, shade_test::tables(), i).sum();
                    for (int c = 0; c < 3; ++c) {
                        const double e = std::abs(sum[c] - out[3 * i + size_t(c)]) / std::max(1.0, sum[c]);
                        keepWorst(worst, e);
                    }
                }
                return worst;
            }};
}

// The middle of a sphere's picture, so that no step to a neighbour comes near an edge of depth, where a
// decision turns.
Operation screenCurvatures() {
    return {
        "screen curvature",
        "radius 0.01 to 10,000 units, 10 to 300 pixels; up to 100 radii away from the origin",
        "of the largest", 4, [](const Point& p, std::string& where) {
            const double radius = logBetween(p[0], 0.01, 1e4), step = 1 / logBetween(p[1], 10, 300),
                         away = p[2] < 0.1 ? 0 : logBetween(p[2], 1e-3, 100);
            constexpr uint32_t width = 33, height = 9;
            reference::ScreenImage image{width, height, {}, {}, {}};
            std::vector<float> normals, positions;
            for (uint32_t i = 0; i < width * height; ++i) {
                const double x = std::min(0.7, std::max(-0.7, (p[3] - 0.5) + (i % width - 16.0) * step)),
                             y = (i / width - 4.0) * step, z = std::sqrt(1 - x * x - y * y);
                const float n[3] = {float(x), float(y), float(z)};
                const float at[3] = {float(radius * (x + away)), float(radius * y), float(radius * z)};
                normals.insert(normals.end(), n, n + 3), positions.insert(positions.end(), at, at + 3);
                image.normals.push_back({n[0], n[1], n[2]}), image.positions.push_back({at[0], at[1], at[2]});
            }
            where = text("radius %.3g, %.3g pixels, %.2g radii away", radius, 1 / step, away);
            PelScreenCurvatureParams params = pelScreenCurvatureParamsDefaults();
            params.edge = 1;  // no step is too steep
            const Buffer n(device(), normals), at(device(), positions), out(device(), width * height * 4);
            const PelImageDesc places = imageDesc(at, PEL_FORMAT_RGB32F, width, height);
            screenCurvature(device(), params, imageDesc(n, PEL_FORMAT_RGB32F, width, height), &places,
                            nullptr, nullptr, imageDesc(out, PEL_FORMAT_R32F, width, height));
            const std::vector<float> values = out.readAll<float>();
            const std::vector<double> truth = reference::screenCurvature(image, params.edge);
            double worst = 0, largest = 0;
            for (size_t i = 0; i < truth.size(); ++i) {
                const double e = std::abs(values[i] - truth[i]);
                keepWorst(worst, e);
                largest = std::max(largest, truth[i]);
            }
            return worst / largest;
        }};
}

Operation blurredNormals() {
    return {"blurred normals",
            "diffusion radius 0.1 to 30 mm, pixels 0.05 to 5 mm apart; a cliff, a hole, two materials, "
            "normals at random",
            "absolute", 3, [](const Point& p, std::string& where) {
                const double pixel = logBetween(p[0], 0.05, 5);
                shade_test::Frame f = shade_test::reliefFrame(uint32_t(1 + p[2] * 40), 53, 29, float(pixel));
                shade_test::showBlurredNormal(f);
                f.options.blurNormals = 1;
                for (auto& [id, m] : f.materials) m.diffusionRadius = float(logBetween(p[1], 0.1, 30) / id);
                where = text("diffusion radius %.3g mm, pixels %.3g mm apart", f.materials[1].diffusionRadius,
                             pixel);
                const std::vector<float> shown = shade_test::shade(device(), f, shade_test::tables());
                std::vector<bool> doubtful;
                const auto truth = reference::blurredNormals(shade_test::surfaceOf(f), &doubtful);
                double worst = 0;
                for (size_t i = 0; i < f.pixels(); ++i) {
                    if (!truth[i] || doubtful[i]) continue;
                    const double e = reference::magnitude(shade_test::shownNormal(shown, i) - *truth[i]);
                    keepWorst(worst, e);
                }
                return worst;
            }};
}

Operation wideShadows() {
    return {"wide shadow",
            "light at any height, parallel and perspective, depth either way; filter 1 to 30 mm, bias 0.1 to "
            "5 mm; 40 to 200 texels, "
            "of which 8 to 64 are read",
            "absolute", 6, [](const Point& p, std::string& where) {
                const uint32_t kind = uint32_t(p[5] * 3.999), size = uint32_t(logBetween(p[3], 40, 200));
                const double up = logBetween(p[0], 0.1, 3);
                shade_test::MapLight from = shade_test::mapLight(uint32_t(1 + p[5] * 100), kind & 1, kind & 2,
                                                                 {0.6, 0.3, up}, {16, 8, 5}, 50, size);
                PelLight& light = from.light.params;
                light.shadowFilterTexels = uint32_t(logBetween(p[4], 8, 64));
                light.shadowBias = float(logBetween(p[2], 0.1, 5));
                shade_test::Frame f = shade_test::reliefFrame(1, 41, 21, 0.8f);
                for (auto& [id, m] : f.materials) m.shadowFilterWidth = float(logBetween(p[1], 1, 30));
                f.lights = {from.light};
                shade_test::showWideShadow(f);
                const std::vector<float> shown = shade_test::shade(device(), f, shade_test::tables());
                const reference::WideFilterParams params{f.materials[1].shadowFilterWidth, light.shadowBias,
                                                         light.shadowSoftness, light.shadowConeSlope,
                                                         int(light.shadowFilterTexels)};
                where = text("height %.2g, filter %.3g mm, bias %.2g mm", up, params.width, params.bias) +
                        text(", %.0f texels, %.0f read", size, light.shadowFilterTexels) +
                        (kind & 1 ? ", perspective" : ", parallel");
                double worst = 0;
                for (size_t i = 0; i < f.pixels(); ++i) {
                    if (f.slots[PEL_SLOT_MATERIAL].at(i) == 0) continue;
                    const double e =
                        std::abs(reference::wideShadow(from.map, from.view, f.slots[PEL_SLOT_POSITION].vec(i),
                                                       f.slots[PEL_SLOT_NORMAL_GEOMETRIC].vec(i), params) -
                                 shown[3 * i]);
                    keepWorst(worst, e);
                }
                return worst;
            }};
}

}  // namespace

std::vector<Operation> imageOperations() {
    return {screenCurvatures(), blurredNormals(), wideShadows(), shading("shading", false),
            shading("shading, full specular", true)};
}

}  // namespace stability
