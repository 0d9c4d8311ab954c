#include "gltf/gltf_file.h"

#include <Imath/ImathQuat.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <numeric>

#include "gltf/gltf_document.h"
#include "io/choice_keys.h"

namespace pellucid::io {
namespace {

void warnOnce(std::vector<std::string>& warnings, const std::string& text) {
    if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(text);
}

// Features that are not imported are added to `warnings`.
GltfMaterial readGltfMaterial(const GltfDocument& document, const GltfValue& material,
                              std::vector<std::string>& warnings) {
    GltfMaterial m;
    m.name = material.text("name", "");
    const auto texture = [&](const GltfValue& owner, const char* key) {
        if (owner.has(key))
            warnOnce(warnings, "textures other than the base colour's are left out; only factors are used");
    };
    const auto setBaseColor = [&](const GltfValue& owner, const char* key) {
        double color[4] = {1, 1, 1, 1};
        owner.numbers(key, color, 4, 0, 1);
        m.baseColor = {color[0], color[1], color[2]};
    };
    if (material.has("pbrMetallicRoughness")) {
        const GltfValue pbr = material["pbrMetallicRoughness"];
        setBaseColor(pbr, "baseColorFactor");
        m.metallic = pbr.number("metallicFactor", 1, 0, 1);
        m.roughness = pbr.number("roughnessFactor", 1, 0, 1);
        texture(pbr, "metallicRoughnessTexture");
        if (pbr.has("metallicRoughnessTexture"))
            m.metallic = 0;  // its factor is of unknown texels, mostly of 0
        if (pbr.has("baseColorTexture")) {
            const GltfValue info = pbr["baseColorTexture"], top = document.root();
            const GltfValue named = top.element("textures", info, "index");
            if (named.has("sampler"))
                for (const char* wrap : {"wrapS", "wrapT"})
                    if (top.element("samplers", named, "sampler").whole(wrap, 10497, 65535) != 10497)
                        warnOnce(warnings, "textures are repeated, also where samplers clamp or mirror them");
            if (info.whole("texCoord", 0, 255) != 0 || info.hasExtension("KHR_texture_transform"))
                warnOnce(warnings,
                         "textures with their own coordinates are left out: only TEXCOORD_0 is read");
            else if (named.has("source"))
                m.baseColorImage = int(named.reference("source", "images", top.count("images")));
            else
                warnOnce(warnings, "textures that are neither PNG nor JPEG are left out");
        }
    }
    for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"}) texture(material, key);
    double emission[3] = {0, 0, 0};
    material.numbers("emissiveFactor", emission, 3, 0, 1e30);
    if (std::ranges::any_of(emission, [](double e) { return e > 0; }))
        warnOnce(warnings, "emission is left out");
    if (material.text("alphaMode", "OPAQUE") != "OPAQUE")
        warnOnce(warnings, "transparency is left out: all surfaces are opaque (alphaMode)");
    const auto with = [&](const char* name, auto&& read) {
        if (material.hasExtension(name)) read(material.extension(name));
    };
    with("KHR_materials_ior", [&](const GltfValue& e) {
        m.ior = e.number("ior", 1.5, 0, 100);
        if (m.ior != 0 && m.ior < 1) e["ior"].fail("is below 1");
    });
    with("KHR_materials_specular", [&](const GltfValue& e) {
        m.specular = e.number("specularFactor", 1, 0, 1);
        texture(e, "specularTexture");
    });
    with("KHR_materials_transmission", [&](const GltfValue& e) {
        m.transmission = e.number("transmissionFactor", 0, 0, 1);
        texture(e, "transmissionTexture");
    });
    with("KHR_materials_diffuse_transmission", [&](const GltfValue& e) {
        m.diffuseTransmission = e.number("diffuseTransmissionFactor", 0, 0, 1);
        e.numbers("diffuseTransmissionColorFactor", &m.diffuseTransmissionColor.x, 3, 0, 1);
        texture(e, "diffuseTransmissionTexture"), texture(e, "diffuseTransmissionColorTexture");
    });
    with("KHR_materials_volume", [&](const GltfValue& e) {
        m.thickness = e.number("thicknessFactor", 0, 0, 1e6);
        m.attenuationDistance = e.number("attenuationDistance", INFINITY, 1e-9, INFINITY);
        e.numbers("attenuationColor", &m.attenuationColor.x, 3, 0, 1);
        texture(e, "thicknessTexture");
    });
    for (const char* name :
         {"KHR_materials_scatter", "KHR_materials_volume_scatter"})  // the draft's name, the later one
        with(name, [&](const GltfValue& e) {
            Triple color(0);
            e.numbers("multiscatterColor", &color.x, 3, 0, 1);
            e.numbers("multiscatterColorFactor", &color.x, 3, 0, 1);
            m.multiscatterColor = color;
            m.scatterAnisotropy = e.number("scatterAnisotropy", 0, -1, 1);
            texture(e, "multiscatterColorTexture");
        });
    with("KHR_materials_pbrSpecularGlossiness", [&](const GltfValue& e) {
        setBaseColor(e, "diffuseFactor");
        m.metallic = 0;
        m.roughness = 1 - e.number("glossinessFactor", 1, 0, 1);
        texture(e, "diffuseTexture");
    });
    return m;
}

using Matrix = Imath::M44d;              // of row vectors: as glTF's columns lie in memory
constexpr size_t mostMaterials = 255;    // ids of a material channel
constexpr double mostCoordinate = 1e30;  // metres, of a node or its axes

// Where the axes go.
Triple axis(const Matrix& m, int i) {
    return {m[i][0], m[i][1], m[i][2]};
}

// Transforms a normal by the inverse transpose of the upper left 3 x 3 matrix, times its determinant's size:
// by its cofactors, which a mirrored part turns inside out.
Triple turned(const Matrix& m, const Triple& n, bool mirrored) {
    const Triple x = axis(m, 0), y = axis(m, 1), z = axis(m, 2);
    const Triple by = n.x * y.cross(z) + n.y * z.cross(x) + n.z * x.cross(y);
    return mirrored ? -by : by;
}

Triple unit(const Triple& v, const Triple& otherwise) {
    const double length = v.length();
    return length > 1e-30 && std::isfinite(length) ? v / length : otherwise;
}

// -z of a node, along which its camera or light looks.
Triple forwardOf(const Matrix& m) {
    return unit(-axis(m, 2), {0, 0, -1});
}

Matrix localOf(const GltfValue& node) {
    Matrix m;
    if (node.has("matrix")) {
        node.numbers("matrix", m.getValue(), 16, -1e12, 1e12);
        for (int i = 0; i < 4; ++i) m[i][3] = i == 3;  // nodes have no perspective
        return m;
    }
    Triple move(0), scale(1);
    double turn[4] = {0, 0, 0, 1};
    node.numbers("translation", &move.x, 3, -1e12, 1e12);
    node.numbers("rotation", turn, 4, -2, 2);
    node.numbers("scale", &scale.x, 3, -1e12, 1e12);
    const Imath::Quatd rotation(turn[3], turn[0], turn[1], turn[2]);
    return m.setScale(scale) * rotation.normalized().toMatrix44() * Matrix().setTranslation(move);
}

// A light of KHR_lights_punctual, of a node with this matrix. Lux, or candela, which is lux at one metre.
// PelLight.color is irradiance / pi, for lamps at one millimetre.
SceneLight readGltfLight(const GltfValue& light, const Matrix& m) {
    const std::string& type = light["type"].text();
    const auto kind = std::ranges::find(lightTypes, type);
    if (kind == std::end(lightTypes))
        light["type"].fail("is '" + type.substr(0, 20) + "'; directional, point or spot would be right");
    SceneLight scene;
    PelLight& l = scene.light;
    l.type = PelLightType(kind - lightTypes);
    Triple color(1);
    light.numbers("color", &color.x, 3, 0, 1e6);
    const double intensity = light.number("intensity", 1, 0, 1e12) / std::numbers::pi,
                 at = l.type == PEL_LIGHT_DIRECTIONAL ? 1 : 1e6;
    const Triple place = m.translation(), forward = forwardOf(m);
    for (int c = 0; c < 3; ++c) {
        l.color[c] = float(color[c] * intensity * at);
        l.position[c] = float(place[c]);
        l.toLight[c] = float(-forward[c]);
        l.spotDirection[c] = float(forward[c]);
    }
    l.range = float(light.number("range", 0, 0, 1e12));
    double inner = 0, outer = std::numbers::pi / 4;
    if (light.has("spot")) {
        const GltfValue spot = light["spot"];
        inner = spot.number("innerConeAngle", 0, 0, std::numbers::pi / 2);
        outer = spot.number("outerConeAngle", outer, 0, std::numbers::pi / 2);
        if (inner > outer) spot.fail("has an inner cone wider than its outer one");
    }
    l.spotCosInner = float(std::cos(inner));
    l.spotCosOuter = float(std::cos(std::max(outer, inner + 1e-3)));
    return scene;
}

class Builder {
  public:
    explicit Builder(const GltfDocument& document) : document_(document), root_(document.root()) {}

