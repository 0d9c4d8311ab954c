// pellucid reference: the true picture, by the surface integral over the mesh.
#include <algorithm>
#include <cmath>

#include "command.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image/image_file.h"
#include "io/input_file.h"
#include "io/lut/profile_file.h"
#include "io/scene/scene_frame.h"
#include "sample/surface_light.h"
#include "surface_reference.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    Run::Options run;
    std::string mesh, scene, gbuffer, output, profile, part;
    float diffusionRadius = 0, unit = 0, tolerance = pelSurfaceIntegralDescDefaults().tolerance;
    double finest = 0, coarsest = 0;
    std::vector<float> cut;
    int subdivide = 0;
};

float unitOf(const Arguments& a, const io::SceneFile& scene) {
    return a.unit > 0 ? a.unit : scene.unitMm;
}

// How one material scatters.
struct Diffusion {
    Profile profile;
    float unit = 1;                    // mm per unit of positions
    float radius = 0;                  // the profile's unit; 0: its own
    double narrowest = 0, widest = 0;  // units of positions, of the channels' line spreads
};

Diffusion diffusionOf(const Arguments& a, const io::SceneFile& scene, const io::SceneMaterial* material) {
    Diffusion d;
    std::string name = a.profile;
    d.radius = a.diffusionRadius;
    d.unit = unitOf(a, scene);
    if (material && name.empty()) name = material->profile;
    if (material && name.empty()) {
        const io::SceneLut* lut = scene.lut(material->curvatureLut, PEL_LUT_CURVATURE);
        if (lut && !lut->file.empty())
            throw UsageError("the curvature table of material " + std::to_string(material->id) +
                             " is a file, which does not tell its profile; name one with --profile");
        if (lut) name = lut->profile;
    }
    d.profile = name.empty() ? Profile::skin() : io::findProfile(name).profile;
    const PelProfileInfo info = d.profile.info();
    const double scale = (d.radius > 0 ? d.radius / info.radius : 1) / d.unit;
    d.narrowest = scale * std::min({info.width[0], info.width[1], info.width[2]});
    d.widest = scale * std::max({info.width[0], info.width[1], info.width[2]});
    return d;
}

// Places on the mesh, and the material at each.
struct Points {
    std::vector<sample::SurfacePoint> places;
    std::vector<size_t> pixels;  // of the picture; empty: the vertices
    std::vector<float> positions;
};

sample::Vec3 at(const sample::Mesh& mesh, const sample::SurfacePoint& p) {
    sample::Vec3 sum;
    for (int k = 0; k < 3; ++k) {
        const float* v = &mesh.positions[3 * size_t(mesh.triangles[3 * size_t(p.triangle) + k])];
        sum = sum + sample::Vec3{v[0], v[1], v[2]} * p.weights[k];
    }
    return sum;
}

// Moves positions of a picture to the mesh: a point above a facet would receive too little light.
Points pointsOf(Run& run, const sample::Scene& scene, const std::vector<float>& positions,
                std::vector<size_t> pixels) {
    Points points;
    points.pixels = std::move(pixels);
    std::vector<float> from;
    for (const size_t pixel : points.pixels)
        from.insert(from.end(), &positions[3 * pixel], &positions[3 * pixel] + 3);
    std::vector<double> off;
    points.places = sample::nearestPoints(scene, from, off);
    for (const auto& place : points.places)
        for (const sample::Vec3 p = at(scene.mesh(), place); double x : {p.x, p.y, p.z})
            points.positions.push_back(float(x));
    if (off.empty()) return points;
    const double worst = *std::max_element(off.begin(), off.end()),
                 extent = length(scene.bounds().high - scene.bounds().low);
    run.report["points_off_mesh"] = worst;
    if (worst > 2e-3 * extent)
        run.warn("positions are up to " + std::to_string(worst) + " away from the mesh, which is " +
                 std::to_string(extent) + " across: are both in the same place and unit?");
    return points;
}

std::vector<float> integrate(Run& run, const Arguments& a, const Diffusion& d, const sample::LitMesh& lit,
                             const std::vector<float>& positions) {
    PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
    desc.profile = d.profile.get();
    desc.diffusionRadius = d.radius;
    desc.millimetresPerUnit = d.unit;
    std::copy(a.cut.begin(), a.cut.end(), desc.cut);
    desc.tolerance = a.tolerance;
    return sample::scatteredAt(run.device(), lit, positions, desc);
}

