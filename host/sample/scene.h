// A mesh made ready for ray tracing. The sample renderer's only contact with Embree.
#pragma once
#include <cstdint>
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
    double distance = INFINITY;     // mm along the ray
    double weights[3] = {0, 0, 0};  // barycentric, of the triangle's corners in order; they sum to 1
};

class Scene {
  public:
    static constexpr int packetSize = 16;

    // Copies the mesh. Throws std::invalid_argument as checkMesh does, std::runtime_error when Embree fails.
    explicit Scene(const MeshView& mesh);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const Mesh& mesh() const { return mesh_; }
    const Bounds& bounds() const { return bounds_; }

    // First hits of up to packetSize rays. Embree finds the triangle in single precision, watertight; place
    // on the triangle and distance are then solved in double. May be called from several threads.
    void intersect(const Ray* rays, Hit* hits, int count) const;

    // The first hit of a single ray no further than `within`, and the unit normal of that triangle. All is in
    // Embree's single precision, for rays by the million. May be called from several threads.
    Hit firstHit(const Ray& ray, double within, Vec3& normal) const;

    // The point of the mesh next to `p`, no further than `within` away. Weights and distance as for rays. May
    // be called from several threads.
    Hit nearest(Vec3 p, double within = INFINITY) const;

  private:
    struct Device;
    void refine(const Ray& ray, Hit& hit) const;

    Mesh mesh_;
    Bounds bounds_;
    std::unique_ptr<Device> device_;
};

}  // namespace pellucid::sample