    GltfScene build() {
        scene_.mesh.source = document_.path();
        world_.resize(root_.count("nodes"));
        for (const size_t node : roots()) locate(node, Matrix(), 0);
        for (const size_t node : order_) enter(node);
        if (scene_.mesh.triangles.empty()) throw FileError(document_.path(), "has no triangles in its scene");
        if (!uvsAnywhere_) scene_.mesh.uvs.clear();
        completeNormals();
        for (const std::string& w : warnings_) scene_.mesh.warnings.push_back(w);
        return std::move(scene_);
    }

  private:
    std::vector<size_t> roots() const {
        std::vector<size_t> found;
        if (root_.count("scenes")) {
            const GltfValue scene =
                root_.has("scene") ? root_.element("scenes", root_, "scene") : root_["scenes"][size_t{0}];
            for (size_t i = 0; i < scene.count("nodes"); ++i) found.push_back(nodeIndex(scene["nodes"][i]));
            return found;
        }
        // Without a scene, the roots are the nodes that are no child of another node.
        std::vector<bool> below(root_.count("nodes"));
        for (size_t n = 0; n < below.size(); ++n) {
            const GltfValue node = root_["nodes"][n];
            for (size_t i = 0; i < node.count("children"); ++i) below[nodeIndex(node["children"][i])] = true;
        }
        for (size_t n = 0; n < below.size(); ++n)
            if (!below[n]) found.push_back(n);
        return found;
    }

