// The view of the sample renderer, and where to put camera and light round a head.
#pragma once
#include "sample/mesh.h"

namespace pellucid::sample {

// A perspective camera. View space is right-handed: x right, y up, the camera looks along -z. Clip space has
// x and y in [-w, w], y up (row 0 of an image on top), and z from 0 at the near plane to w at the far plane.
struct Camera {
    Vec3 eye{0, -1000, 0};    // mm
    Vec3 target{0, 0, 0};     // mm
    Vec3 up{0, 0, 1};         // need not be across the view direction
    double verticalFov = 20;  // degrees; 20: a portrait from two head heights away
    double nearPlane = 100;   // mm
    double farPlane = 2000;   // mm

    Vec3 forward() const { return normalize(target - eye, {0, 1, 0}); }
    Matrix4 view() const;                     // world to view
    Matrix4 projection(double aspect) const;  // view to clip; aspect: width / height
    Matrix4 viewProjection(double aspect) const { return projection(aspect) * view(); }
    Matrix4 inverseViewProjection(double aspect) const { return viewProjection(aspect).inverse(); }
};

// Which way a head looks. The default is that of most scans with z up; {y, z} suits y-up files.
struct HeadPose {
    Vec3 up{0, 0, 1};      // unit, towards the crown
    Vec3 front{0, -1, 0};  // unit, across up, where the nose points
};

// The pose of a mesh by its up axis: 'y' (it looks to +z, as most OBJ files), else 'z' (to -y, as scans).
HeadPose poseWithUp(char axis);

// Unit vector away from the head: azimuth 0 is the front, 90 its left ear (on the right of a frontal
// picture), 180 the back; elevation 90 is straight up. Degrees.
Vec3 headDirection(const HeadPose& pose, double azimuth, double elevation);

struct Framing {
    double azimuth = 0;       // degrees, as in headDirection
    double elevation = 0;     // degrees
    double verticalFov = 20;  // degrees
    double fill = 0.94;  // part of the image's height or width that the box takes, whichever is reached first
};

// The camera that sees the whole box as large as `framing` says. Near and far plane enclose the box.
Camera frameHead(const Bounds& box, const HeadPose& pose, const Framing& framing, double aspect);

}  // namespace pellucid::sample