std::vector<std::string> layer(const char* name) {
    return {std::string(name) + ".R", std::string(name) + ".G", std::string(name) + ".B"};
}

class Reference {
  public:
    Reference(Run& run, const Arguments& a)
        : run_(run),
          a_(a),
          file_(io::readScene(a.scene)),
          mesh_(loadReferenceMesh(a.mesh, a.subdivide, a.part)),
          scene_(sample::MeshView{
              mesh_.mesh.positions, mesh_.mesh.normals, {}, {}, mesh_.mesh.triangles, mesh_.materials}),
          lighting_(lightingOf(file_)) {
        for (const std::string& warning : mesh_.mesh.warnings) run.warn(warning);
        if (!file_.ambientCube.empty())
            run.warn("the ambient cube map is left out: only constant and sh are known here");
        if (lighting_.lights.empty() && !lighting_.ambient)
            run.warn("the scene has no light: the result is black");
        run.report["triangles"] = mesh_.mesh.triangleCount();
    }

    void vertices() {
        const Diffusion d = diffusionOf(a_, file_, file_.materials.empty() ? nullptr : &file_.materials[0]);
        const std::vector<float> S = integrate(run_, a_, d, lit(d), mesh_.mesh.positions);
        const size_t shape[] = {S.size() / 3, 3};
        io::writeNpy(a_.output, shape, S);
        run_.report["points"] = S.size() / 3;
    }

    void picture() {
        const io::Image gbuffer = io::readImage(a_.gbuffer);
        if (file_.channels[PEL_SLOT_POSITION].empty())
            throw io::FileError(
                file_.source,
                "[channels] position is missing; the reference is evaluated at the picture's positions");
        const std::vector<float> positions = gbuffer.interleaved(file_.channels[PEL_SLOT_POSITION]);
        const auto values = [&](PelImageSlot slot) {
            return file_.channels[slot].empty() ? std::vector<float>()
                                                : gbuffer.interleaved(file_.channels[slot]);
        };
        const std::vector<float> ids = values(PEL_SLOT_MATERIAL), albedos = values(PEL_SLOT_ALBEDO);
        std::vector<float> radiance(3 * gbuffer.pixelCount()), surface(radiance), irradiance(radiance);
        size_t count = 0, bad = 0;
        for (const io::SceneMaterial& material : file_.materials) {
            std::vector<size_t> pixels;
            for (size_t i = 0; i < gbuffer.pixelCount(); ++i) {
                if (!ids.empty() && ids[i] != float(material.id)) continue;
                const bool finite =
                    std::isfinite(positions[3 * i] + positions[3 * i + 1] + positions[3 * i + 2]);
                bad += !finite;
                if (finite) pixels.push_back(i);
            }
            const Points points = pointsOf(run_, scene_, positions, std::move(pixels));
            const Diffusion d = diffusionOf(a_, file_, &material);
            const std::vector<float> E = sample::irradianceAt(scene_, lighting_, points.places),
                                     S = integrate(run_, a_, d, lit(d), points.positions);
            for (size_t k = 0; k < points.pixels.size(); ++k)
                for (size_t c = 0; c < 3; ++c) {
                    const size_t to = 3 * points.pixels[k] + c;
                    irradiance[to] = E[3 * k + c];
                    surface[to] = S[3 * k + c];
                    radiance[to] = S[3 * k + c] * (albedos.empty() ? material.material.albedo[c] : albedos[to]);
                }
            count += points.pixels.size();
        }
        if (bad > 0) run_.warn(std::to_string(bad) + " positions are NaN or Inf; these pixels are 0");
        io::Image image;
        image.width = gbuffer.width;
        image.height = gbuffer.height;
        image.addInterleaved(std::vector<std::string>{"R", "G", "B"}, radiance);
        image.addInterleaved(layer("Surface"), surface);
        image.addInterleaved(layer("Irradiance"), irradiance);
        io::writeExr(a_.output, image);
        run_.report["points"] = count;
    }

