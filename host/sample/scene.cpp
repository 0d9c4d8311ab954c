#include "sample/scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <stdexcept>
#include <string>

namespace pellucid::sample {

struct Scene::Device {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Device() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    void build(RTCGeometryType type, RTCFormat point, std::span<const float> points, RTCFormat primitive,
               std::span<const uint32_t> indices);
};

namespace {

[[noreturn]] void fail(RTCDevice device, const char* doing) {
    throw std::runtime_error(std::string("Embree failed while ") + doing + ", error code " +
                             std::to_string(int(rtcGetDeviceError(device))));
}

Mesh copyOf(const MeshView& view) {
    checkMesh(view);
    const auto copy = [](auto span) { return std::vector(span.begin(), span.end()); };
    return {copy(view.positions), copy(view.normals),   copy(view.uvs),
            copy(view.curvature), copy(view.triangles), copy(view.materials)};
}

RTCRay rayOf(const Ray& ray, double within) {
    RTCRay r{};
    r.org_x = float(ray.origin.x), r.org_y = float(ray.origin.y), r.org_z = float(ray.origin.z);
    r.dir_x = float(ray.direction.x), r.dir_y = float(ray.direction.y), r.dir_z = float(ray.direction.z);
    r.tfar = float(within);
    r.mask = ~0u;
    return r;
}

// Barycentric weights of the point of a triangle next to p.
void nearestOfTriangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c, std::array<double, 3>& weights) {
    const Vec3 edges[3] = {b - a, c - b, a - c}, corners[3] = {a, b, c}, normal = cross(b - a, c - a);
    const double area2 = dot(normal, normal);
    double best = INFINITY;
    if (area2 > 0) {
        const double u = dot(cross(c - b, p - b), normal) / area2,
                     v = dot(cross(a - c, p - c), normal) / area2, w = 1 - u - v;
        if (u >= 0 && v >= 0 && w >= 0) {
            weights[0] = u, weights[1] = v, weights[2] = w;
            return;
        }
    }
    for (int k = 0; k < 3; ++k) {
        const double along2 = dot(edges[k], edges[k]);
        const double t = along2 > 0 ? std::clamp(dot(p - corners[k], edges[k]) / along2, 0.0, 1.0) : 0;
        const Vec3 d = corners[k] + edges[k] * t - p;
        if (dot(d, d) >= best) continue;
        best = dot(d, d);
        weights[k] = 1 - t, weights[(k + 1) % 3] = t, weights[(k + 2) % 3] = 0;
    }
}

struct NearestQuery {
    const Mesh* mesh;
    Vec3 p;
    Hit* best;
};

bool visitTriangle(RTCPointQueryFunctionArguments* arguments) {
    auto& query = *static_cast<NearestQuery*>(arguments->userPtr);
    const auto [a, b, c] = query.mesh->corners(arguments->primID);
    Hit hit;
    nearestOfTriangle(query.p, a, b, c, hit.weights);
    hit.triangle = arguments->primID;
    hit.distance = length(a * hit.weights[0] + b * hit.weights[1] + c * hit.weights[2] - query.p);
    // Of equally near points, takes that of the first triangle, whatever the order of the walk.
    if (hit.distance > query.best->distance ||
        (hit.distance == query.best->distance && hit.triangle > query.best->triangle))
        return false;
    *query.best = hit;
    arguments->query->radius = std::nextafter(float(hit.distance), INFINITY);
    return true;
}

}  // namespace

void Scene::Device::build(RTCGeometryType type, RTCFormat point, std::span<const float> points,
                          RTCFormat primitive, std::span<const uint32_t> indices) {
    // One thread builds the tree, so that it is always the same: it decides which triangle of an edge is hit.
    device = rtcNewDevice("threads=1");
    if (!device) fail(nullptr, "starting");
    scene = rtcNewScene(device);
    if (!scene) fail(device, "making a scene");
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    const size_t floats = point == RTC_FORMAT_FLOAT3 ? 3 : 4,
                 perPrimitive = primitive == RTC_FORMAT_UINT3 ? 3 : 1;
    if (!indices.empty()) {
        RTCGeometry geometry = rtcNewGeometry(device, type);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, point, 4 * floats,
                                                 points.size() / floats);
        void* corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, primitive,
                                                4 * perPrimitive, indices.size() / perPrimitive);
        if (vertices && corners) {
            std::ranges::copy(points, static_cast<float*>(vertices));
            std::ranges::copy(indices, static_cast<uint32_t*>(corners));
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
        }
        rtcReleaseGeometry(geometry);
        if (!vertices || !corners) fail(device, "copying the mesh");
    }
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) fail(device, "building the scene");
}