    size_t nodeIndex(const GltfValue& value) const { return value.index("nodes", root_.count("nodes")); }

    // Finds the matrices of a node and of all below it; skins need those of nodes anywhere.
    void locate(size_t index, const Matrix& above, int depth) {
        const GltfValue node = root_["nodes"][index];
        if (depth > 500) node.fail("is more than 500 nodes deep");
        if (world_[index]) node.fail("is a child of two nodes, or of itself");
        const Matrix m = localOf(node) * above;
        for (int i = 0; i < 16; ++i)
            if (!(std::abs(m[i / 4][i % 4]) <= mostCoordinate))
                node.fail("is placed or scaled beyond what a float holds");
        world_[index] = m;
        order_.push_back(index);
        for (size_t i = 0; i < node.count("children"); ++i)
            locate(nodeIndex(node["children"][i]), m, depth + 1);
    }

    void enter(size_t index) {
        const GltfValue node = root_["nodes"][index];
        const Matrix& m = *world_[index];
        if (node.has("mesh")) {
            std::vector<Matrix> joints;
            if (node.has("skin")) joints = jointsOf(root_.element("skins", node, "skin"));
            for (const Part& part : partsOf(node.reference("mesh", "meshes", root_.count("meshes"))))
                place(part, m, joints);
        }
        if (node.has("camera")) addCamera(root_.element("cameras", node, "camera"), m);
        constexpr const char* lights = "KHR_lights_punctual";
        if (node.hasExtension(lights))
            scene_.lights.push_back(
                readGltfLight(root_.extension(lights).element("lights", node.extension(lights), "light"), m));
    }