  private:
    sample::LitMesh lit(const Diffusion& d) {
        sample::LitMeshOptions options;
        options.finest = a_.finest > 0 ? a_.finest : d.narrowest / 4;
        options.coarsest = a_.coarsest > 0 ? a_.coarsest : std::max(d.widest, options.finest);
        options.material = mesh_.materials.empty() ? 0 : 1;
        sample::LitMesh lit = sample::lightMesh(scene_, lighting_, options);
        run_.report["lit_triangles"] = lit.triangles.size() / 3;
        run_.report["finest"] = options.finest;
        return lit;
    }

    Run& run_;
    const Arguments& a_;
    io::SceneFile file_;
    ReferenceMesh mesh_;
    sample::Scene scene_;
    sample::Lighting lighting_;
};

void run(const Arguments& a) {
    try {
        io::requireExtension(a.output, {"exr", "npy"});
        io::checkWritable(a.output);
    } catch (const io::FileError& e) {
        throw UsageError(e.what());
    }
    const bool picture = io::extensionOf(a.output) == "exr";
    if (picture == a.gbuffer.empty())
        throw UsageError(picture ? "-o " + a.output +
                                       ": a picture needs --gbuffer; without one, name a .npy for values at "
                                       "the mesh's vertices"
                                 : "--gbuffer: the picture goes to an .exr, not to " + a.output);
    if (!a.cut.empty() && a.cut.size() != 3)
        throw UsageError("--cut: three lengths are needed, one per channel");
    Run run(a.run);
    try {
        Reference reference(run, a);
        picture ? reference.picture() : reference.vertices();
    } catch (const Error& e) {
        if (e.code() == PEL_ERROR_INVALID_ARGUMENT)
            throw InputError(a.mesh + " with " + a.scene + ": " + e.what());
        throw;
    } catch (const std::invalid_argument& e) {
        throw InputError(a.mesh + ": " + e.what());
    }
    run.report["output"] = a.output;
    run.finish();
}

}  // namespace

void addReference(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "reference", "What a picture should be: the surface integral over the mesh, with ray-traced shadows");
    auto a = std::make_shared<Arguments>();
    command->add_option("mesh", a->mesh, "OFF, OBJ, PLY or STL file, in the unit of the scene")->required();
    command
        ->add_option("--scene", a->scene,
                     "scene file (TOML), as for shade: lights, materials, which channel is what")
        ->required();
    command->add_option(
        "--gbuffer", a->gbuffer,
        "multi-layer EXR whose visible positions are evaluated; without it, the mesh's vertices are");
    command
        ->add_option("-o,--output", a->output,
                     "EXR to write: radiance R, G, B, and the layers Surface (without albedo) and "
                     "Irradiance; or NPY: Surface per vertex")
        ->required();
    command->add_option("--profile", a->profile,
                        "material of the library or profile file (default: that of the material's curvature "
                        "table, else skin)");
    command
        ->add_option("--diffusion-radius", a->diffusionRadius,
                     "scales the profile to this radius, mm; 0: its own")
        ->check(isNotNegative())
        ->capture_default_str();
    command
        ->add_option("--unit-mm", a->unit, "millimetres per unit of positions (default: the scene's unit_mm)")
        ->check(isPositive());
    command
        ->add_option("--cut", a->cut,
                     "mm per channel where the profile ends, as in renderers that cut it off; 0: nowhere")
        ->expected(3);
    command
        ->add_option("--subdivide", a->subdivide,
                     "levels of subdivision, done first: Catmull-Clark of OBJ files, Loop of others")
        ->check(inRange(0, 6))
        ->capture_default_str();
    command->add_option("--part", a->part, "group of an OBJ file that scatters; the others only cast shadows");
    command
        ->add_option("--finest", a->finest,
                     "length to which triangles are split at the edges of shadows (default: a quarter of the "
                     "narrowest channel's width)")
        ->check(isNotNegative());
    command
        ->add_option("--coarsest", a->coarsest,
                     "length above which they are split anywhere (default: the widest channel's width)")
        ->check(isNotNegative());
    command->add_option("--tolerance", a->tolerance, "bound of the error of far light, part of the brightest")
        ->check(inRange(1e-7, 1.0))
        ->capture_default_str();
    addRunOptions(*command, a->run);
    command->callback([a] { run(*a); });
}

}  // namespace pellucid::cli
