// Replaces the commands and pictures that need the sample renderer, in a build without it.
#include "mesh_curvature.h"

namespace pellucid::cli {

void addReference(CLI::App&) {}
void addDemo(CLI::App&) {}
void addBench(CLI::App&) {}
void addTune(CLI::App&) {}

void writeCurvaturePicture(const std::string&, const io::MeshData&, const std::vector<float>&, float, float,
                           char, const std::string&) {
    throw UsageError(
        "--picture: this build has no renderer; build with Embree (PELLUCID_SAMPLE), or write values with -o "
        "and colour the mesh elsewhere");
}

}  // namespace pellucid::cli
