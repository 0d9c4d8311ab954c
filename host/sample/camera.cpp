#include "sample/camera.h"

#include <algorithm>

namespace pellucid::sample {

constexpr double degrees = std::numbers::pi / 180;

Matrix4 Camera::view() const {
    const Vec3 f = forward(), u = perpendicular(f, up), r = cross(f, u);
    return Matrix4::fromRows(r, -dot(r, eye), u, -dot(u, eye), -f, dot(f, eye));
}

Matrix4 Camera::projection(double aspect) const {
    const double h = 1 / std::tan(0.5 * verticalFov * degrees), range = farPlane - nearPlane;
    return Matrix4::fromRows({h / aspect, 0, 0}, 0, {0, h, 0}, 0, {0, 0, -farPlane / range},
                             -farPlane * nearPlane / range, {0, 0, -1}, 0);
}

HeadPose poseWithUp(char axis) {
    return axis == 'y' ? HeadPose{{0, 1, 0}, {0, 0, 1}} : HeadPose{};
}

Vec3 headDirection(const HeadPose& pose, double azimuth, double elevation) {
    const Vec3 left = cross(pose.up, pose.front);
    const double a = azimuth * degrees, e = elevation * degrees;
    return normalize((pose.front * std::cos(a) + left * std::sin(a)) * std::cos(e) + pose.up * std::sin(e));
}

Camera frameHead(const Bounds& box, const HeadPose& pose, const Framing& framing, double aspect) {
    Camera camera;
    camera.target = box.centre();
    camera.up = pose.up;
    camera.verticalFov = framing.verticalFov;
    const Vec3 back = headDirection(pose, framing.azimuth, framing.elevation);
    const Vec3 up = perpendicular(back, camera.up), right = cross(up, back);
    const double tanY = std::tan(0.5 * framing.verticalFov * degrees) * framing.fill, tanX = tanY * aspect;
    double distance = 0, radius = 1e-3;
    for (int i = 0; i < 8 && !box.empty(); ++i) {
        const Vec3 p = box.corner(i) - camera.target;
        const double reach = std::max(std::abs(dot(p, right)) / tanX, std::abs(dot(p, up)) / tanY);
        distance = std::max(distance, dot(p, back) + reach);
        radius = std::max(radius, length(p));
    }
    distance = std::max(distance, 1.1 * radius);
    camera.eye = camera.target + back * distance;
    camera.nearPlane = std::max(distance - 1.05 * radius, 0.01 * distance);
    camera.farPlane = distance + 1.05 * radius;
    return camera;
}

}  // namespace pellucid::sample
