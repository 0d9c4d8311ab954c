// A mesh made ready for ray tracing. The sample renderer's only contact with Embree.
#pragma once
#include <functional>
#include <memory>

#include "sample/mesh.h"

namespace pellucid::sample {

struct Ray {
    Vec3 origin;
    Vec3 direction;  // unit
};

struct Hit {
    static constexpr uint32_t none = UINT32_MAX;
    uint32_t triangle = none;
    double distance = INFINITY;       // mm along the ray
    std::array<double, 3> weights{};  // barycentric, of the triangle's corners in order; they sum to 1
};

// Hairs: x, y, z and the radius of each point, mm, and the points at which a segment to the next one starts.
struct Curves {
    std::vector<float> points;
    std::vector<uint32_t> segments;
};

class Scene {
  public:
    // Copies the mesh. Throws std::invalid_argument as checkMesh does, std::runtime_error when Embree fails.
    explicit Scene(const MeshView& mesh);
    // For `occluded` only: all other queries need a mesh.
    explicit Scene(const Curves& curves);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const Mesh& mesh() const { return mesh_; }
    const Bounds& bounds() const { return bounds_; }

    // All queries may be called from several threads.

    // The first hit. Embree finds the triangle in single precision, watertight; the place on the triangle and
    // the distance are then solved in double precision.
    Hit intersect(const Ray& ray) const;
    // The same no further than `within`, and the unit normal of the triangle. All is in single precision, for
    // rays by the million.
    Hit firstHit(const Ray& ray, double within, Vec3& normal) const;
    // How far the mesh reaches below a place on it, against the unit normal there; infinite where it has no
    // other side. `otherSide`: the unit normal of the triangle there.
    double depthBelow(Vec3 position, Vec3 normal, Vec3& otherSide) const;
    // Whether anything is hit before `within`.
    bool occluded(const Ray& ray, double within) const;

    // The point of the mesh next to `p`, no further than `within` away. Weights and distance as for rays.
    Hit nearest(Vec3 p, double within = INFINITY) const;

  private:
    struct Device;
    void refine(const Ray& ray, Hit& hit) const;

    Mesh mesh_;
    Bounds bounds_;
    std::unique_ptr<Device> device_;
};

// Calls put(x, y, ray, hit) for each ray rayAt(x, y) of width x height that hits the mesh, rows on all cores.
void traceRays(const Scene& scene, int width, int height, const std::function<Ray(int, int)>& rayAt,
               const std::function<void(int, int, const Ray&, const Hit&)>& put);

}  // namespace pellucid::sample
