#include "walk_reference.h"

#include <cmath>

#include "mesh_curvature.h"

namespace pellucid::cli {

void addWalkOptions(Command& command, WalkArguments& walk) {
    Option* enabled = command.addFlag(
        "--walk", walk.enabled,
        "trace light through the volume (random walk) instead of integrating the profile over the "
        "surface; writes two independent halves, First and Second");
    Option* samples = command.addOption("--samples", walk.samples, "walks per pixel, channel and half")
                          ->check(inRange(1, int(sample::maxWalkSamples)))
                          ->showDefault()
                          ->needs(enabled);
    command
        .addOption("--noise", walk.noise,
                   "instead of --samples: the standard error that a pixel shall have, such as 2e-3")
        ->check(isPositive())
        ->excludes(samples)
        ->needs(enabled);
    command.addOption("--seed", walk.seed, "of the random numbers; the same seed gives the same result")
        ->showDefault()
        ->needs(enabled);
    command
        .addOption("--reflectance", walk.reflectance,
                   "share of light that a large plane of the medium reflects, per channel (default: the mean "
                   "albedo of the material's pixels, or the albedo of the material)")
        ->expected(3)
        ->check(inRange(0.0, 1.0))
        ->needs(enabled);
    command
        .addOption("--boundary", walk.boundary,
                   "index-matched, or fresnel: a smooth surface of a refractive index of 1.4")
        ->check(isOneOf({"index-matched", "fresnel"}))
        ->showDefault()
        ->needs(enabled);
}

sample::Medium mediumOf(const WalkArguments& walk, const Profile& profile, double scale,
                        const RgbValues& reflectance, const std::string& material) {
    const PelProfileInfo info = profile.info();
    if (info.kind != PEL_PROFILE_BURLEY)
        throw InputError(
            "the profile '" + std::string(info.name) + "' of " + material +
            " has no known medium; a random walk needs one of kind burley, such as --profile with a "
            "file of that kind");
    RgbValues lengths;
    // The line spread of Burley's profile of length d has a standard deviation of sqrt(7) d.
    for (int c = 0; c < 3; ++c) lengths[c] = scale * info.width[c] / std::sqrt(7.0);
    return burleyMedium(
        lengths, reflectance,
        walk.boundary == "fresnel" ? sample::Boundary::Fresnel : sample::Boundary::IndexMatched);
}

sample::WalkedLight walk(Run& run, const WalkArguments& walk, const sample::WalkBody& body,
                         const sample::Lighting& lighting, const std::vector<sample::SurfacePoint>& points,
                         const sample::Medium& medium, const RgbValues& reflectance,
                         const std::string& material) {
    sample::WalkOptions options{walk.samples, walk.noise, walk.seed,
                                [&](double part) { run.progress(part, "random walk"); }};
    const sample::WalkedLight light = walkLight(body, lighting, points, medium, options);
    run.report["media"].push_back({{"material", material},
                                   {"mean_free_path", medium.meanFreePath},
                                   {"single_scattering_albedo", medium.albedo},
                                   {"reflectance", reflectance},
                                   {"samples", light.samples},
                                   {"noise", light.noise}});
    const double walks = 6.0 * double(points.size()) * light.samples;
    if (double(light.lost) > 0.001 * walks)
        run.warn(std::to_string(100 * double(light.lost) / walks) + " % of the walks in " + material +
                 " left through holes of the mesh and count as dark");
    return light;
}

std::vector<float> meanCurvatureAt(Run& run, const io::MeshData& mesh,
                                   const std::vector<sample::SurfacePoint>& points) {
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.quantity = PEL_QUANTITY_MEAN;
    const std::vector<float> vertices = meshCurvature(run, mesh, params, {PEL_WELD_EXACT}).values;
    std::vector<float> out;
    for (const sample::SurfacePoint& p : points) {
        double sum = 0;
        for (int k = 0; k < 3; ++k)
            sum += p.weights[k] * vertices[mesh.triangles[3 * size_t(p.triangle) + k]];
        out.push_back(float(sum));
    }
    return out;
}

std::vector<float> thicknessAt(const sample::WalkBody& body,
                               const std::vector<sample::SurfacePoint>& points) {
    const sample::Bounds& bounds = body.body().bounds();
    const double extent = length(bounds.high - bounds.low);
    std::vector<float> out;
    for (const sample::SurfacePoint& p : points) {
        const sample::Surface s = surfaceAt(body.lit().mesh(), p);
        sample::Vec3 normal;
        const double start = 1e-6 * extent;
        const sample::Hit hit =
            body.body().firstHit({s.position - s.normal * start, -s.normal}, extent, normal);
        out.push_back(float(std::min(hit.distance + start, extent)));
    }
    return out;
}

}  // namespace pellucid::cli