    // The matrices of a skin's joints, from the mesh's coordinates at binding to the world, in the pose that
    // the nodes have without animation [glTF 2.0, 3.7.3].
    std::vector<Matrix> jointsOf(const GltfValue& skin) const {
        const size_t count = skin["joints"].size();
        std::vector<float> inverse;
        if (skin.has("inverseBindMatrices")) {
            inverse = document_.floats(skin, "inverseBindMatrices", 16);
            if (inverse.size() < 16 * count)
                skin["inverseBindMatrices"].fail(
                    concat("has ", inverse.size() / 16, " elements, but there are ", count, " joints"));
        }
        std::vector<Matrix> joints(count);
        for (size_t j = 0; j < count; ++j) {
            const GltfValue joint = skin["joints"][j];
            const std::optional<Matrix>& world = world_[nodeIndex(joint)];
            if (!world) joint.fail("is a node outside of the scene");
            if (!inverse.empty()) std::copy_n(&inverse[16 * j], 16, joints[j].getValue());
            joints[j] = joints[j] * *world;
        }
        return joints;
    }

    void addCamera(const GltfValue& camera, const Matrix& m) {
        if (!camera.has("perspective")) return warn("orthographic cameras are left out");
        const GltfValue p = camera["perspective"];
        GltfCamera c;
        c.verticalFov = p["yfov"].number(1e-3, 3.14);
        c.aspect = p.number("aspectRatio", 0, 1e-3, 1e3);
        c.position = m.translation();
        c.forward = forwardOf(m);
        c.up = unit(axis(m, 1), {0, 1, 0});
        // Sheared axes can coincide; any other direction will do then.
        if (std::abs(c.up.dot(c.forward)) > 0.999999)
            c.up = std::abs(c.forward[1]) < 0.9 ? Triple{0, 1, 0} : Triple{0, 0, 1};
        scene_.cameras.push_back(c);
    }

    // A primitive with triangles, in the coordinates of its mesh.
    struct Part {
        GltfValue primitive;
        std::vector<float> positions, normals, uvs;  // normals and uvs may be empty
        std::vector<float> joints, weights;          // four per vertex, or empty
        std::vector<uint32_t> triangles;             // never empty
        uint32_t material;
    };

    // Three indices per triangle [glTF 2.0, 3.7.2.1].
    std::vector<uint32_t> trianglesOf(const GltfValue& primitive, uint64_t mode, size_t vertices) const {
        std::vector<uint32_t> list;
        if (primitive.has("indices")) {
            list = document_.indices(primitive, "indices");
        } else {
            list.resize(vertices);
            std::iota(list.begin(), list.end(), 0u);
        }
        for (size_t i = 0; i < list.size(); ++i)
            if (list[i] >= vertices)
                primitive.fail(
                    concat("has index ", list[i], " at position ", i, ", but ", vertices, " vertices"));
        if (mode == 4) {
            if (list.size() % 3)
                primitive.fail(concat("has ", list.size(), " indices, which is no multiple of 3"));
            return list;
        }
        std::vector<uint32_t> triangles;
        for (size_t i = 2; i < list.size(); ++i) {
            const bool fan = mode == 6, odd = i % 2 == 1;
            const uint32_t a = fan ? list[0] : list[odd ? i - 1 : i - 2],
                           b = fan ? list[i - 1] : list[odd ? i - 2 : i - 1];
            triangles.insert(triangles.end(), {a, b, list[i]});
        }
        return triangles;
    }

