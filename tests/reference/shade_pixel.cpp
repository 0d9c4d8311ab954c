#include "reference/shade_pixel.h"

namespace reference {
namespace {

Rgb deltaAt(const Material& material, const Pixel& pixel, Vec3 toLight) {
    if (!material.curvatureLut) return {};
    const ScatterTable& lut = *material.curvatureLut;
    const double u = dot(pixel.blurred, toLight);
    const double row = curvatureRow(pixel.curvature, lut.least, lut.most,
                                    radiusRatio(lut.diffusionRadius, material.diffusionRadius));
    return bilinear(lut.table, 0.5 * u + 0.5, row) - max0(u) * Rgb{1, 1, 1};
}

Rgb shadowAt(const Material& material, const Pixel& pixel, const PixelLight& light) {
    if (!material.shadowLut) return light.wideShadow * Rgb{1, 1, 1};
    const ScatterTable& lut = *material.shadowLut;
    const double row = shadowRow(dot(pixel.geometric, light.toLight), material.shadowFilterWidth, lut.least,
                                 lut.most, radiusRatio(lut.diffusionRadius, material.diffusionRadius));
    return bilinear(lut.table, light.wideShadow, row);
}

}  // namespace

Shaded shadeLight(const Material& material, const Pixel& pixel, const PixelLight& light) {
    Shaded out;
    const Rgb delta = deltaAt(material, pixel, light.toLight);
    const Rgb lit = direct(delta, pixel.shading, pixel.blurred, light.toLight, material.normalBlend);
    out.scattered = material.albedo * light.color * lit * shadowAt(material, pixel, light);
    if (light.hasThickness && magnitude(material.deepScatterColor) > 0)
        out.deepScatter =
            deepScatter(light.thickness, material.deepScatterRadius, pixel.blurred, light.toLight) *
            (material.deepScatterColor * material.albedo * light.color);
    if (material.specular > 0) {
        const double shadow = material.shadowLut
                                  ? sharpenedShadow(light.wideShadow, material.shadowLut->sharpening)
                                  : light.wideShadow;
        const double lobe =
            material.ggx ? specularGgx(pixel.shading, light.toLight, pixel.toViewer, material.roughness,
                                       material.roughness2, material.lobeMix, material.specular, material.f0)
                         : specular(pixel.shading, light.toLight, pixel.toViewer, material.roughness,
                                    material.specular, material.f0);
        out.specular = shadow * lobe * light.color;
    }
    return out;
}

Shaded shadePixel(const Material& material, const Pixel& pixel, const std::vector<PixelLight>& lights,
                  const Ambient& ambient) {
    Shaded total;
    for (const PixelLight& light : lights) {
        const Shaded one = shadeLight(material, pixel, light);
        total.scattered = total.scattered + one.scattered;
        total.deepScatter = total.deepScatter + one.deepScatter;
        total.specular = total.specular + one.specular;
    }
    total.ambient =
        pixel.ambientOcclusion *
        (material.albedo * ambientTerm(ambient, pixel.shading, pixel.blurred, material.normalBlend));
    if (pixel.hasThickness && material.deepScatterAmbient > 0) {
        const double t = pixel.thickness / material.deepScatterRadius;
        total.deepScatter = total.deepScatter + material.deepScatterAmbient * std::exp(-t * t / 2) *
                                                    (material.deepScatterColor * material.albedo *
                                                     irradiance(ambient, -1 * pixel.blurred));
    }
    return total;
}

PixelLight lampAt(const Lamp& lamp, Vec3 position) {
    const Vec3 offset = lamp.position - position;
    const double distance = length(offset);
    PixelLight light;
    light.toLight = offset / distance;
    double strength = 1 / (distance * distance);
    if (lamp.range > 0 && distance > lamp.range) strength = 0;
    if (lamp.spot) {
        const double cosine = -dot(light.toLight, lamp.axis);
        strength *= smoothstep01(saturate((cosine - lamp.cosOuter) / (lamp.cosInner - lamp.cosOuter)));
    }
    light.color = strength * lamp.color;
    return light;
}

}  // namespace reference
