#include "demo/demo_head.h"

#include <algorithm>
#include <filesystem>
#include <numbers>

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

// The height at which the lips meet: just below the edge of the upper teeth.
double lipLineOf(const Bounds& upperTeeth) {
    return upperTeeth.low.y - 1.5;
}

// Deepens the nostril near `p`, which is shallow in the mesh, upwards, and returns a dark zone for it.
sample::SkinZone deepNostril(io::MeshData& mesh, Vec3 p, double eyeDistance) {
    // The roof: what faces down and lies highest.
    std::vector<Vec3> roof;
    double highest = -INFINITY;
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const Vec3 at = positionOf(mesh, v);
        if (mesh.normals[3 * v + 1] > -0.7f || length(at - p) > 0.13 * eyeDistance) continue;
        roof.push_back(at);
        highest = std::max(highest, at.y);
    }
    std::erase_if(roof, [&](Vec3 at) { return at.y < highest - 0.03 * eyeDistance; });
    sample::SkinZone zone{
        roof.empty() ? p : Vec3{}, Vec3{0.09, 0.08, 0.12} * eyeDistance, {0.1, 0.06, 0.055}, 0.6, 0.1};
    for (const Vec3 at : roof) zone.centre = zone.centre + at * (1.0 / double(roof.size()));
    const Vec3 way{0, 0.8 * zone.radii.y, -0.3 * zone.radii.z};
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const double weight = zone.weight(positionOf(mesh, v));
        mesh.positions[3 * v + 1] += float(weight * way.y);
        mesh.positions[3 * v + 2] += float(weight * way.z);
    }
    zone.centre = zone.centre + way * 0.2;
    return zone;
}

// Skin is redder where it is thin: lips, lids, cheeks, nose, ears. Forehead, nose and chin are oily; lips are
// moist and have no pores. Places and sizes follow the distance between the eyes, the lips and the outline;
// the strength is chosen by eye.
std::vector<sample::SkinZone> zonesOf(io::PartedMesh& head, const Bounds (&eyes)[2], double lipLine,
                                      const Bounds& skin) {
    const Vec3 left = eyes[0].centre(), right = eyes[1].centre();
    const double e = std::abs(left.x - right.x);
    const double noseTip = 0.5 * (left.y + lipLine);
    std::vector<sample::SkinZone> zones;
    const auto add = [&](double x, double y, Vec3 radii, LinearColor color, double edge, double specular = 1,
                         double roughness = 1, double relief = 1) {
        Vec3 centre = foremost(head.mesh, x, y, 0.08 * e);
        centre.z -= 0.3 * radii.z * e;
        zones.push_back({centre, radii * e, color, edge, specular, roughness, relief});
    };
    add(0, lipLine - 0.005 * e, {0.39, 0.165, 0.9}, {0.86, 0.56, 0.58}, 0.25, 4, 0.42, 0.3);
    zones.back().furrows = 0.09;
    const Vec3 nose = foremost(head.mesh, 0, noseTip, 0.08 * e);
    for (const double side : {-1.0, 1.0}) {
        add(side * 0.5 * e, left.y, {0.33, 0.2, 0.4}, {0.97, 0.84, 0.83}, 1);
        // Cheeks, from beside the nose along the cheekbone: two that overlap have no round outline.
        add(side * 0.5 * e, left.y - 0.6 * e, {0.4, 0.36, 0.7}, {1.01, 0.91, 0.91}, 1, 1, 1, 1.5);
        add(side * 0.78 * e, left.y - 0.52 * e, {0.62, 0.36, 0.9}, {1.01, 0.87, 0.87}, 1, 1, 1, 1.5);
        const double x = side > 0 ? skin.high.x : skin.low.x;
        zones.push_back({{x, left.y - 0.25 * e, skin.centre().z - 0.1 * e},
                         Vec3{0.35, 0.75, 0.6} * e,
                         {1.02, 0.76, 0.74},
                         1,
                         0.5});
        add(side * 0.37 * e, lipLine, {0.16, 0.12, 0.5}, {0.93, 0.84, 0.82}, 1);  // the mouth's corner
        zones.push_back(deepNostril(head.mesh, {side * 0.165 * e, noseTip - 0.1 * e, nose.z - 0.23 * e}, e));
        add(side * 0.2 * e, noseTip, {0.16, 0.2, 0.4}, {1.01, 0.88, 0.88}, 1);  // the nose's wing
    }
    add(0, noseTip, {0.26, 0.26, 0.5}, {1.02, 0.85, 0.85}, 1);
    add(0, noseTip + 0.3 * e, {0.35, 0.8, 0.9}, {1, 1, 1}, 1, 1.8, 0.75, 2.5);
    // A forehead is yellower than the rest, the beard's region bluer.
    add(0, left.y + 0.9 * e, {1.3, 0.8, 1.2}, {1, 0.985, 0.90}, 1, 1.6, 0.8, 1.7);
    add(0, lipLine - 0.15 * e, {0.75, 0.75, 1}, {0.94, 0.955, 0.99}, 1);
    add(0, lipLine - 0.45 * e, {0.4, 0.3, 0.6}, {1, 0.97, 0.98}, 1, 1.5, 0.85);
    // Brows: an arc over each eye, darkest in the middle, of spots that overlap.
    constexpr int spots = 9;
    for (const double side : {-1.0, 1.0})
        for (int i = 0; i < spots; ++i) {
            const double s = double(i) / (spots - 1), along = -0.25 + 0.6 * s;
            const double x = side * (0.5 * e + along * e), y = left.y + (0.30 + 0.10 * std::sin(2.4 * s)) * e;
            const double strength = 0.7 + 0.12 * s;
            add(x, y, {0.09, 0.08 - 0.03 * s, 0.3}, {strength, 0.93 * strength, 0.9 * strength}, 0.9);
        }
    return zones;
}

