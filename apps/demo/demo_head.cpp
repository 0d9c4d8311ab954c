#include "demo/demo_head.h"

#include <filesystem>

#include "io/mesh/mesh_parts.h"

namespace pellucid::demo {
namespace {

using sample::Bounds;
using sample::LinearColor;
using sample::Vec3;

Vec3 positionOf(const io::MeshData& mesh, uint32_t v) {
    return {mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
}

Bounds boundsOfPart(const io::PartedMesh& head, const std::string& name) {
    Bounds bounds;
    const int part = head.part(name);
    for (size_t t = 0; part >= 0 && t < head.partOf.size(); ++t)
        if (head.partOf[t] == uint32_t(part))
            for (int c = 0; c < 3; ++c) bounds.add(positionOf(head.mesh, head.mesh.triangles[3 * t + c]));
    return bounds;
}

// The point of the head furthest to the front within `reach` of (x, y), seen from the front.
Vec3 foremost(const io::MeshData& mesh, double x, double y, double reach) {
    Vec3 best{x, y, -INFINITY};
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const Vec3 p = positionOf(mesh, v);
        if (std::hypot(p.x - x, p.y - y) < reach && p.z > best.z) best.z = p.z;
    }
    return best;
}

// Blood shows where skin is thin: lips, cheeks, nose, ears. Places and sizes follow the distance between the
// eyes, the mouth and the outline; the strength is chosen by eye.
std::vector<sample::Tint> tintsOf(const io::PartedMesh& head, const Bounds (&eyes)[2], const Bounds& mouth,
                                  const Bounds& skin) {
    const Vec3 left = eyes[0].centre(), right = eyes[1].centre();
    const double e = std::abs(left.x - right.x);
    const double lipLine = mouth.centre().y;
    std::vector<sample::Tint> tints;
    const auto add = [&](double x, double y, Vec3 radii, LinearColor factor, double edge) {
        Vec3 centre = foremost(head.mesh, x, y, 0.08 * e);
        centre.z -= 0.3 * radii.z * e;
        tints.push_back({centre, radii * e, factor, edge});
    };
    add(0, lipLine + 0.02 * e, {0.42, 0.15, 0.4}, {0.86, 0.56, 0.60}, 0.35);
    for (const double side : {-1.0, 1.0}) {
        add(side * 0.66 * e, left.y - 0.66 * e, {0.5, 0.42, 0.7}, {1.02, 0.84, 0.84}, 1);
        const double x = side > 0 ? skin.high.x : skin.low.x;
        tints.push_back({{x, left.y - 0.25 * e, skin.centre().z - 0.1 * e},
                         Vec3{0.35, 0.75, 0.6} * e,
                         {1.02, 0.80, 0.78},
                         1});
    }
    add(0, 0.5 * (left.y + lipLine) - 0.02 * e, {0.3, 0.3, 0.5}, {1.02, 0.86, 0.86}, 1);
    // Brows: an arc over each eye, darkest in the middle, of spots that overlap.
    constexpr int spots = 9;
    for (const double side : {-1.0, 1.0})
        for (int i = 0; i < spots; ++i) {
            const double s = double(i) / (spots - 1), along = -0.30 + 0.66 * s;
            const double x = side * (0.5 * e + along * e), y = left.y + (0.30 + 0.10 * std::sin(2.4 * s)) * e;
            const double strength = 0.6 + 0.14 * s;
            add(x, y, {0.09, 0.075 - 0.025 * s, 0.3}, {strength, 0.93 * strength, 0.9 * strength}, 0.9);
        }
    return tints;
}

// The lips are open by a hair, and teeth reach into them: moved back and in, they stay in the mouth's shade.
void closeMouth(io::PartedMesh& head) {
    constexpr float back = 4;  // mm
    std::vector<bool> moved(head.mesh.vertexCount());
    for (size_t c = 0; c < head.mesh.triangles.size(); ++c) {
        const std::string& name = head.parts[head.partOf[c / 3]];
        const uint32_t v = head.mesh.triangles[c];
        if (moved[v] || !(name.starts_with("teeth") || name.starts_with("tongue"))) continue;
        moved[v] = true;
        head.mesh.positions[3 * v + 2] -= back;
    }
}

// An adult's eye, as large as the ball.
io::SceneEye modelOf(const sample::EyeLook& look, uint32_t material) {
    io::SceneEye model;
    model.material = material;
    PelEye& eye = model.eye;
    const Vec3 centre = look.centre, gaze = look.gaze;
    const double place[3] = {centre.x, centre.y, centre.z}, direction[3] = {gaze.x, gaze.y, gaze.z};
    for (int i = 0; i < 3; ++i) eye.center[i] = float(place[i]), eye.gaze[i] = float(direction[i]);
    const float scale = float(look.radius) / eye.scleraRadius;
    for (float* length : {&eye.scleraRadius, &eye.corneaRadius, &eye.limbusRadius, &eye.limbusWidth,
                          &eye.chamberDepth, &eye.pupilRadius})
        *length *= scale;
    return model;
}

}  // namespace

bool hasHeadParts(const std::string& path) {
    if (std::filesystem::path(path).extension() != ".obj") return false;
    return io::loadParts(path, 0).part("skin") >= 0;
}

DemoHead loadDemoHead(const std::string& path, int levels) {
    io::PartedMesh head = io::loadParts(path, levels);
    closeMouth(head);
    // A straight cut in place of the ragged end of the data.
    const Bounds whole = boundsOfPart(head, "skin");
    const float cut = float(whole.low.y + 0.13 * (whole.high.y - whole.low.y));
    io::cutAndClose(head, "skin", {0, 0.976f, 0.22f}, 0.976f * cut, "cut");
    DemoHead out;
    out.pose = {{0, 1, 0}, {0, 0, 1}};
    for (const uint32_t part : head.partOf) {
        const std::string& name = head.parts[part];
        out.materials.push_back(name == "eye_right"          ? DEMO_RIGHT_EYE
                                : name.starts_with("eye")    ? DEMO_EYES
                                : name.starts_with("teeth")  ? DEMO_TEETH
                                : name.starts_with("tongue") ? DEMO_TONGUE
                                : name == "cut"              ? DEMO_CUT
                                                             : DEMO_SKIN);
    }
    out.looks.resize(6);
    out.looks[DEMO_SKIN - 1].albedo = {0.76f, 0.54f, 0.44f};
    out.looks[DEMO_EYES - 1].kind = out.looks[DEMO_RIGHT_EYE - 1].kind = sample::Look::Kind::Eye;
    // Behind closed lips hardly any light comes: a fifth of teeth's and tongue's own albedo.
    out.looks[DEMO_TEETH - 1] = {sample::Look::Kind::Plain, {0.15f, 0.14f, 0.12f}};
    out.looks[DEMO_TONGUE - 1] = {sample::Look::Kind::Plain, {0.11f, 0.045f, 0.04f}};
    out.looks[DEMO_CUT - 1] = {sample::Look::Kind::Plain, {0.02f, 0.02f, 0.02f}};

    const Bounds skin = boundsOfPart(head, "skin");
    const Bounds eyes[2] = {boundsOfPart(head, "eye_left"), boundsOfPart(head, "eye_right")};
    Bounds mouth = boundsOfPart(head, "teeth_upper");
    const Bounds lower = boundsOfPart(head, "teeth_lower");
    for (int i = 0; i < 8 && !lower.empty(); ++i) mouth.add(lower.corner(i));
    for (const Bounds& ball : eyes) {
        if (ball.empty()) continue;
        sample::EyeLook eye;
        eye.radius = 0.5 * (ball.high.y - ball.low.y);
        // The cornea bulges: the ball's middle is behind that of its box.
        eye.centre = {ball.centre().x, ball.centre().y, ball.low.z + eye.radius};
        eye.irisRadius = 0.42 * eye.radius;
        eye.pupilRadius = 0.16 * eye.radius;
        out.eyes.push_back(eye);
        out.eyeModels.push_back(modelOf(eye, &ball == eyes ? DEMO_EYES : DEMO_RIGHT_EYE));
    }
    if (!eyes[0].empty() && !eyes[1].empty() && !mouth.empty()) out.tints = tintsOf(head, eyes, mouth, skin);
    out.frame = skin;
    out.mesh = std::move(head.mesh);
    out.cornerUvs = std::move(head.cornerUvs);
    return out;
}

}  // namespace pellucid::demo
