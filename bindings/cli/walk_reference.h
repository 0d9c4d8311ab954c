// The random walk of `pellucid reference --walk`: its options, the medium of a material, and what is measured
// on the mesh beside the light.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "command.h"
#include "io/mesh/mesh_file.h"
#include "sample/random_walk.h"

namespace pellucid::cli {

struct WalkArguments {
    bool enabled = false;
    uint32_t samples = 64;
    double noise = 0;
    uint64_t seed = 1;
    std::vector<double> reflectance;  // empty: that of the material
    std::string boundary = "index-matched";
};

void addWalkOptions(Command& command, WalkArguments& walk);

using RgbValues = std::array<double, 3>;

// The medium of a Burley profile; `scale`: unit of positions per unit of the profile. Throws InputError for
// other kinds of profile, of which no medium is known. `material` is for the message.
sample::Medium mediumOf(const WalkArguments& walk, const Profile& profile, double scale,
                        const RgbValues& reflectance, const std::string& material);

// Walks from `points`, with progress and an entry `media` in the report.
sample::WalkedLight walk(Run& run, const WalkArguments& walk, const sample::WalkBody& body,
                         const sample::Lighting& lighting, const std::vector<sample::SurfacePoint>& points,
                         const sample::Medium& medium, const RgbValues& reflectance,
                         const std::string& material);

// At each point: signed mean curvature (1/unit of positions), and the thickness of the body below.
std::vector<float> meanCurvatureAt(Run& run, const io::MeshData& mesh,
                                   const std::vector<sample::SurfacePoint>& points);
std::vector<float> thicknessAt(const sample::WalkBody& body, const std::vector<sample::SurfacePoint>& points);

}  // namespace pellucid::cli