// Closes the small gap between the lips by moving their surface outwards. The teeth would reach into the
// lips, so they are moved back and in, where the mouth shades them.
void closeMouth(io::PartedMesh& head, double lipLine, double eyeDistance) {
    constexpr float back = 6;    // mm
    constexpr double swell = 1;  // mm
    const double e = eyeDistance;
    const double z = foremost(head.mesh, 0, lipLine, 0.08 * e).z - 0.25 * e;
    const auto place = [&](double x, double width, double height, double depth) {
        return sample::SkinZone{
            .centre = {x * e, lipLine, z}, .radii = Vec3{width, height, depth} * e, .edge = 0.6};
    };
    // The corners gape most.
    const sample::SkinZone parts[] = {place(0, 0.45, 0.09, 0.4), place(0.35, 0.13, 0.09, 0.25),
                                      place(-0.35, 0.13, 0.09, 0.25)};
    std::vector<bool> moved(head.mesh.vertexCount());
    for (size_t c = 0; c < head.mesh.triangles.size(); ++c) {
        const std::string& name = head.parts[head.partOf[c / 3]];
        const uint32_t v = head.mesh.triangles[c];
        if (moved[v]) continue;
        moved[v] = true;
        float* p = &head.mesh.positions[3 * v];
        if (name.starts_with("teeth") || name.starts_with("tongue")) p[2] -= back;
        if (name != "skin") continue;
        double weight = 0;
        for (const sample::SkinZone& part : parts)
            weight += (&part == parts ? 1 : 1.5) * part.weight(positionOf(head.mesh, v));
        p[1] += float(swell * weight) * head.mesh.normals[3 * v + 1];
    }
}

// Where the lids meet on the side `side` of x: the place of the ball nearest to that side where a small disk
// fits between them, seen from the front.
Vec3 cornerOf(const io::PartedMesh& head, const sample::EyeLook& eye, double side) {
    const auto skin = uint32_t(head.part("skin"));
    std::vector<Vec3> lids, ball;
    for (size_t c = 0; c < head.mesh.triangles.size(); ++c) {
        const Vec3 p = positionOf(head.mesh, head.mesh.triangles[c]) - eye.centre;
        if (p.z > 0.4 * eye.radius && length(p) < 2 * eye.radius)
            (head.partOf[c / 3] == skin ? lids : ball).push_back(p);
    }
    Vec3 corner;
    for (const Vec3 at : ball)
        if (side * at.x > side * corner.x && std::ranges::none_of(lids, [&](Vec3 p) {
                return std::hypot(p.x - at.x, p.y - at.y) < 0.065 * eye.radius;
            }))
            corner = at;
    return eye.centre + corner;
}

