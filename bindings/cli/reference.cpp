// pellucid reference: the true picture, by the surface integral over the mesh or by a random walk in its
// volume.
#include <algorithm>
#include <cmath>

#include "command.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image/image_file.h"
#include "io/input_file.h"
#include "io/lut/profile_file.h"
#include "sample/surface_light.h"
#include "scene/scene_frame.h"
#include "surface_reference.h"
#include "walk_reference.h"

namespace pellucid::cli {
namespace {

struct Arguments {
    Run::Options run;
    std::string mesh, scene, gbuffer, output, profile;
    std::vector<std::string> parts;
    float diffusionRadius = 0, unit = 0, tolerance = pelSurfaceIntegralDescDefaults().tolerance;
    double finest = 0, coarsest = 0;
    std::vector<float> cut;
    int subdivide = 0;
    WalkArguments walk;
};

float unitOf(const Arguments& a, const io::SceneFile& scene) {
    return a.unit > 0 ? a.unit : scene.options.millimetresPerUnit;
}

// How one material scatters.
struct Diffusion {
    Profile profile;
    float unit = 1;                    // mm per unit of positions
    float radius = 0;                  // the profile's unit; 0: its own
    double scale = 1;                  // unit of positions per unit of the profile
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
                             " is a file, which does not contain its profile; name one with --profile");
        if (lut) name = lut->profile;
    }
    d.profile = name.empty() ? Profile::skin() : io::findProfile(name).profile;
    const PelProfileInfo info = d.profile.info();
    d.scale = (d.radius > 0 ? d.radius / info.radius : 1) / d.unit;
    d.narrowest = d.scale * std::min({info.width[0], info.width[1], info.width[2]});
    d.widest = d.scale * std::max({info.width[0], info.width[1], info.width[2]});
    return d;
}

// Points of the mesh that are evaluated.
struct Points {
    std::vector<sample::SurfacePoint> places;
    std::vector<float> positions;  // xyz
};

