// pellucid reference: the true picture, by the surface integral over the mesh or a random walk in it.
#include <charconv>

#include "fields/skin_spectra.h"
#include "io/atomic_file.h"
#include "io/lut/profile_file.h"
#include "io/mesh/mesh_parts.h"
#include "io/shortest.h"
#include "mesh_curvature.h"
#include "sample/random_walk.h"
#include "scene/scene_frame.h"

namespace pellucid::cli {
namespace {

using RgbValues = std::array<double, 3>;

sample::Vec3 vectorOf(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

// Irradiance / pi of the ambient light along n: harmonics of order 2 [Ramamoorthi and Hanrahan 2001].
std::array<double, 3> ambientAlong(const PelAmbient& ambient, sample::Vec3 n) {
    const double basis[9] = {0.282095,
                             0.488603 * n.y,
                             0.488603 * n.z,
                             0.488603 * n.x,
                             1.092548 * n.x * n.y,
                             1.092548 * n.y * n.z,
                             0.315392 * (3 * n.z * n.z - 1),
                             1.092548 * n.x * n.z,
                             0.546274 * (n.x * n.x - n.y * n.y)};
    std::array<double, 3> sum;
    for (int c = 0; c < 3; ++c) {
        sum[c] = ambient.constant[c];
        for (int i = 0; i < 9; ++i) sum[c] += basis[i] * ambient.sh[i][c];
        sum[c] = std::max(0.0, sum[c]);
    }
    return sum;
}

// A scene's lights, which all cast shadows, and its ambient light, which does not.
sample::Lighting lightingOf(const io::SceneFile& scene, const std::string& file) {
    sample::Lighting lighting;
    for (const io::SceneLight& l : scene.lights) {
        if (l.light.type >= PEL_LIGHT_SPHERE)
            throw io::FileError(file,
                                "has a sphere or rectangle as its light; reference takes directional, "
                                "point and spot lights");
        sample::SurfaceLight light;
        light.type = sample::SurfaceLight::Type(l.light.type);
        light.toLight = normalize(vectorOf(l.light.toLight));
        light.position = vectorOf(l.light.position);
        light.spotDirection = normalize(vectorOf(l.light.spotDirection));
        light.spotCosInner = l.light.spotCosInner;
        light.spotCosOuter = l.light.spotCosOuter;
        light.range = l.light.range;
        for (int c = 0; c < 3; ++c) light.color[c] = l.light.color[c];
        lighting.lights.push_back(light);
    }
    if (isLit(scene.ambient))
        lighting.ambient = [a = scene.ambient](sample::Vec3 n) { return ambientAlong(a, n); };
    return lighting;
}

struct WalkArguments {
    bool enabled = false;
    uint32_t samples = 64;
    double noise = 0;
    uint64_t seed = 1;
    std::vector<double> reflectance;  // empty: that of the material
    std::string boundary = "index-matched";
};

// Returns the option that enables the walk.
CLI::Option* addWalkOptions(CLI::App& command, WalkArguments& walk) {
    CLI::Option* enabled =
        option(command, "--walk", walk.enabled,
               "trace light through the volume (random walk) instead of integrating the profile over the "
               "surface; writes two independent halves, First and Second");
    CLI::Option* samples = option(command, "--samples", walk.samples, "walks per pixel, channel and half",
                                  inRange(1, int(sample::maxWalkSamples)), shown, Needs{enabled});
    option(command, "--noise", walk.noise,
           "instead of --samples: the standard error to reach in each pixel, such as 2e-3", isPositive())
        ->excludes(samples)
        ->needs(enabled);
    option(command, "--seed", walk.seed, "of the random numbers; the same seed gives the same result", shown,
           Needs{enabled});
    option(command, "--reflectance", walk.reflectance,
           "share of light that a large plane of the medium reflects, per channel (default: the mean albedo "
           "of the material's pixels, or the albedo of the material)",
           Count{3}, inRange(0.0, 1.0), Needs{enabled});
    option(command, "--boundary", walk.boundary,
           "index-matched, or fresnel: a smooth surface of a refractive index of 1.4, which skin always has",
           isOneOf({"index-matched", "fresnel"}), shown, Needs{enabled});
    return enabled;
}

sample::Boundary boundaryOf(const WalkArguments& walk) {
    return walk.boundary == "fresnel" ? sample::Boundary::Fresnel : sample::Boundary::IndexMatched;
}

// How one material scatters.
struct Diffusion {
    Profile profile;
    std::optional<PelSkin> skin;       // that the profile is computed from
    float unit = 1;                    // mm per unit of positions
    float radius = 0;                  // the profile's unit; 0: its own
    double scale = 1;                  // unit of positions per unit of the profile
    double narrowest = 0, widest = 0;  // units of positions, of the channels' line spreads
};

struct WalkMedium {
    sample::LayeredMedium layers;
    sample::Medium mean;  // for the report; of skin: the dermis
};

// Skin: both layers at each wavelength.
WalkMedium mediumOf(const PelSkin& skin, double scale) {
    const PelSkinInfo info = skinInfo(skin);
    WalkMedium out;
    out.layers.thickness = scale * skin.epidermis;
    out.layers.refractiveIndex = sample::fresnelIndex;
    for (size_t i = 0; i < pel::skinWavelengths; ++i) {
        const pel::SkinCoefficients c = pel::skinCoefficients(skin, pel::skinSpectra[i]);
        out.layers.waves.push_back(
            {c.scattering / scale, c.epidermis / scale, c.dermis / scale, pel::skinChannels()[i]});
    }
    for (size_t c = 0; c < 3; ++c) {
        out.mean.meanFreePath[c] = scale * info.meanFreePath[c];
        out.mean.albedo[c] = info.singleScatteringAlbedo[c];
    }
    return out;
}

// For skin or a Burley profile. Other kinds of profile do not determine a medium.
WalkMedium mediumOf(const WalkArguments& walk, const Diffusion& d, const RgbValues& reflectance,
                    const std::string& material) {
    if (d.skin) return mediumOf(*d.skin, d.scale);
    const PelProfileInfo info = d.profile.info();
    if (info.kind != PEL_PROFILE_BURLEY)
        throw InputError(
            "the profile '" + std::string(info.name) + "' of " + material +
            " has no known medium; a random walk needs one of kind burley, or of kind skin with pigments, "
            "such as --profile with a file of that kind");
    RgbValues lengths;
    // The line spread of Burley's profile of length d has a standard deviation of sqrt(7) d.
    for (int c = 0; c < 3; ++c) lengths[c] = d.scale * info.width[c] / std::sqrt(7.0);
    const sample::Medium medium = burleyMedium(lengths, reflectance, boundaryOf(walk));
    return {medium, medium};
}

// Signed mean curvature at each point, 1/unit of positions.
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

// The thickness of the body below each point.
std::vector<float> thicknessAt(const sample::WalkBody& body,
                               const std::vector<sample::SurfacePoint>& points) {
    const sample::Bounds& bounds = body.body().bounds();
    const double extent = length(bounds.high - bounds.low);
    std::vector<float> out;
    for (const sample::SurfacePoint& p : points) {
        const sample::Surface s = surfaceAt(body.lit().mesh(), p);
        sample::Vec3 otherSide;
        out.push_back(float(std::min(body.body().depthBelow(s.position, s.normal, otherSide), extent)));
    }
    return out;
}

struct ReferenceMesh {
    io::MeshData mesh;
    std::vector<uint32_t> materials;  // id per triangle; empty: no parts, all triangles scatter
    // The id of the triangles that enclose a material of the scene; 0: all triangles.
    uint32_t bodyOf(uint32_t material) const { return materials.empty() ? 0 : byMaterial ? material : 1; }
    bool byMaterial = false;
};

constexpr uint32_t shadowOnly = 256;  // no material has this id

// The id of each triangle: that of its group, or shadowOnly.
std::vector<uint32_t> idsOf(const std::string& path, const io::PartedMesh& mesh,
                            const std::vector<std::string>& parts, bool byMaterial) {
    std::vector<uint32_t> ids(mesh.partOf.size(), shadowOnly);
    for (const std::string& part : parts) {
        const size_t equals = part.find('=');
        const std::string name = byMaterial ? part.substr(equals + 1) : part;
        uint32_t id = 1;
        if (byMaterial) {
            const char *text = part.data(), *end = text + std::min(equals, part.size());
            const auto [stopped, error] = std::from_chars(text, end, id);
            if (error != std::errc() || stopped != end || id == 0 || id >= shadowOnly)
                throw UsageError(io::concat("--part ", part,
                                            ": several parts are written ID=GROUP, with an id from 1 to ",
                                            shadowOnly - 1));
        }
        const int wanted = mesh.part(name);
        if (wanted < 0)
            throw io::FileError(path,
                                "has no part '" + name + "'; it has: " + CLI::detail::join(mesh.parts, ", "));
        for (size_t t = 0; t < ids.size(); ++t)
            if (mesh.partOf[t] == uint32_t(wanted)) ids[t] = id;
    }
    return ids;
}

// `subdivide` levels: Catmull-Clark of OBJ files, Loop of others. `parts`: groups of an OBJ file that
// scatter, all others just cast shadows; none: all scatter. Either one GROUP, for all materials, or ID=GROUP
// for each material that has a body of its own.
ReferenceMesh loadReferenceMesh(const std::string& path, int subdivide,
                                const std::vector<std::string>& parts) {
    ReferenceMesh out;
    if (io::extensionOf(path) == "obj" && (subdivide > 0 || !parts.empty())) {
        io::PartedMesh parted = subdivide > 0 ? io::loadParts(path, subdivide) : io::loadGroups(path);
        out.byMaterial = parts.size() > 1 || (parts.size() == 1 && parts[0].find('=') != std::string::npos &&
                                              parted.part(parts[0]) < 0);
        if (!parts.empty()) out.materials = idsOf(path, parted, parts, out.byMaterial);
        out.mesh = std::move(parted.mesh);
    } else {
        if (!parts.empty()) throw io::FileError(path, "has no parts; only the groups of an OBJ file are");
        out.mesh = io::loadMesh(path);
        io::loopSubdivide(out.mesh, subdivide);
    }
    if (out.mesh.normals.empty()) io::computeNormals(out.mesh);
    return out;
}

struct ReferenceArguments {
    Run::Options run;
    std::string mesh, scene, gbuffer, output, profile;
    std::vector<std::string> parts;
    float diffusionRadius = 0, unit = 0, tolerance = pelSurfaceIntegralDescDefaults().tolerance;
    double finest = 0, coarsest = 0;
    std::vector<float> cut;
    int subdivide = 0;
    WalkArguments walk;
};

// Empty for a material without a profile, preset or curvature table, which reflects light where it arrives.
std::optional<Diffusion> diffusionOf(const ReferenceArguments& a, const io::SceneFile& scene,
                                     const io::SceneMaterial* material) {
    Diffusion d;
    std::string name = a.profile;
    float radius = 0;  // the scene's own
    d.unit = a.unit > 0 ? a.unit : scene.options.millimetresPerUnit;
    if (material && name.empty()) name = material->profile, radius = material->material.diffusionRadius;
    if (material && name.empty()) {
        const io::SceneLut* lut = scene.lut(material->curvatureLut, PEL_LUT_CURVATURE);
        if (lut && !lut->file.empty())
            throw UsageError(
                io::concat("the curvature table of material ", material->id,
                           " is a file, which does not contain its profile; name one with --profile"));
        if (!lut && material->preset == io::ScenePreset::none) return std::nullopt;
        if (lut) name = lut->profile;
        if (lut && radius == 0) radius = lut->info.curvature.diffusionRadius;
    }
    d.radius = a.diffusionRadius > 0 ? a.diffusionRadius : radius * d.unit;
    const io::ProfileFile file = io::findProfile(name.empty() ? "skin" : name);
    d.profile = file.profile;
    d.skin = file.skin;
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
        run.warn(io::concat("positions are up to ", worst, " away from the mesh, which is ", extent,
                            " across: are both in the same place and unit?"));
    return points;
}

std::vector<float> integrate(Run& run, const ReferenceArguments& a, const Diffusion& d,
                             const sample::LitMesh& lit, const std::vector<float>& positions) {
    PelSurfaceIntegralDesc desc = pelSurfaceIntegralDescDefaults();
    desc.profile = d.profile.get();
    desc.diffusionRadius = d.radius;
    desc.millimetresPerUnit = d.unit;
    std::copy(a.cut.begin(), a.cut.end(), desc.cut);
    desc.tolerance = a.tolerance;
    return sample::scatteredAt(run.device(), lit, positions, desc);
}

// Values of all pixels of the picture, RGB or one float each, by the first part of their channels' names.
using Layers = std::map<std::string, std::vector<float>>;

class Reference {
  public:
    Reference(Run& run, const ReferenceArguments& a)
        : run_(run),
          a_(a),
          file_(io::readScene(a.scene)),
          mesh_(loadReferenceMesh(a.mesh, a.subdivide, a.parts)),
          scene_(sample::MeshView{
              mesh_.mesh.positions, mesh_.mesh.normals, {}, {}, mesh_.mesh.triangles, mesh_.materials}),
          lighting_(lightingOf(file_, a.scene)) {
        for (const std::string& warning : mesh_.mesh.warnings) run.warn(warning);
        if (!file_.ambientCube.empty())
            run.warn("the ambient cube map is left out; only the keys constant and sh of [ambient] are used");
        if (!file_.channels[PEL_SLOT_SKIN].empty())
            run.warn("the maps of pigments are left out; albedo and profile are those of the material");
        if (lighting_.lights.empty() && !lighting_.ambient)
            run.warn("the scene has no light: the result is black");
        run.report["triangles"] = mesh_.mesh.triangleCount();
    }

    void vertices() {
        const io::SceneMaterial* material = file_.materials.empty() ? nullptr : &file_.materials[0];
        const std::optional<Diffusion> d = diffusionOf(a_, file_, material);
        const sample::WalkBody body(scene_, d && material ? mesh_.bodyOf(material->id) : mesh_.bodyOf(1));
        const size_t count = mesh_.mesh.vertexCount(), one[] = {count, 3}, both[] = {2, count, 3};
        if (d && !a_.walk.enabled) {
            io::writeNpy(a_.output, one,
                         integrate(run_, a_, *d, lit(*d, body.material()), mesh_.mesh.positions));
        } else {
            const Points points = pointsOf(run_, body, mesh_.mesh.positions);
            std::vector<float> halves;
            if (d) {
                const RgbValues A = reflectanceOf(*d, material, {}, {});
                const sample::WalkedLight light = walked(body, *d, points, A, material);
                halves = light.first;
                halves.insert(halves.end(), light.second.begin(), light.second.end());
                for (size_t i = 0; i < halves.size(); ++i) halves[i] = float(halves[i] / A[i % 3]);
            } else {
                const std::vector<float> E = sample::irradianceAt(scene_, lighting_, points.places);
                halves = E;
                if (a_.walk.enabled) halves.insert(halves.end(), E.begin(), E.end());
            }
            io::writeNpy(a_.output, a_.walk.enabled ? std::span<const size_t>(both) : one, halves);
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
        for (const char* rgb : {"", "Surface.", "Irradiance."}) layers[rgb].resize(3 * gbuffer.pixelCount());
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
        if (bad > 0) run_.warn(io::concat(bad, " positions are NaN or Inf; these pixels are 0"));
        io::Image image{gbuffer.width, gbuffer.height};
        for (const auto& [layer, values] : layers) {
            std::vector<std::string> names{layer};
            if (values.size() > gbuffer.pixelCount()) names = {layer + "R", layer + "G", layer + "B"};
            image.addInterleaved(names, values);
        }
        io::writeExr(a_.output, image);
        run_.report["points"] = count;
    }

  private:
    void evaluate(const io::SceneMaterial& material, const std::vector<size_t>& pixels,
                  const std::vector<float>& positions, const std::vector<float>& albedos, Layers& layers) {
        std::vector<float> from;
        for (const size_t pixel : pixels)
            from.insert(from.end(), &positions[3 * pixel], &positions[3 * pixel] + 3);
        const std::optional<Diffusion> d = diffusionOf(a_, file_, &material);
        // What does not scatter needs no body of its own.
        const sample::WalkBody body(scene_, d ? mesh_.bodyOf(material.id) : 0);
        const Points points = pointsOf(run_, body, from);
        const std::vector<float> E = sample::irradianceAt(scene_, lighting_, points.places);
        const auto albedo = [&](size_t value) {
            return albedos.empty() ? material.material.albedo[value % 3] : albedos[value];
        };
        const auto store = [&](const char* name, size_t components, const auto& valueOf) {
            std::vector<float>& layer = layers[name];
            layer.resize(components * (layers[""].size() / 3));
            for (size_t k = 0; k < components * pixels.size(); ++k)
                layer[components * pixels[k / components] + k % components] = float(valueOf(k));
        };
        store("Irradiance.", 3, [&](size_t k) { return E[k]; });
        const auto at = [&](size_t k) { return 3 * pixels[k / 3] + k % 3; };
        if (!d) {
            store("Surface.", 3, [&](size_t k) { return E[k]; });
            for (const char* half : {"First.", "Second."})
                if (a_.walk.enabled) store(half, 3, [&](size_t k) { return E[k] * albedo(at(k)); });
        } else if (!a_.walk.enabled) {
            const std::vector<float> S = integrate(run_, a_, *d, lit(*d, body.material()), points.positions);
            store("Surface.", 3, [&](size_t k) { return S[k]; });
        } else {
            const RgbValues A = reflectanceOf(*d, &material, albedos, pixels);
            const sample::WalkedLight light = walked(body, *d, points, A, &material);
            store("Surface.", 3, [&](size_t k) { return (light.first[k] + light.second[k]) / 2 / A[k % 3]; });
            store("First.", 3, [&](size_t k) { return light.first[k] / A[k % 3] * albedo(at(k)); });
            store("Second.", 3, [&](size_t k) { return light.second[k] / A[k % 3] * albedo(at(k)); });
            store("MeanFreePath.", 3, [&](size_t k) { return medium_.mean.meanFreePath[k % 3]; });
            const std::vector<float> curvature = meanCurvatureAt(run_, mesh_.mesh, points.places),
                                     thickness = thicknessAt(body, points.places);
            store("MeanCurvature", 1, [&](size_t k) { return curvature[k]; });
            store("Thickness", 1, [&](size_t k) { return thickness[k]; });
        }
        std::vector<float>&radiance = layers[""], &surface = layers["Surface."];
        for (const size_t pixel : pixels)
            for (size_t i = 3 * pixel; i < 3 * pixel + 3; ++i) radiance[i] = surface[i] * albedo(i);
    }

    // Walks, with progress and an entry `media` in the report.
    sample::WalkedLight walked(const sample::WalkBody& body, const Diffusion& d, const Points& points,
                               const RgbValues& reflectance, const io::SceneMaterial* material) {
        const std::string name = io::concat("material ", material ? material->id : 1);
        medium_ = mediumOf(a_.walk, d, reflectance, name);
        const sample::WalkedLight light =
            walkLight(body, lighting_, points.places, medium_.layers,
                      {a_.walk.samples, a_.walk.noise, a_.walk.seed,
                       [&](double part) { run_.progress(part, "random walk"); }});
        run_.report["media"].push_back({{"material", name},
                                        {"epidermis", medium_.layers.thickness},
                                        {"mean_free_path", medium_.mean.meanFreePath},
                                        {"single_scattering_albedo", medium_.mean.albedo},
                                        {"reflectance", reflectance},
                                        {"samples", light.samples},
                                        {"noise", light.noise}});
        const double lost = double(light.lost) / (6.0 * double(points.places.size()) * light.samples);
        if (lost > 0.001)
            run_.warn(
                io::concat(io::printed("%.2g", 100 * lost), " % of the walks in ", name,
                           " did not meet the mesh from inside and count as dark: it has holes, or triangles "
                           "whose corners run clockwise seen from outside"));
        return light;
    }

    // The reflectance of a large plane of the medium. An albedo texture does not change the medium.
    RgbValues reflectanceOf(const Diffusion& d, const io::SceneMaterial* material,
                            const std::vector<float>& albedos, const std::vector<size_t>& pixels) const {
        RgbValues A{0.8, 0.8, 0.8};
        if (d.skin) {
            if (!a_.walk.reflectance.empty())
                throw InputError("--reflectance: that of skin follows from its pigments");
            std::ranges::copy(skinInfo(*d.skin).albedo, A.begin());
            return A;
        }
        for (size_t c = 0; c < 3; ++c) {
            if (material) A[c] = material->material.albedo[c];
            double sum = 0;
            if (!albedos.empty())
                for (const size_t pixel : pixels) sum += albedos[3 * pixel + c];
            if (!albedos.empty()) A[c] = sum / double(pixels.size());
            if (!a_.walk.reflectance.empty()) A[c] = a_.walk.reflectance[c];
            const double most = sample::mostReflectance(boundaryOf(a_.walk));
            if (!(A[c] > 0 && A[c] < most))
                throw InputError(io::concat("a reflectance of ", A[c], " has no medium behind the boundary ",
                                            a_.walk.boundary, "; values above 0 and below ", most,
                                            " can be given with --reflectance"));
        }
        return A;
    }

    sample::LitMesh lit(const Diffusion& d, uint32_t body) {
        sample::LitMeshOptions options;
        options.finest = a_.finest > 0 ? a_.finest : d.narrowest / 4;
        options.coarsest = a_.coarsest > 0 ? a_.coarsest : std::max(d.widest, options.finest);
        options.material = body;
        sample::LitMesh lit = sample::lightMesh(
            scene_, lighting_, options, [&](double part) { run_.progress(part, "irradiance of the mesh"); });
        run_.report["lit_triangles"] = lit.triangles.size() / 3;
        run_.report["finest"] = options.finest;
        return lit;
    }

    Run& run_;
    const ReferenceArguments& a_;
    io::SceneFile file_;
    ReferenceMesh mesh_;
    sample::Scene scene_;
    sample::Lighting lighting_;
    WalkMedium medium_;  // of the material that was walked last
};

void runReference(const ReferenceArguments& a) {
    checkOutput(a.output, {"exr", "npy"}, {a.mesh, a.scene, a.gbuffer, a.profile});
    const bool picture = io::extensionOf(a.output) == "exr";
    if (picture == a.gbuffer.empty())
        throw UsageError(picture ? "-o " + a.output +
                                       ": a picture needs --gbuffer; without one, name a .npy for values at "
                                       "the mesh's vertices"
                                 : "--gbuffer: the picture goes to an .exr, not to " + a.output);
    Run run(a.run);
    try {
        withInput(a.mesh + " with " + a.scene, [&] {
            Reference reference(run, a);
            picture ? reference.picture() : reference.vertices();
        });
    } catch (const std::logic_error& e) {
        throw InputError(a.mesh + ": " + e.what());
    }
    run.report["output"] = a.output;
    run.finish();
}

}  // namespace

void addReference(CLI::App& app) {
    auto [command, a] =
        subcommand<ReferenceArguments>(app, "reference",
                                       "What a picture should be: the surface integral over the mesh, or "
                                       "a random walk in its volume, with ray-traced shadows",
                                       runReference);
    option(command, "mesh", a.mesh, "OFF, OBJ, PLY or STL file, in the unit of the scene", required);
    option(command, "--scene", a.scene,
           "scene file (TOML), as for shade: lights, materials, which channel is what", required);
    option(command, "--gbuffer", a.gbuffer,
           "multi-layer EXR whose visible positions are evaluated; without it, the mesh's vertices are");
    option(command, "-o,--output", a.output,
           "EXR to write: radiance R, G, B, and the layers Surface (without albedo) and Irradiance; or NPY: "
           "Surface per vertex, (n, 3); of a walk both halves, (2, n, 3)",
           required);
    option(command, "--profile", a.profile,
           "material of the library or profile file (default: that of the material, else of its curvature "
           "table)",
           Word{profileWord});
    option(command, "--diffusion-radius", a.diffusionRadius,
           "scales the profile to this radius, mm; 0: the material's, else its own", isNotNegative(), shown);
    option(command, "--unit-mm", a.unit, "millimetres per unit of positions (default: the scene's unit_mm)",
           isPositive());
    CLI::Option* cut =
        option(command, "--cut", a.cut,
               "mm per channel where the profile ends, as in renderers that cut it off; 0: nowhere", Count{3},
               isNotNegative());
    option(command, "--subdivide", a.subdivide,
           "levels of subdivision, done first: Catmull-Clark of OBJ files, Loop of others", inRange(0, 6),
           shown);
    option(command, "--part", a.parts,
           "group of an OBJ file that scatters, all others just cast shadows; or, several times, ID=GROUP: "
           "the body of the material with that id",
           Word{"NAME"}, oneEach);
    CLI::Option* finest = option(
        command, "--finest", a.finest,
        "length to which triangles are split at the edges of shadows (default: a quarter of the narrowest "
        "channel's width)",
        isNotNegative());
    CLI::Option* coarsest =
        option(command, "--coarsest", a.coarsest,
               "length above which triangles are split everywhere (default: the widest channel's width)",
               isNotNegative());
    CLI::Option* tolerance =
        option(command, "--tolerance", a.tolerance, "bound of the error of far light, part of the brightest",
               inRange(1e-7, 1.0), shown);
    // Of the surface integral alone.
    CLI::Option* walk = addWalkOptions(command, a.walk);
    for (CLI::Option* each : {cut, finest, coarsest, tolerance}) each->excludes(walk);
    addRunOptions(command, a.run);
}

}  // namespace pellucid::cli