    // The parts of a mesh, decoded once for all nodes that use it.
    const std::vector<Part>& partsOf(size_t mesh) {
        const auto [found, fresh] = parts_.try_emplace(mesh);
        if (!fresh) return found->second;
        const GltfValue primitives = root_["meshes"][mesh]["primitives"];
        for (size_t i = 0; i < primitives.size(); ++i) {
            const GltfValue primitive = primitives[i];
            const uint64_t mode = primitive.whole("mode", 4, 6);
            if (mode < 4) {
                warn("points and lines are left out");
                continue;
            }
            if (primitive.hasExtension("KHR_draco_mesh_compression"))
                primitive.fail("is compressed by Draco: write the scene uncompressed");
            if (primitive.has("targets")) warn("morph targets are left out");
            const GltfValue attributes = primitive["attributes"];
            Part part{primitive, document_.floats(attributes, "POSITION", 3), {}, {}, {}, {}, {}, 0};
            const size_t vertices = part.positions.size() / 3;
            checkSceneSize(primitive, vertices, 0);
            part.triangles = trianglesOf(primitive, mode, vertices);
            if (part.triangles.empty()) continue;
            if (attributes.has("COLOR_0")) warn("vertex colours are left out");
            if (attributes.has("NORMAL")) part.normals = sized(attributes, "NORMAL", 3, vertices);
            if (attributes.has("TEXCOORD_0")) part.uvs = sized(attributes, "TEXCOORD_0", 2, vertices);
            if (attributes.has("JOINTS_0")) {
                part.joints = sized(attributes, "JOINTS_0", 4, vertices);
                part.weights = sized(attributes, "WEIGHTS_0", 4, vertices);
                if (attributes.has("JOINTS_1")) warn("of a vertex's joints the first four are used");
            }
            part.material = materialIndex(primitive);
            found->second.push_back(std::move(part));
        }
        return found->second;
    }

    void checkSceneSize(const GltfValue& primitive, size_t vertices, size_t indices) const {
        const double bytes = double(scene_.mesh.vertexCount() + vertices) * 32 +
                             double(scene_.mesh.triangles.size() + indices) * 8;
        if (bytes > double(inputLimit()))
            primitive.fail("makes the scene too large: " + tooLarge(bytes, inputLimit()));
    }

    // The sum of the joints' matrices by the weights of vertex v; `m` if it has none.
    static Matrix skinned(const Part& part, const std::vector<Matrix>& joints, size_t v, const Matrix& m) {
        Matrix sum(0.0);
        double weights = 0;
        for (size_t k = 4 * v; k < 4 * v + 4; ++k) {
            const double weight = part.weights[k];
            if (!(weight > 0)) continue;
            const float joint = part.joints[k];
            if (!(joint >= 0 && joint < float(joints.size())))
                part.primitive["attributes"]["JOINTS_0"].fail(
                    concat("names joint ", joint, " of ", joints.size(), ", of vertex ", v));
            sum += joints[size_t(joint)] * weight, weights += weight;
        }
        return weights > 0 ? sum * (1 / weights) : m;
    }

    // Adds a part to the scene's mesh, transformed by the node's matrix or, with `joints`, by its skin.
    void place(const Part& part, const Matrix& node, const std::vector<Matrix>& joints) {
        const std::vector<float>&positions = part.positions, &normals = part.normals, &uvs = part.uvs;
        const size_t vertices = positions.size() / 3, first = scene_.mesh.vertexCount();
        checkSceneSize(part.primitive, vertices, part.triangles.size());
        MeshData& mesh = scene_.mesh;
        const bool bound = !joints.empty() && !part.joints.empty();
        const bool mirrored = (bound ? joints[0] : node).determinant() < 0;
        bool bad = false;
        for (size_t v = 0; v < vertices; ++v) {
            const Matrix m = bound ? skinned(part, joints, v, node) : node;
            const Triple p = vectorOf(&positions[3 * v]) * m,
                         n = normals.empty()
                                 ? Triple(0)
                                 : unit(turned(m, vectorOf(&normals[3 * v]), mirrored), Triple(0));
            bad |= n == Triple(0);
            withoutNormal_.push_back(n == Triple(0));
            for (int c = 0; c < 3; ++c) {
                if (!std::isfinite(float(p[c])))
                    part.primitive["attributes"]["POSITION"].fail(
                        concat("has a position that is not finite, of vertex ", v));
                mesh.positions.push_back(float(p[c]));
                mesh.normals.push_back(float(n[c]));
            }
            for (size_t c = 0; c < 2; ++c) {
                const float u = uvs.empty() ? 0 : uvs[2 * v + c];
                mesh.uvs.push_back(std::isfinite(u) ? u : 0);
            }
        }
        if (bad && !normals.empty())
            warn("some normals are zero or not finite: these are made from the triangles");
        size_t against = 0;  // triangles that face the other side than their normals
        if (uvs.empty() && scene_.materials[part.material].baseColorImage >= 0)
            warn("some parts have a texture and no texture coordinates: they get its first texel");
        uvsAnywhere_ |= !uvs.empty();
        for (size_t i = 0; i < part.triangles.size(); i += 3) {
            std::array<size_t, 3> corner;
            for (size_t k = 0; k < 3; ++k)
                corner[k] = first + part.triangles[i + (mirrored && k ? 3 - k : k)];
            mesh.triangles.insert(mesh.triangles.end(), corner.begin(), corner.end());
            const auto at = [&](size_t k) { return vectorOf(&mesh.positions[3 * corner[k]]); };
            const auto normal = [&](size_t k) { return vectorOf(&mesh.normals[3 * corner[k]]); };
            against += (at(1) - at(0)).cross(at(2) - at(0)).dot(normal(0) + normal(1) + normal(2)) < 0;
        }
        if (6 * against > part.triangles.size())
            warn(
                "most normals of a part point to the side from which the corners of its triangles run "
                "clockwise: one of both is inside out");
        scene_.materialOf.insert(scene_.materialOf.end(), part.triangles.size() / 3, part.material);
    }

