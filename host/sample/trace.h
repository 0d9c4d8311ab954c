// Rows of rays on all processor cores, for the pictures that this folder renders.
#pragma once
#include "sample/scene.h"

namespace pellucid::sample {

// Calls put(x, y, ray, hit) for each ray rayAt(x, y) of width x height that hits the mesh.
template <class RayAt, class Put>
void traceRays(const Scene& scene, int width, int height, const RayAt& rayAt, const Put& put) {
#pragma omp parallel for schedule(dynamic, 4)
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Ray ray = rayAt(x, y);
            const Hit hit = scene.intersect(ray);
            if (hit.triangle != Hit::none) put(x, y, ray, hit);
        }
}

}  // namespace pellucid::sample
