// Area lights as many small lights: the reference for the closed forms and approximations of the kernels.
#pragma once
#include "reference/shade.h"

namespace reference {

// A sphere, or a rectangle if halfWidth is not 0. Colours as PelLight has them: the radiance is color /
// radius^2, or pi color / area.
struct AreaLamp {
    Vec3 center;
    Rgb color;
    double radius = 0;           // length
    Vec3 halfWidth, halfHeight;  // from the centre to the middles of two sides
};

// side * side lights: even solid angles of the part of the sphere that is seen, or even areas of the
// rectangle. None where the rectangle shines the other way.
std::vector<PixelLight> areaLights(const AreaLamp& lamp, Vec3 position, int side);

}  // namespace reference