    // Makes the normals of vertices without one from the triangles at such vertices.
    void completeNormals() {
        MeshData& mesh = scene_.mesh;
        if (std::ranges::count(withoutNormal_, true) == 0) return;
        MeshData made;
        made.positions = mesh.positions;
        for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
            const std::span corners(&mesh.triangles[t], 3);
            if (std::ranges::any_of(corners, [&](uint32_t v) { return withoutNormal_[v]; }))
                made.triangles.insert(made.triangles.end(), corners.begin(), corners.end());
        }
        computeNormals(made);
        for (size_t v = 0; v < withoutNormal_.size(); ++v)
            if (withoutNormal_[v]) std::copy_n(&made.normals[3 * v], 3, &mesh.normals[3 * v]);
    }

    std::vector<float> sized(const GltfValue& attributes, const char* key, size_t components,
                             size_t vertices) const {
        std::vector<float> values = document_.floats(attributes, key, components);
        if (values.size() != vertices * components)
            attributes[key].fail(
                concat("has ", values.size() / components, " elements, but POSITION has ", vertices));
        return values;
    }

    uint32_t materialIndex(const GltfValue& primitive) {
        const size_t count = root_.count("materials");
        const size_t index =
            primitive.has("material") ? primitive.reference("material", "materials", count) : count;
        const auto [at, fresh] = known_.try_emplace(index, uint32_t(scene_.materials.size()));
        if (!fresh) return at->second;
        if (scene_.materials.size() == mostMaterials)
            throw FileError(document_.path(), concat("uses more than ", mostMaterials, " materials"));
        GltfMaterial m;
        if (index < count) m = readGltfMaterial(document_, root_["materials"][index], warnings_);
        if (m.name.empty()) m.name = index < count ? concat("material_", index) : "default";
        if (m.baseColorImage >= 0) {
            const auto [image, unread] = images_.try_emplace(m.baseColorImage, int(scene_.images.size()));
            if (unread) scene_.images.push_back(document_.image(size_t(m.baseColorImage)));
            m.baseColorImage = image->second;
        }
        scene_.materials.push_back(std::move(m));
        return at->second;
    }

    void warn(const std::string& text) { warnOnce(warnings_, text); }

    const GltfDocument& document_;
    const GltfValue root_;
    GltfScene scene_;
    std::vector<std::optional<Matrix>> world_;   // by node; none outside of the scene
    std::vector<size_t> order_;                  // of nodes, each before those below it
    std::map<size_t, std::vector<Part>> parts_;  // by mesh
    std::map<size_t, uint32_t> known_;
    std::map<int, int> images_;
    std::vector<std::string> warnings_;
    std::vector<bool> withoutNormal_;  // by vertex of the scene
    bool uvsAnywhere_ = false;
};

}  // namespace

GltfScene decodeGltf(const std::string& path, const std::string& bytes, const GltfResource& resource) {
    const GltfDocument document(path, bytes, resource);
    return Builder(document).build();
}

GltfScene readGltf(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    return decodeGltf(path, readWholeFile(path), [&](const std::string& relative) {
        return readWholeFile((folder / relative).string());
    });
}

}  // namespace pellucid::io