Scene::Scene(const MeshView& view)
    : mesh_(copyOf(view)), bounds_(boundsOf(mesh_.view())), device_(std::make_unique<Device>()) {
    device_->build(RTC_GEOMETRY_TYPE_TRIANGLE, RTC_FORMAT_FLOAT3, mesh_.positions, RTC_FORMAT_UINT3,
                   mesh_.triangles);
}

Scene::Scene(const Curves& curves) : device_(std::make_unique<Device>()) {
    device_->build(RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE, RTC_FORMAT_FLOAT4, curves.points, RTC_FORMAT_UINT,
                   curves.segments);
}

Scene::~Scene() = default;

Hit Scene::firstHit(const Ray& ray, double within, Vec3& normal) const {
    RTCRayHit query{rayOf(ray, within), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(device_->scene, &context, &query);
    Hit hit;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.triangle = query.hit.primID;
    hit.distance = query.ray.tfar;
    hit.weights[1] = query.hit.u;
    hit.weights[2] = query.hit.v;
    hit.weights[0] = std::max(0.0, 1 - hit.weights[1] - hit.weights[2]);
    normal = normalize(Vec3{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z});
    return hit;
}

double Scene::depthBelow(Vec3 position, Vec3 normal, Vec3& otherSide) const {
    const double extent = length(bounds_.high - bounds_.low), start = 1e-6 * extent;
    return firstHit({position - normal * start, -normal}, extent, otherSide).distance + start;
}

Hit Scene::intersect(const Ray& ray) const {
    Vec3 normal;
    Hit hit = firstHit(ray, INFINITY, normal);
    if (hit.triangle != Hit::none) refine(ray, hit);
    return hit;
}

bool Scene::occluded(const Ray& ray, double within) const {
    RTCRay query = rayOf(ray, within);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(device_->scene, &context, &query);
    return query.tfar < 0;
}

Hit Scene::nearest(Vec3 p, double within) const {
    Hit hit;
    hit.distance = within;
    NearestQuery own{&mesh_, p, &hit};
    RTCPointQuery query{};
    query.x = float(p.x), query.y = float(p.y), query.z = float(p.z);
    query.radius = float(within);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(device_->scene, &query, &context, visitTriangle, &own);
    return hit;
}

void Scene::refine(const Ray& ray, Hit& hit) const {
    const auto [a, b, c] = mesh_.corners(hit.triangle);
    const Vec3 ab = b - a, ac = c - a, across = cross(ray.direction, ac);
    const double determinant = dot(ab, across);
    // A triangle seen edge-on keeps Embree's result.
    if (std::abs(determinant) > 1e-9 * length(ab) * length(ac)) {
        const Vec3 s = ray.origin - a, q = cross(s, ab);
        hit.weights[1] = dot(s, across) / determinant;
        hit.weights[2] = dot(ray.direction, q) / determinant;
        hit.distance = dot(ac, q) / determinant;
    }
    // A ray that Embree counts as a hit at an edge may pass just outside of the triangle.
    hit.weights[1] = std::clamp(hit.weights[1], 0.0, 1.0);
    hit.weights[2] = std::clamp(hit.weights[2], 0.0, 1 - hit.weights[1]);
    hit.weights[0] = 1 - hit.weights[1] - hit.weights[2];
}

void traceRays(const Scene& scene, int width, int height, const std::function<Ray(int, int)>& rayAt,
               const std::function<void(int, int, const Ray&, const Hit&)>& put) {
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Ray ray = rayAt(x, y);
            const Hit hit = scene.intersect(ray);
            if (hit.triangle != Hit::none) put(x, y, ray, hit);
        }
}

}  // namespace pellucid::sample
