// pellucid curvature: curvature at each vertex of a mesh file.

#include "io/atomic_file.h"
#include "io/choice_keys.h"
#include "io/image/image_file.h"
#include "mesh_curvature.h"

namespace pellucid::cli {
namespace {

struct CurvatureArguments {
    Run::Options run;
    std::string mesh, output, picture, weld = "none", up = "z", estimator = "quadric", quantity = "absolute",
                                       smoothingWeights = "cotangent";
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    double creaseDegrees = 0;
    bool orient = false;
    std::vector<float> range;  // of colours: low, high; empty: from the values
};

MeshWeldChoice weldChoice(const std::string& text) {
    if (text == "none") return {PEL_WELD_NONE, 0};
    if (text == "exact") return {PEL_WELD_EXACT, 0};
    float tolerance = 0;
    if (!readNumber(text, tolerance) || !(tolerance > 0 && std::isfinite(tolerance)))
        throw UsageError("--weld " + text + ": none, exact, or a tolerance above 0 (a length) is needed");
    return {PEL_WELD_TOLERANCE, tolerance};
}

void runCurvature(const CurvatureArguments& a) {
    checkOutput(a.output, {"npy", "ply"}, {a.mesh});
    if (!a.picture.empty()) checkOutput(a.picture, {"png"});
    if (!(a.params.scale >= 0 && std::isfinite(a.params.scale)))
        throw UsageError(io::concat("--scale ", a.params.scale, ": a finite number from 0 on is needed"));
    if (a.estimator == "edge" && a.quantity != "absolute")
        throw UsageError(
            "--quantity: the edge estimator measures `absolute` only; take --estimator tensor or quadric");
    if (!a.range.empty() && !(a.range[0] < a.range[1] && std::isfinite(a.range[1] - a.range[0])))
        throw UsageError(io::concat("--range ", a.range[0], " ", a.range[1],
                                    ": two finite numbers are needed, the lower one first"));
    if (!a.range.empty() && a.picture.empty() && io::extensionOf(a.output) != "ply")
        throw UsageError("--range: only --picture and a .ply have colours");
    const MeshWeldChoice weld = weldChoice(a.weld);
    PelCurvatureParams params = a.params;
    params.estimator = chosen<PelCurvatureEstimator>(io::estimators, a.estimator);
    params.quantity = chosen<PelCurvatureQuantity>(io::quantities, a.quantity);
    params.smoothingWeights = chosen<PelSmoothingWeights>(io::smoothingWeights, a.smoothingWeights);
    params.smoothingCrease = float(a.creaseDegrees * 3.14159265358979 / 180);
    Run run(a.run);
    io::MeshLoadOptions load;
    load.orient = a.orient;
    io::MeshData mesh = io::loadMesh(a.mesh, load);
    for (const std::string& warning : mesh.warnings) run.warn(warning);
    if (a.orient) run.report["triangles_turned"] = mesh.trianglesTurned;
    if (mesh.normals.empty()) {
        io::computeNormals(mesh);
        run.note("no normals in " + a.mesh + ": they were made from its triangles");
    }
    const MeshCurvature result = meshCurvature(run, mesh, params, weld);
    reportMesh(run, result.report);
    // `share`: of the values beyond either end of the colours.
    const auto scale = [&](double share) -> std::pair<float, float> {
        if (!a.range.empty()) return {a.range[0], a.range[1]};
        const bool isSigned = params.quantity >= PEL_QUANTITY_MEAN;
        return {isSigned ? percentile(result.values, share) : 0.0f, percentile(result.values, 1 - share)};
    };
    if (io::extensionOf(a.output) == "npy") {
        const size_t shape[] = {result.values.size()};
        io::writeNpy(a.output, shape, result.values);
    } else {
        const auto [low, high] = scale(0.02);
        io::writePly(a.output, mesh, result.values, low, high);
    }
    if (!a.picture.empty()) {
        const bool squared = params.quantity == PEL_QUANTITY_GAUSSIAN;
        // With the few sharpest vertices in the range, all others would have nearly the same colour.
        const auto [low, high] = scale(0.1);
        writeCurvaturePicture(a.picture, mesh, result.values, low, high, a.up[0],
                              squared ? "1/length^2" : "1/length");
        run.report["picture"] = a.picture;
    }
    run.report["output"] = a.output;
    const auto [least, most] = std::minmax_element(result.values.begin(), result.values.end());
    run.report["curvature_min"] = *least;
    run.report["curvature_median"] = percentile(result.values, 0.5);
    run.report["curvature_max"] = *most;
    run.finish();
}

}  // namespace

void addCurvature(CLI::App& app) {
    auto [command, a] =
        subcommand<CurvatureArguments>(app, "curvature", "Curvature at each vertex of a mesh", runCurvature);
    option(command, "mesh", a.mesh, "OFF, OBJ, PLY or STL file", required);
    option(command, "-o,--output", a.output,
           "file to write: .npy (one float32 per vertex) or .ply (with colours)", required);
    option(command, "--estimator", a.estimator, "how curvature is estimated", isOneOf(io::estimators), shown);
    option(command, "--quantity", a.quantity, "which curvature is written", isOneOf(io::quantities), shown);
    option(command, "--weld", a.weld, "merges vertices at the same position: none, exact, or within a length",
           Word{"none|exact|LENGTH"}, shown);
    option(command, "--orient", a.orient, "flips triangles whose orientation differs from their neighbours'");
    CLI::Option* radius =
        option(command, "--smooth-radius", a.params.smoothingRadius,
               "smooths to a radius in the mesh's unit of length, whatever its density", isNotNegative());
    option(command, "--smooth-crease", a.creaseDegrees,
           "with --smooth-radius: degrees between normals that stop it", inRange(0.0, 180.0), Needs{radius});
    option(command, "--smooth-weights", a.smoothingWeights,
           "with --smooth-radius: how neighbours are weighted", isOneOf(io::smoothingWeights), shown,
           Needs{radius});
    option(command, "--picture", a.picture,
           "PNG to write as well: the mesh coloured by the values, with a colour bar");
    option(command, "--range", a.range,
           "LOW HIGH: the values at the ends of the colour scale of --picture and of a .ply, the same for "
           "several meshes to compare; default: from the values, without the highest",
           Count{2});
    option(command, "--up", a.up,
           "of the picture: the mesh's up axis, z (it looks to -y) or y (it looks to +z)",
           isOneOf({"y", "z"}), shown);
    option(command, "--smooth", a.params.smoothingPasses, "smoothing passes", shown, inRange(0, 1000));
    option(command, "--scale", a.params.scale, "multiplies the result", shown);
    addRunOptions(command, a.run);
}

}  // namespace pellucid::cli