void addEllipsoid(io::PartedMesh& head, uint32_t part, Vec3 centre, Vec3 radii) {
    const sample::Mesh ball = sample::makeSphere(1, 16, 24);
    for (const uint32_t v : ball.triangles) head.mesh.triangles.push_back(head.mesh.vertexCount() + v);
    for (size_t v = 0; v < ball.positions.size(); v += 3) {
        const Vec3 n{ball.positions[v], ball.positions[v + 1], ball.positions[v + 2]};
        const auto add = [](std::vector<float>& to, Vec3 p) {
            to.insert(to.end(), {float(p.x), float(p.y), float(p.z)});
        };
        add(head.mesh.positions, centre + Vec3{n.x * radii.x, n.y * radii.y, n.z * radii.z});
        add(head.mesh.normals, normalize(Vec3{n.x / radii.x, n.y / radii.y, n.z / radii.z}));
    }
    head.partOf.resize(head.mesh.triangles.size() / 3, part);
    if (!head.cornerUvs.empty()) head.cornerUvs.resize(2 * head.mesh.triangles.size());
}

// Fills the gaps between ball and lids: beside the nose with the caruncle, a pink and moist bump, and at the
// outer corner by extending the ball, which is rounder than a real sclera.
void fillCorners(io::PartedMesh& head, const sample::EyeLook& eye, uint32_t ball,
                 std::vector<sample::SkinZone>& zones) {
    const double toNose = eye.centre.x > 0 ? -1 : 1;
    const Vec3 caruncle = Vec3{0.21, 0.13, 0.1} * eye.radius, white = Vec3{0.2, 0.25, 0.2} * eye.radius;
    const Vec3 inner = cornerOf(head, eye, toNose) + Vec3{0.4 * caruncle.x * toNose, 0, -0.5 * caruncle.z},
               outer = cornerOf(head, eye, -toNose) + Vec3{-0.01 * eye.radius * toNose, 0, -1.02 * white.z};
    addEllipsoid(head, ball, outer, white);
    addEllipsoid(head, uint32_t(head.part("skin")), inner, caruncle);
    zones.push_back({inner, caruncle * 1.3, {1.08, 0.74, 0.72}, 0.4, 2.5, 0.5, 0.5});
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
    eye.limbusWidth *= 1.3f, eye.limbusDarkening = 0.5f;  // a soft border
    return model;
}

}  // namespace

DemoHead bustOf(DemoHead head) {
    head.bust = true;
    head.looks.clear(), head.zones.clear(), head.eyes.clear();
    head.eyeModels.clear(), head.strands.clear();
    return head;
}

double Scalp::above(Vec3 p) const {
    // The hairline's height over the eyes, by the angle from the front in degrees: forehead, temple,
    // sideburn, ear, nape.
    constexpr double line[][2] = {{0, 1.28},  {22, 1.32},  {38, 1.38},  {45, 1.27},  {50, 0.95},  {54, 0.7},
                                  {57, 0.45}, {59, 0.1},   {62, -0.18}, {67, -0.24}, {80, -0.24}, {86, -0.1},
                                  {108, 0.0}, {120, -0.5}, {140, -0.9}, {181, -0.95}};
    constexpr double degree = 0.02;  // on the skin, over the distance between the eyes
    const Vec3 middle = skin.centre();
    const Vec3 toEar = p - Vec3{std::copysign(skin.high.x, p.x), betweenEyes.y - 0.28 * eyeDistance,
                                middle.z - 0.1 * eyeDistance};
    const Vec3 ear = Vec3{0.27, 0.44, toEar.z > 0 ? 0.2 : 0.44} * eyeDistance;  // radii
    if (std::hypot(toEar.x / ear.x, toEar.y / ear.y, toEar.z / ear.z) < 1) return -1;
    const double ragged = 0.04 * (std::sin(0.32 * p.y + 0.2 * p.z) + std::sin(0.6 * p.z - 0.4 * p.y));
    const double x = degree * std::atan2(std::abs(p.x), p.z - middle.z) * 180 / std::numbers::pi,
                 y = (p.y - betweenEyes.y) / eyeDistance + ragged;
    double nearest = INFINITY;
    bool over = false;
    for (size_t i = 1; i < std::size(line); ++i) {
        const double fromX = x - degree * line[i - 1][0], fromY = y - line[i - 1][1],
                     toX = degree * (line[i][0] - line[i - 1][0]), toY = line[i][1] - line[i - 1][1];
        const double t = std::clamp((fromX * toX + fromY * toY) / (toX * toX + toY * toY), 0.0, 1.0);
        nearest = std::min(nearest, std::hypot(fromX - t * toX, fromY - t * toY));
        if (fromX >= 0 && fromX < toX) over = fromY * toX > fromX * toY;
    }
    return over ? nearest : -nearest;
}

