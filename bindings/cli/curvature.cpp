// pellucid curvature: curvature at each vertex of a mesh file.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "command.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image_file.h"
#include "io/mesh_file.h"
#include "mesh_curvature.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    Run::Options run;
    std::string mesh, output, estimator = "edge";
    PelCurvatureParams params = pelCurvatureParamsDefaults();
};

void run(const Arguments& a) {
    try {
        io::requireExtension(a.output, {"npy", "ply"});
        io::checkWritable(a.output);
    } catch (const io::FileError& e) {
        throw UsageError(e.what());
    }
    if (!(a.params.scale >= 0 && std::isfinite(a.params.scale)))
        throw UsageError("--scale " + std::to_string(a.params.scale) +
                         ": a finite number from 0 on is needed");
    Run run(a.run);
    io::MeshData mesh = io::loadMesh(a.mesh);
    for (const std::string& warning : mesh.warnings) run.warn(warning);
    if (mesh.normals.empty()) {
        io::computeNormals(mesh);
        run.note("no normals in " + a.mesh + ": they were made from its triangles");
    }
    const MeshCurvature result = meshCurvature(run, mesh, a.params);
    if (io::extensionOf(a.output) == "npy") {
        const size_t shape[] = {result.values.size()};
        io::writeNpy(a.output, shape, result.values);
    } else {
        io::writePly(a.output, mesh, result.values, 0.0f, percentile(result.values, 0.98));
    }
    run.report["output"] = a.output;
    reportMesh(run, result.report);
    const auto [least, most] = std::minmax_element(result.values.begin(), result.values.end());
    run.report["curvature_min"] = *least;
    run.report["curvature_median"] = percentile(result.values, 0.5);
    run.report["curvature_max"] = *most;
    run.finish();
}

}  // namespace

void addCurvature(CLI::App& app) {
    CLI::App* command = app.add_subcommand("curvature", "Curvature at each vertex of a mesh");
    auto a = std::make_shared<Arguments>();
    command->add_option("mesh", a->mesh, "OFF, OBJ, PLY or STL file")->required();
    command
        ->add_option("-o,--output", a->output,
                     "file to write: .npy (one float32 per vertex) or .ply (with colours)")
        ->required();
    command->add_option("--estimator", a->estimator, "how curvature is estimated")
        ->check(CLI::IsMember({"edge"}))
        ->capture_default_str();
    command->add_option("--smooth", a->params.smoothingPasses, "smoothing passes")
        ->capture_default_str()
        ->check(CLI::Range(0, 1000));
    command->add_option("--scale", a->params.scale, "multiplies the result")->capture_default_str();
    addRunOptions(*command, a->run);
    command->callback([a] { run(*a); });
}

}  // namespace pellucid::cli
