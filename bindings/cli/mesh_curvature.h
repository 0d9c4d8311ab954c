// Curvature of a loaded mesh on the device, for `curvature`, `import` and `demo`; and its picture.
#pragma once
#include "command.h"
#include "io/mesh/mesh_file.h"

namespace pellucid::cli {

struct MeshCurvature {
    std::vector<float> values;  // per vertex, 1/length of the mesh's unit, times params.scale
    PelMeshReport report;
};

struct MeshWeldChoice {
    PelWeld weld = PEL_WELD_NONE;
    float tolerance = 0;  // in the mesh's unit of length, PEL_WELD_TOLERANCE only
};

// Throws InputError with the file's name if the library refuses the mesh.
MeshCurvature meshCurvature(Run& run, const io::MeshData& mesh, const PelCurvatureParams& params,
                            const MeshWeldChoice& weld = {});

// Writes a PNG of the mesh seen from the front and from a side, coloured by a value at its vertices, with a
// colour bar from `low` to `high`. `up` is 'y' or 'z'. Throws FileError when the file cannot be written.
void writeCurvaturePicture(const std::string& path, const io::MeshData& mesh,
                           const std::vector<float>& values, float low, float high, char up,
                           const std::string& unit);

// Adds the counts of the mesh to the report, and a warning for each thing that was skipped.
void reportMesh(Run& run, const PelMeshReport& report);

// The value that the given share (0 to 1) of the values does not exceed; 0 if there are none.
float percentile(std::vector<float> values, double share);

}  // namespace pellucid::cli