double Scalp::cover(Vec3 p) const {
    constexpr double fade = 0.2;  // the hairline is thin and ragged
    return std::clamp(above(p) / fade, 0.0, 1.0);
}

bool hasHeadParts(const std::string& path) {
    if (std::filesystem::path(path).extension() != ".obj") return false;
    return io::loadParts(path, 0).part("skin") >= 0;
}

DemoHead loadDemoHead(const std::string& path, int levels) {
    io::PartedMesh head = io::loadParts(path, levels);
    const Bounds eyes[2] = {boundsOfPart(head, "eye_left"), boundsOfPart(head, "eye_right")};
    const Bounds upperTeeth = boundsOfPart(head, "teeth_upper");
    const bool hasFace = !eyes[0].empty() && !eyes[1].empty() && !upperTeeth.empty();
    if (hasFace) closeMouth(head, lipLineOf(upperTeeth), length(eyes[0].centre() - eyes[1].centre()));
    // A straight cut in place of the ragged end of the data.
    const Bounds whole = boundsOfPart(head, "skin");
    const float cut = float(whole.low.y + 0.13 * (whole.high.y - whole.low.y));
    io::cutAndClose(head, "skin", {0, 0.976f, 0.22f}, 0.976f * cut, "cut");
    DemoHead out;
    out.pose = {{0, 1, 0}, {0, 0, 1}};
    out.looks.resize(DEMO_LASHES);
    out.looks[DEMO_SKIN - 1].albedo = {0.72f, 0.50f, 0.40f};
    out.looks[DEMO_EYES - 1].kind = out.looks[DEMO_RIGHT_EYE - 1].kind = sample::Look::Kind::Eye;
    // Hardly any light gets behind closed lips: teeth and tongue have a fifth of their albedo.
    out.looks[DEMO_TEETH - 1] = {sample::Look::Kind::Plain, {0.15f, 0.14f, 0.12f}};
    out.looks[DEMO_TONGUE - 1] = {sample::Look::Kind::Plain, {0.11f, 0.045f, 0.04f}};
    out.looks[DEMO_CUT - 1] = {sample::Look::Kind::Plain, {0.02f, 0.02f, 0.02f}};

    const Bounds skin = boundsOfPart(head, "skin");
    if (hasFace) out.zones = zonesOf(head, eyes, lipLineOf(upperTeeth), skin);
    for (const Bounds& ball : eyes) {
        if (ball.empty()) continue;
        sample::EyeLook eye;
        eye.radius = 0.5 * (ball.high.y - ball.low.y);
        // The cornea bulges: the ball's middle is behind that of its box.
        eye.centre = {ball.centre().x, ball.centre().y, ball.low.z + eye.radius};
        out.eyes.push_back(eye);
        out.eyeModels.push_back(modelOf(eye, &ball == eyes ? DEMO_EYES : DEMO_RIGHT_EYE));
        fillCorners(head, eye, uint32_t(head.part(&ball == eyes ? "eye_left" : "eye_right")), out.zones);
    }
    for (const uint32_t part : head.partOf) {
        const std::string& name = head.parts[part];
        out.materials.push_back(name == "eye_right"          ? DEMO_RIGHT_EYE
                                : name.starts_with("eye")    ? DEMO_EYES
                                : name.starts_with("teeth")  ? DEMO_TEETH
                                : name.starts_with("tongue") ? DEMO_TONGUE
                                : name == "cut"              ? DEMO_CUT
                                                             : DEMO_SKIN);
    }
    if (out.eyes.size() == 2) {
        const Vec3 left = out.eyes[0].centre, right = out.eyes[1].centre;
        out.scalp = {(left + right) * 0.5, length(left - right), skin};
    }
    out.frame = skin;
    out.mesh = std::move(head.mesh);
    out.cornerUvs = std::move(head.cornerUvs);
    return out;
}

}  // namespace pellucid::demo