// The nearest points of the body. A position above a facet would receive too little light.
Points pointsOf(Run& run, const sample::WalkBody& body, const std::vector<float>& positions) {
    Points points;
    std::vector<double> off;
    points.places = sample::nearestPoints(body.body(), positions, off);
    for (sample::SurfacePoint& place : points.places) {
        place.triangle = body.litTriangle(place.triangle);
        const sample::Vec3 p = surfaceAt(body.lit().mesh(), place).position;
        points.positions.insert(points.positions.end(), {float(p.x), float(p.y), float(p.z)});
    }
    if (off.empty()) return points;
    const sample::Bounds& bounds = body.lit().bounds();
    const double worst = *std::max_element(off.begin(), off.end()), extent = length(bounds.high - bounds.low);
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

// Values of all pixels of the picture.
struct Layers {
    std::vector<float> radiance, surface, irradiance;  // RGB
    // Only of walks. first, second, meanFreePath: RGB.
    std::vector<float> first, second, meanFreePath, meanCurvature, thickness;

    io::Image image(int width, int height) const {
        io::Image image;
        image.width = width;
        image.height = height;
        image.addInterleaved(std::vector<std::string>{"R", "G", "B"}, radiance);
        const auto add = [&](const std::string& name, const std::vector<float>& values) {
            if (!values.empty())
                image.addInterleaved(std::vector<std::string>{name + ".R", name + ".G", name + ".B"}, values);
        };
        add("Surface", surface);
        add("Irradiance", irradiance);
        add("First", first);
        add("Second", second);
        add("MeanFreePath", meanFreePath);
        if (!meanCurvature.empty())
            image.addInterleaved(std::vector<std::string>{"MeanCurvature"}, meanCurvature);
        if (!thickness.empty()) image.addInterleaved(std::vector<std::string>{"Thickness"}, thickness);
        return image;
    }
};

class Reference {
  public:
    Reference(Run& run, const Arguments& a)
        : run_(run),
          a_(a),
          file_(io::readScene(a.scene)),
          mesh_(loadReferenceMesh(a.mesh, a.subdivide, a.parts)),
          scene_(sample::MeshView{
              mesh_.mesh.positions, mesh_.mesh.normals, {}, {}, mesh_.mesh.triangles, mesh_.materials}),
          lighting_(lightingOf(file_)) {
        for (const std::string& warning : mesh_.mesh.warnings) run.warn(warning);
        if (!file_.ambientCube.empty())
            run.warn("the ambient cube map is left out; only the keys constant and sh of [ambient] are used");
        if (lighting_.lights.empty() && !lighting_.ambient)
            run.warn("the scene has no light: the result is black");
        run.report["triangles"] = mesh_.mesh.triangleCount();
    }

    void vertices() {
        const io::SceneMaterial* material = file_.materials.empty() ? nullptr : &file_.materials[0];
        const Diffusion d = diffusionOf(a_, file_, material);
        const sample::WalkBody body(scene_, mesh_.bodyOf(material ? material->id : 1));
        const size_t count = mesh_.mesh.vertexCount();
        if (a_.walk.enabled) {
            const Points points = pointsOf(run_, body, mesh_.mesh.positions);
            const RgbValues A = reflectanceOf(material, {}, {});
            const sample::WalkedLight light = walked(body, d, points, A, material);
            const size_t shape[] = {2, count, 3};
            std::vector<float> halves = light.first;
            halves.insert(halves.end(), light.second.begin(), light.second.end());
            for (size_t i = 0; i < halves.size(); ++i) halves[i] = float(halves[i] / A[i % 3]);
            io::writeNpy(a_.output, shape, halves);
        } else {
            const std::vector<float> S =
                integrate(run_, a_, d, lit(d, body.material()), mesh_.mesh.positions);
            const size_t shape[] = {count, 3};
            io::writeNpy(a_.output, shape, S);
        }
        run_.report["points"] = count;
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
        Layers layers;
        for (auto* rgb : {&layers.radiance, &layers.surface, &layers.irradiance})
            rgb->resize(3 * gbuffer.pixelCount());
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
            if (!pixels.empty()) evaluate(material, pixels, positions, albedos, layers);
            count += pixels.size();
        }
        if (bad > 0) run_.warn(std::to_string(bad) + " positions are NaN or Inf; these pixels are 0");
        io::writeExr(a_.output, layers.image(gbuffer.width, gbuffer.height));
        run_.report["points"] = count;
    }

  private:
    void evaluate(const io::SceneMaterial& material, const std::vector<size_t>& pixels,
                  const std::vector<float>& positions, const std::vector<float>& albedos, Layers& layers) {
        std::vector<float> from;
        for (const size_t pixel : pixels)
            from.insert(from.end(), &positions[3 * pixel], &positions[3 * pixel] + 3);
        const sample::WalkBody body(scene_, mesh_.bodyOf(material.id));
        const Points points = pointsOf(run_, body, from);
        const Diffusion d = diffusionOf(a_, file_, &material);
        const std::vector<float> E = sample::irradianceAt(scene_, lighting_, points.places);
        const auto albedo = [&](size_t value) {
            return albedos.empty() ? material.material.albedo[value % 3] : albedos[value];
        };
        const auto store = [&](std::vector<float>& layer, const auto& valueOf, size_t components = 3) {
            layer.resize(components * (layers.radiance.size() / 3));
            for (size_t k = 0; k < components * pixels.size(); ++k)
                layer[components * pixels[k / components] + k % components] = float(valueOf(k));
        };
        store(layers.irradiance, [&](size_t k) { return E[k]; });
        if (!a_.walk.enabled) {
            const std::vector<float> S = integrate(run_, a_, d, lit(d, body.material()), points.positions);
            store(layers.surface, [&](size_t k) { return S[k]; });
        } else {
            const RgbValues A = reflectanceOf(&material, albedos, pixels);
            const sample::WalkedLight light = walked(body, d, points, A, &material);
            const auto at = [&](size_t k) { return 3 * pixels[k / 3] + k % 3; };
            store(layers.surface,
                  [&](size_t k) { return (light.first[k] + light.second[k]) / 2 / A[k % 3]; });
            store(layers.first, [&](size_t k) { return light.first[k] / A[k % 3] * albedo(at(k)); });
            store(layers.second, [&](size_t k) { return light.second[k] / A[k % 3] * albedo(at(k)); });
            store(layers.meanFreePath, [&](size_t k) { return medium_.meanFreePath[k % 3]; });
            const std::vector<float> curvature = meanCurvatureAt(run_, mesh_.mesh, points.places),
                                     thickness = thicknessAt(body, points.places);
            store(
                layers.meanCurvature, [&](size_t k) { return curvature[k]; }, 1);
            store(
                layers.thickness, [&](size_t k) { return thickness[k]; }, 1);
        }
        for (const size_t pixel : pixels)
            for (size_t i = 3 * pixel; i < 3 * pixel + 3; ++i)
                layers.radiance[i] = layers.surface[i] * albedo(i);
    }

    sample::WalkedLight walked(const sample::WalkBody& body, const Diffusion& d, const Points& points,
                               const RgbValues& reflectance, const io::SceneMaterial* material) {
        const std::string name = "material " + std::to_string(material ? material->id : 1);
        medium_ = mediumOf(a_.walk, d.profile, d.scale, reflectance, name);
        return walk(run_, a_.walk, body, lighting_, points.places, medium_, reflectance, name);
    }

    // What a large plane of the medium reflects. A texture varies the albedo over one medium.
    RgbValues reflectanceOf(const io::SceneMaterial* material, const std::vector<float>& albedos,
                            const std::vector<size_t>& pixels) const {
        RgbValues A{0.8, 0.8, 0.8};
        for (size_t c = 0; c < 3; ++c) {
            if (material) A[c] = material->material.albedo[c];
            double sum = 0;
            if (!albedos.empty())
                for (const size_t pixel : pixels) sum += albedos[3 * pixel + c];
            if (!albedos.empty()) A[c] = sum / double(pixels.size());
            if (!a_.walk.reflectance.empty()) A[c] = a_.walk.reflectance[c];
            if (!(A[c] > 0 && A[c] < 1))
                throw InputError("a reflectance of " + std::to_string(A[c]) +
                                 " has no medium; values between 0 and 1 can be given with --reflectance");
        }
        return A;
    }

    sample::LitMesh lit(const Diffusion& d, uint32_t body) {
        sample::LitMeshOptions options;
        options.finest = a_.finest > 0 ? a_.finest : d.narrowest / 4;
        options.coarsest = a_.coarsest > 0 ? a_.coarsest : std::max(d.widest, options.finest);
        options.material = body;
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
    sample::Medium medium_;  // of the material that was walked last
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

void addReference(Command& app) {
    Command* command = app.addCommand(
        "reference",
        "What a picture should be: the surface integral over the mesh, or a random walk in its volume, with "
        "ray-traced shadows");
    auto a = std::make_shared<Arguments>();
    command->addOption("mesh", a->mesh, "OFF, OBJ, PLY or STL file, in the unit of the scene")->required();
    command
        ->addOption("--scene", a->scene,
                    "scene file (TOML), as for shade: lights, materials, which channel is what")
        ->required();
    command->addOption(
        "--gbuffer", a->gbuffer,
        "multi-layer EXR whose visible positions are evaluated; without it, the mesh's vertices are");
    command
        ->addOption("-o,--output", a->output,
                    "EXR to write: radiance R, G, B, and the layers Surface (without albedo) and "
                    "Irradiance; or NPY: Surface per vertex, (n, 3); of a walk both halves, (2, n, 3)")
        ->required();
    command
        ->addOption("--profile", a->profile,
                    "material of the library or profile file (default: that of the material's curvature "
                    "table, else skin)")
        ->typeName(profileWord);
    command
        ->addOption("--diffusion-radius", a->diffusionRadius,
                    "scales the profile to this radius, mm; 0: its own")
        ->check(isNotNegative())
        ->showDefault();
    command
        ->addOption("--unit-mm", a->unit, "millimetres per unit of positions (default: the scene's unit_mm)")
        ->check(isPositive());
    command
        ->addOption("--cut", a->cut,
                    "mm per channel where the profile ends, as in renderers that cut it off; 0: nowhere")
        ->expected(3);
    command
        ->addOption("--subdivide", a->subdivide,
                    "levels of subdivision, done first: Catmull-Clark of OBJ files, Loop of others")
        ->check(inRange(0, 6))
        ->showDefault();
    command
        ->addOption("--part", a->parts,
                    "group of an OBJ file that scatters, all others just cast shadows; or, several times, "
                    "ID=GROUP: the body of the material with that id")
        ->typeName("NAME")
        ->oneEach();
    command
        ->addOption("--finest", a->finest,
                    "length to which triangles are split at the edges of shadows (default: a quarter of the "
                    "narrowest channel's width)")
        ->check(isNotNegative());
    command
        ->addOption("--coarsest", a->coarsest,
                    "length above which they are split anywhere (default: the widest channel's width)")
        ->check(isNotNegative());
    command->addOption("--tolerance", a->tolerance, "bound of the error of far light, part of the brightest")
        ->check(inRange(1e-7, 1.0))
        ->showDefault();
    addWalkOptions(*command, a->walk);
    addRunOptions(*command, a->run);
    command->callback([a] { run(*a); });
}

}  // namespace pellucid::cli
