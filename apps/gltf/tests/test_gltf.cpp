// glTF: geometry, nodes, materials, cameras and lights of small files made here, and files that are wrong.
#include <nlohmann/json.hpp>

#include "gltf/gltf_import.h"
#include "gltf/tests/gltf_bytes.h"
#include "io/lut/profile_file.h"

using namespace pellucid::io;
using namespace nlohmann::literals;
using gltf::squareBuffer;
using nlohmann::json;

namespace {

// JSON pointers and the values to set there; null: removes the value.
using Edits = std::vector<std::pair<std::string, json>>;

json edited(const Edits& edits) {
    json scene = json::parse(gltf::squareJson());
    for (const auto& [where, value] : edits) {
        const json::json_pointer at(where);
        if (value.is_null())
            scene[at.parent_pointer()].erase(at.back());
        else
            scene[at] = value;
    }
    return scene;
}

// Appends values to the buffer, as accessor `index` with a view of its own.
template <class T>
void append(Edits& edits, std::string& buffer, size_t index, const std::string& type,
            const std::vector<T>& values) {
    const std::string bytes = gltf::bytesOf(values), number = std::to_string(index);
    const size_t components = type == "MAT4" ? 16 : size_t(type[3] - '0');
    edits.push_back({"/bufferViews/" + number,
                     {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}}});
    edits.push_back({"/accessors/" + number,
                     {{"bufferView", index},
                      {"componentType", sizeof(T) == 1 ? 5121 : 5126},
                      {"count", values.size() / components},
                      {"type", type}}});
    buffer += bytes;
    edits.push_back({"/buffers/0/byteLength", buffer.size()});
}

std::string square(const Edits& edits = {}, const std::string& buffer = squareBuffer()) {
    return gltf::glb(edited(edits).dump(), buffer);
}

GltfScene decoded(const std::string& bytes) {
    return decodeGltf("s.glb", bytes,
                      [](const std::string& name) -> std::string { throw FileError(name, "is not there"); });
}

void expectError(const std::string& bytes, const std::vector<std::string>& words) {
    std::string said = "no error";
    try {
        decoded(bytes);
    } catch (const FileError& e) {
        said = e.what();
    }
    for (const std::string& word : words)
        EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
}

std::vector<float> position(const GltfScene& s, size_t v) {
    return {s.mesh.positions[3 * v], s.mesh.positions[3 * v + 1], s.mesh.positions[3 * v + 2]};
}

// The cross product of two edges of a triangle, along its first vertex's normal.
double facing(const MeshData& m, size_t triangle) {
    const float* p[3];
    for (size_t k = 0; k < 3; ++k) p[k] = &m.positions[3 * m.triangles[triangle + k]];
    double sum = 0;
    for (size_t c = 0; c < 3; ++c) {
        const size_t d = (c + 1) % 3, e = (c + 2) % 3;
        sum += m.normals[3 * m.triangles[triangle] + c] * (double(p[1][d] - p[0][d]) * (p[2][e] - p[0][e]) -
                                                           double(p[1][e] - p[0][e]) * (p[2][d] - p[0][d]));
    }
    return sum;
}

using Indices = std::vector<uint32_t>;
constexpr const char *mode = "/meshes/0/primitives/0/mode", *uri = "/buffers/0/uri";

json numbers(size_t count) {
    json list = json::array();
    for (size_t i = 0; i < count; ++i) list.push_back(i);
    return list;
}

}  // namespace

TEST(Gltf, ReadsASquare) {
    const GltfScene s = decoded(square());
    EXPECT_EQ(s.mesh.vertexCount(), 4u);
    EXPECT_EQ(s.mesh.triangles, (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(s.mesh.uvs, (std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}));
    EXPECT_EQ(position(s, 2), (std::vector<float>{1, 1, 0}));
    EXPECT_FLOAT_EQ(s.mesh.normals[2], 1);  // made from the triangles
    EXPECT_EQ(s.materialOf, (Indices{0, 0}));
    ASSERT_EQ(s.materials.size(), 1u);
    EXPECT_TRUE(s.mesh.warnings.empty());
}

TEST(Gltf, JsonWithABufferInTextOrInAFile) {
    const std::string raw = squareBuffer();
    const GltfScene text =
        decoded(edited({{uri, "data:application/octet-stream;base64," + gltf::base64(raw)}}).dump());
    EXPECT_EQ(text.mesh.positions, decoded(square()).mesh.positions);
    EXPECT_EQ(text.mesh.triangles, decoded(square()).mesh.triangles);
    std::string asked;
    const GltfScene file = decodeGltf("s.gltf", edited({{uri, "my%20parts/a.bin"}}).dump(),
                                      [&](const std::string& name) { return asked = name, raw; });
    EXPECT_EQ(asked, "my parts/a.bin");
    (void)decodeGltf("s.gltf", edited({{uri, "./parts/./a.bin"}}).dump(),
                     [&](const std::string& name) { return asked = name, raw; });
    EXPECT_EQ(asked, "parts/a.bin");
    EXPECT_EQ(file.mesh.positions, text.mesh.positions);
    for (const char* wrong : {"/etc/passwd", "../a.bin", "a/../../b", "file:///etc/passwd", "http://x/y",
                              "%2e%2e/a", "a\\b", "", "a//b", ".", "./../a.bin"})
        expectError(edited({{uri, wrong}}).dump(), {"buffers[0].uri"});
}

TEST(Gltf, NodesMoveTurnScaleAndMirror) {
    const GltfScene s = decoded(square({{"/nodes", R"([{"children": [1, 2], "translation": [10, 0, 0]},
        {"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678], "scale": [2, 1, 1]},
        {"mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1]}])"_json}}));
    ASSERT_EQ(s.mesh.vertexCount(), 8u);
    EXPECT_NEAR(position(s, 1)[0], 10, 1e-6);  // (2, 0, 0) a quarter turn about z, moved
    EXPECT_NEAR(position(s, 1)[1], 2, 1e-6);
    EXPECT_EQ(position(s, 5), (std::vector<float>{9, 0, 5}));
}

// Two joints. The second was bound at (1, 0, 0) and is turned there by a quarter about z. The node of the
// mesh moves too, which a skin ignores.
TEST(Gltf, SkinsTakeThePoseOfTheirJoints) {
    std::string buffer = squareBuffer();
    Edits edits = {{"/meshes/0/primitives/0/attributes/JOINTS_0", 3},
                   {"/meshes/0/primitives/0/attributes/WEIGHTS_0", 4},
                   {"/skins", R"([{"joints": [1, 2], "inverseBindMatrices": 5}])"_json},
                   {"/scenes/0/nodes", {0, 1}},
                   {"/nodes", R"([{"mesh": 0, "skin": 0, "translation": [100, 0, 0]},
                       {"translation": [0, 0, 7], "children": [2]},
                       {"translation": [1, 0, 0], "rotation": [0, 0, 0.70710678, 0.70710678]}])"_json}};
    append<uint8_t>(edits, buffer, 3, "VEC4", {0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
    append<float>(edits, buffer, 4, "VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, .5, .5, 0, 0});
    append<float>(edits, buffer, 5, "MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                             1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1});
    const GltfScene s = decoded(square(edits, buffer));
    EXPECT_TRUE(s.mesh.warnings.empty());
    const float expected[4][3] = {{0, 0, 7}, {1, 0, 7}, {0, 0, 7}, {0, 0, 7}};
    for (size_t v = 0; v < 4; ++v)
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(position(s, v)[c], expected[v][c], 1e-6) << v << " " << c;
    edits.push_back({"/skins/0/joints", {1}});
    expectError(square(edits, buffer), {"JOINTS_0", "names joint 1 of 1, of vertex 1"});
    edits.back() = {"/skins/0/joints", {1, 2, 2}};
    expectError(square(edits, buffer),
                {"skins[0].inverseBindMatrices", "has 2 elements, but there are 3 joints"});
    edits.back() = {"/scenes/0/nodes", {0}};
    expectError(square(edits, buffer), {"skins[0].joints[0]", "outside of the scene"});
}

TEST(Gltf, WhatIsLeftOutIsSaid) {
    const auto expectSaid = [](const Edits& edits, const char* word) {
        const GltfScene s = decoded(square(edits));
        ASSERT_EQ(s.mesh.warnings.size(), word ? 1u : 0u) << (word ? word : s.mesh.warnings[0]);
        if (word) {
            EXPECT_NE(s.mesh.warnings[0].find(word), std::string::npos) << s.mesh.warnings[0];
        }
    };
    expectSaid({{"/meshes/0/primitives/0/attributes/COLOR_0", 0}}, "vertex colours");
    const auto of = [](const json& material, const json& sampler = json::object()) {
        return Edits{{"/meshes/0/primitives/0/material", 0},
                     {"/materials", json::array({material})},
                     {"/images", R"([{"uri": "data:image/png;base64,AAAA"}])"_json},
                     {"/samplers", json::array({sampler})},
                     {"/textures", R"([{"source": 0, "sampler": 0}])"_json}};
    };
    expectSaid(of(R"({"emissiveFactor": [0, 0.5, 0]})"_json), "emission");
    expectSaid(of(R"({"alphaMode": "MASK"})"_json), "alphaMode");
    expectSaid(of(R"({"alphaMode": "OPAQUE", "emissiveFactor": [0, 0, 0]})"_json), nullptr);
    const json textured = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})"_json;
    expectSaid(of(textured, R"({"wrapS": 10497})"_json), nullptr);
    expectSaid(of(textured, R"({"wrapS": 33071})"_json), "clamp or mirror");
    expectSaid(of(textured, R"({"wrapT": 33648})"_json), "clamp or mirror");
}

TEST(Gltf, WithoutASceneAllRootsAreShown) {
    const GltfScene s = decoded(square({{"/nodes", R"([{"mesh": 0, "translation": [1, 0, 0]},
        {"children": [0], "translation": [10, 0, 0]}, {"mesh": 0}])"_json},
                                        {"/scenes", nullptr}}));
    ASSERT_EQ(s.mesh.vertexCount(), 8u) << "a child is shown by its parent alone";
    EXPECT_EQ(position(s, 0), (std::vector<float>{11, 0, 0}));
    EXPECT_EQ(position(s, 4), (std::vector<float>{0, 0, 0}));
}

// Whatever the rotation of a node, its triangles face in the direction of its normals, mirrored or not, and
// whether the normals are in the file or made from the triangles.
TEST(Gltf, TurnedAndMirroredFacesKeepTheirFront) {
    for (const json& turn : R"([[0, 0, 0, 1], [0, 0, 0.70710678, 0.70710678], [0, 0.70710678, 0, 0.70710678],
             [0.70710678, 0, 0, 0.70710678], [0.5, 0.5, 0.5, 0.5], [0.1826, 0.3651, 0.5477, 0.7303]])"_json)
        for (const json& scale : "[[1, 1, 1], [-1, 1, 1], [1, -2, 1], [1, 1, -3], [-1, -1, -1]]"_json) {
            const Edits made{{"/nodes/0/rotation", turn}, {"/nodes/0/scale", scale}};
            const auto withNormals = [&](float z) {
                Edits given = made;
                std::string buffer = squareBuffer();
                append<float>(given, buffer, 3, "VEC3", {0, 0, z, 0, 0, z, 0, 0, z, 0, 0, z});
                given.push_back({"/meshes/0/primitives/0/attributes/NORMAL", 3});
                return decoded(square(given, buffer)).mesh;
            };
            for (const MeshData& m : {decoded(square(made)).mesh, withNormals(1)}) {
                EXPECT_TRUE(m.warnings.empty()) << turn << " times " << scale;
                for (size_t t = 0; t < m.triangles.size(); t += 3)
                    EXPECT_GT(facing(m, t), 0.9) << turn << " times " << scale;
            }
            const MeshData inside = withNormals(-1);
            ASSERT_EQ(inside.warnings.size(), 1u) << turn << " times " << scale;
            EXPECT_NE(inside.warnings[0].find("inside out"), std::string::npos);
        }
}

// A part with normals and texture coordinates keeps them beside one without, and beside normals of length 0.
TEST(Gltf, PartsWithoutNormalsOrCoordinatesLeaveThoseOfOthers) {
    const float leaning[] = {0.6f, 0, 0.8f};
    const auto withParts = [&](const json& primitives) {
        Edits edits{
            {"/meshes/0/primitives", primitives},
            {"/materials", R"([{}, {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}])"_json}};
        std::string buffer = squareBuffer();
        append<float>(edits, buffer, 3, "VEC3", {.6f, 0, .8f, .6f, 0, .8f, .6f, 0, .8f, .6f, 0, .8f});
        append<float>(edits, buffer, 4, "VEC3", {0, 0, 0, .6f, 0, .8f, .6f, 0, .8f, .6f, 0, .8f});
        return decoded(square(edits, buffer));
    };
    const json whole = R"({"attributes": {"POSITION": 0, "NORMAL": 3, "TEXCOORD_0": 1}, "indices": 2})"_json,
               bare = R"({"attributes": {"POSITION": 0}, "indices": 2, "material": 1})"_json,
               holed = R"({"attributes": {"POSITION": 0, "NORMAL": 4}, "indices": 2})"_json;
    const GltfScene both = withParts(json::array({whole, bare}));
    EXPECT_EQ(std::vector(both.mesh.uvs.begin(), both.mesh.uvs.begin() + 8), decoded(square()).mesh.uvs);
    for (size_t v = 0; v < 8; ++v)
        for (size_t c = 0; c < 3; ++c)
            EXPECT_EQ(both.mesh.normals[3 * v + c], v < 4 ? leaning[c] : float(c == 2)) << v;
    EXPECT_TRUE(both.mesh.warnings.empty());
    EXPECT_TRUE(withParts(json::array({bare})).mesh.uvs.empty());
    const GltfScene some = withParts(json::array({holed}));
    for (size_t v = 0; v < 4; ++v)
        for (size_t c = 0; c < 3; ++c)
            EXPECT_EQ(some.mesh.normals[3 * v + c], v ? leaning[c] : float(c == 2)) << v;
    EXPECT_EQ(
        some.mesh.warnings,
        std::vector<std::string>{"some normals are zero or not finite: these are made from the triangles"});
}

TEST(Gltf, StripsFansAndNoIndices) {
    const auto triangles = [](const Edits& edits) { return decoded(square(edits)).mesh.triangles; };
    EXPECT_EQ(triangles({{mode, 5}}), (Indices{0, 1, 2, 2, 1, 0, 2, 0, 2, 2, 0, 3}));  // of 0 1 2 0 2 3
    EXPECT_EQ(triangles({{mode, 6}}), (Indices{0, 1, 2, 0, 2, 0, 0, 0, 2, 0, 2, 3}));
    const char* indices = "/meshes/0/primitives/0/indices";
    EXPECT_EQ(triangles({{mode, 6}, {indices, nullptr}}), (Indices{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(triangles({{mode, 5}, {indices, nullptr}}), (Indices{0, 1, 2, 2, 1, 3}));
    expectError(square({{mode, 1}}), {"has no triangles"});
}

TEST(Gltf, SparseAndNormalisedAccessors) {
    // Vertex 1 is moved to (7, 8, 9).
    const Edits edits{{"/accessors/0/sparse", R"({"count": 1, "indices": {"bufferView": 3,
        "componentType": 5125}, "values": {"bufferView": 3, "byteOffset": 4}})"_json},
                      {"/buffers/0/byteLength", 108},
                      {"/bufferViews/3", R"({"buffer": 0, "byteOffset": 92, "byteLength": 16})"_json}};
    const std::string moved = gltf::bytesOf<float>({7, 8, 9});
    const GltfScene s = decoded(square(edits, squareBuffer() + gltf::bytesOf<uint32_t>({1}) + moved));
    EXPECT_EQ(position(s, 1), (std::vector<float>{7, 8, 9}));
    EXPECT_EQ(position(s, 2), (std::vector<float>{1, 1, 0}));
    expectError(square(edits, squareBuffer() + gltf::bytesOf<uint32_t>({4}) + moved),
                {"accessors[0].sparse.indices", "4 of 4"});
    // Bytes as fractions of 255: KHR_mesh_quantization.
    std::string buffer = squareBuffer();
    buffer[50] = char(255), buffer[51] = char(51);
    const std::vector<float> uvs =
        decoded(square({{"/accessors/1/componentType", 5121}, {"/accessors/1/normalized", true}}, buffer))
            .mesh.uvs;
    EXPECT_FLOAT_EQ(uvs[2], 1);
    EXPECT_FLOAT_EQ(uvs[3], 0.2f);
}

TEST(Gltf, CamerasAndLights) {
    const GltfScene s = decoded(
        square({{"/nodes", R"([{"mesh": 0, "children": [1, 2, 3]}, {"camera": 0, "translation": [0, 0, 5]},
            {"extensions": {"KHR_lights_punctual": {"light": 0}},
             "rotation": [-0.70710678, 0, 0, 0.70710678]},
            {"extensions": {"KHR_lights_punctual": {"light": 1}}, "translation": [0, 2, 0]}])"_json},
                {"/cameras", R"([{"type": "perspective",
            "perspective": {"yfov": 0.5, "znear": 0.1, "aspectRatio": 2}}])"_json},
                {"/extensions", R"({"KHR_lights_punctual": {"lights": [
            {"type": "directional", "intensity": 3, "color": [1, 0.5, 0]},
            {"type": "spot", "intensity": 10, "range": 4,
             "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}}]}})"_json}}));
    ASSERT_EQ(s.cameras.size(), 1u);
    EXPECT_EQ(s.cameras[0].position, (Triple{0, 0, 5}));
    EXPECT_EQ(s.cameras[0].verticalFov, 0.5);
    EXPECT_EQ(s.cameras[0].aspect, 2);
    ASSERT_EQ(s.lights.size(), 2u);
    const PelLight &sun = s.lights[0].light, &spot = s.lights[1].light;
    EXPECT_NEAR(sun.toLight[1], 1, 1e-6);  // against -z, turned a quarter about -x
    EXPECT_NEAR(sun.color[1], 1.5 / M_PI, 1e-6);
    EXPECT_EQ(spot.type, PEL_LIGHT_SPOT);
    EXPECT_EQ(spot.position[1], 2);
    EXPECT_NEAR(spot.color[0], 10 * 1e6 / M_PI, 1);  // 10 lux at a metre
    EXPECT_NEAR(spot.spotCosOuter, std::cos(0.4), 1e-6);
    EXPECT_EQ(spot.range, 4);
}

TEST(Gltf, MaterialsThatScatter) {
    const auto material = [](const json& json) {
        const GltfScene s =
            decoded(square({{"/meshes/0/primitives/0/material", 0}, {"/materials", json::array({json})}}));
        EXPECT_EQ(s.materials.size(), 1u);
        return s.materials.at(0);
    };
    const GltfMaterial wax = material(R"({"name": "Wax",
        "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.7, 0.6, 1], "metallicFactor": 0,
                                 "roughnessFactor": 0.5},
        "extensions": {"KHR_materials_ior": {"ior": 1.4},
            "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 1,
                                                   "diffuseTransmissionColorFactor": [1, 0.9, 0.8]},
            "KHR_materials_volume": {"thicknessFactor": 0.02, "attenuationDistance": 0.002,
                                     "attenuationColor": [0.5, 0.25, 0.1]},
            "KHR_materials_volume_scatter": {"multiscatterColor": [0.9, 0.6, 0.3],
                                             "scatterAnisotropy": 0.5}}})"_json);
    const GltfLook look = lookOf(wax, "Wax", 3, "");
    EXPECT_EQ(look.how, "volume");
    EXPECT_EQ(look.material.profile, "Wax.toml");
    EXPECT_EQ(look.material.material.scattering, PEL_SCATTERING_AUTO);
    EXPECT_NEAR(look.material.material.f0, std::pow(0.4 / 2.4, 2), 1e-6);
    EXPECT_NEAR(look.material.material.roughness, 0.25, 1e-6);
    EXPECT_NEAR(look.albedo[1], 0.9 * 0.6, 1e-9);
    // The colour of a half-space is what van de Hulst's formula gives back [Kulla and Conty 2017].
    for (size_t c = 0; c < 3; ++c) {
        const double g = 0.5, one = singleScatterAlbedo((*wax.multiscatterColor)[c], g),
                     s = std::sqrt((1 - one) / (1 - g * one));
        EXPECT_NEAR((1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s), (*wax.multiscatterColor)[c], 2e-3) << c;
    }
    const PelProfileInfo info = parseProfile("Wax.toml", look.profileText).profile.info();
    // Half is left after 2 mm
    const double one = singleScatterAlbedo(0.9, 0.5), extinction = std::log(2.0) / 2;
    EXPECT_NEAR(info.meanFreePath[0], 1 / (extinction * (1 - 0.5 * one)), 1e-4);
    EXPECT_GT(info.meanFreePath[0], info.meanFreePath[2]);

    const GltfMaterial leaf = material(R"({
        "pbrMetallicRoughness": {"baseColorFactor": [0.3, 0.5, 0.2, 1], "metallicFactor": 0},
        "extensions": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.4,
            "diffuseTransmissionColorFactor": [0.2, 0.6, 0.1]}}})"_json);
    const GltfLook sheet = lookOf(leaf, "Leaf", 1, "");
    EXPECT_EQ(sheet.how, "thin sheet");
    const double thickness = sheet.material.material.thinThickness;
    EXPECT_GT(thickness, 0);
    const auto through = parseProfile("Leaf.toml", sheet.profileText).profile.transmission({thickness});
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(sheet.albedo[c], 0.6 * leaf.baseColor[c], 1e-9);
        EXPECT_NEAR(sheet.albedo[c] * through[c], 0.4 * leaf.diffuseTransmissionColor[c], 2e-3) << c;
    }
    const GltfMaterial metal = material(json::object());
    EXPECT_EQ(lookOf(metal, "m", 1, "").how, "metal");
    const PelMaterial named = lookOf(metal, "m", 1, "skin").material.material;
    EXPECT_EQ(lookOf(metal, "m", 1, "skin").material.profile, "skin");
    EXPECT_EQ(named.albedo[0], 1) << "the base colour's, as of no metal";
    EXPECT_LT(named.f0, 0.1f);
    const auto glossOf = [&](double specular, double metallic) {
        GltfMaterial m = metal;
        m.specular = specular, m.metallic = metallic, m.ior = 1.5;
        m.baseColor = {0.9, 0.6, 0.3};
        const PelMaterial p = lookOf(m, "m", 1, "").material.material;
        return std::pair{p.specular, p.specular * p.f0};  // at grazing angles, and from the front
    };
    EXPECT_EQ(glossOf(0, 0).first, 0) << "no gloss at any angle";
    EXPECT_FLOAT_EQ(glossOf(0.5, 0).first, 0.5f);
    EXPECT_NEAR(glossOf(0.5, 0).second, 0.5 * 0.04, 1e-6);
    EXPECT_FLOAT_EQ(glossOf(0, 0.25).first, 0.25f);
    EXPECT_NEAR(glossOf(0.5, 0.25).second, 0.75 * 0.5 * 0.04 + 0.25 * 0.6, 1e-6);
    const json textured = R"({"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}})"_json;
    EXPECT_EQ(lookOf(material(textured), "m", 1, "").how, "plain") << "its metalness is not read";
    EXPECT_EQ(lookOf(material(R"({"pbrMetallicRoughness": {"metallicFactor": 0}})"_json), "m", 1, "")
                  .material.material.scattering,
              PEL_SCATTERING_NONE);
    GltfMaterial scene;
    scene.name = "scene";
    EXPECT_EQ(plainNames({scene}), (std::vector<std::string>{"scene_2"}));  // scene.toml is another file
    EXPECT_EQ(plainNames({leaf, leaf}), (std::vector<std::string>{"material_0", "material_0_2"}));
}

TEST(Gltf, WrongFilesSayWhatAndWhere) {
    expectError("{}", {"s.glb", "asset"});
    expectError("nothing", {"neither a .glb nor JSON"});
    expectError(square().substr(0, 40), {"header says"});
    expectError(square().substr(0, 16), {"ends within the header"});
    const struct {
        const char* where;
        json value;
        std::vector<std::string> said;
    } rows[] = {
        {"/asset/version", "1.0", {"asset", "1.0"}},
        {"/buffers/0/byteLength", 93, {"buffers[0]", "93"}},
        // Bytes beyond the declared length of the buffer cannot be used.
        {"/buffers/0/byteLength", 91, {"bufferViews[2]", "ends at byte 92", "91"}},
        {"/bufferViews/2/byteOffset", 81, {"bufferViews[2]", "ends at byte 93", "92"}},
        {"/bufferViews/2/byteOffset", 9007199254740992, {"bufferViews[2]"}},
        {"/bufferViews/2/byteOffset", -1, {"bufferViews[2].byteOffset"}},
        {"/bufferViews/2/byteOffset", "x", {"bufferViews[2].byteOffset", "not a number"}},
        {"/accessors/2/count", 7, {"accessors[2]", "ends at byte 14 of a view of 12"}},
        {"/accessors/2/count", 1e15, {"accessors[2].count", "MiB"}},
        {"/accessors/2/count", 5, {"multiple of 3"}},
        {"/accessors/0/type", "VEC4", {"accessors[0]"}},
        {"/meshes/0/primitives/0/attributes/POSITION",
         9,
         {"meshes[0].primitives[0].attributes.POSITION", "9", "there are 3 accessors"}},
        {"/meshes/0/primitives/0/attributes/POSITION", nullptr, {"has no 'POSITION'"}},
        {"/meshes/0/primitives/0/indices", 0, {"accessors[0]"}},
        {"/nodes/0/children", "[0]"_json, {"nodes[0]", "of itself"}},
        {"/nodes",
         R"([{"mesh": 0, "children": [1]}, {"children": [2]}, {"children": [1]}])"_json,
         {"nodes[1]"}},
        {"/nodes/0/scale", "[1, 1]"_json, {"nodes[0].scale", "2 values"}},
        // The product of the scales is beyond a float.
        {"/nodes",
         R"([{"mesh": 0, "scale": [1e12, 1e12, 1e12], "children": [1]}, {"scale": [1e12, 1e12, 1e12],
             "children": [2]}, {"scale": [1e12, 1, 1]}])"_json,
         {"nodes[2]"}},
        {"/extensionsRequired",
         R"(["KHR_draco_mesh_compression"])"_json,
         {"extensionsRequired[0]", "KHR_draco"}},
    };
    for (const auto& [where, value, said] : rows) {
        SCOPED_TRACE(where);
        expectError(square({{where, value}}), said);
    }
    std::string bad = squareBuffer();
    const float infinite = INFINITY;
    std::memcpy(&bad[16], &infinite, 4);
    expectError(square({}, bad), {"POSITION", "vertex 1", "not finite"});
    bad = squareBuffer();
    bad[80] = 9;
    expectError(square({}, bad), {"meshes[0].primitives[0]", "index 9", "4 vertices"});
}

// Numbers, and lists of `count` of them.
TEST(Gltf, NumbersOutOfTheirRangesAreRefused) {
    const std::string pbr = "/materials/0/pbrMetallicRoughness/",
                      of = "/materials/0/extensions/KHR_materials_",
                      light = "/extensions/KHR_lights_punctual/lights/0/", node = "/nodes/0/",
                      camera = "/cameras/0/perspective/", gloss = of + "pbrSpecularGlossiness/",
                      through = of + "diffuse_transmission/diffuseTransmission";
    const struct {
        double low, high;
        size_t count;
        std::vector<std::string> where;
    } rows[] = {{0, 1, 4, {pbr + "baseColorFactor", gloss + "diffuseFactor"}},
                {0, 1, 3, {through + "ColorFactor", of + "volume/attenuationColor"}},
                {0, 1, 3, {of + "volume_scatter/multiscatterColor", of + "scatter/multiscatterColorFactor"}},
                {0, 1, 0, {pbr + "metallicFactor", pbr + "roughnessFactor", of + "specular/specularFactor"}},
                {0, 1, 0, {of + "transmission/transmissionFactor", through + "Factor"}},
                {0, 1, 0, {gloss + "glossinessFactor"}},
                {1, 100, 0, {of + "ior/ior"}},
                {0, 1e6, 0, {of + "volume/thicknessFactor"}},
                {1e-9, INFINITY, 0, {of + "volume/attenuationDistance"}},
                {-1, 1, 0, {of + "volume_scatter/scatterAnisotropy"}},
                {0, 1e6, 3, {light + "color"}},
                {0, 1e12, 0, {light + "intensity", light + "range"}},
                {0, M_PI / 2, 0, {light + "spot/outerConeAngle"}},
                {1e-3, 3.14, 0, {camera + "yfov"}},
                {1e-3, 1e3, 0, {camera + "aspectRatio"}},
                {-1e12, 1e12, 3, {node + "translation", node + "scale"}},
                {-2, 2, 4, {node + "rotation"}}};
    for (const auto& row : rows)
        for (const std::string& where : row.where) {
            SCOPED_TRACE(where);
            const auto with = [&](double x) {
                const json value = row.count ? json(std::vector<double>(row.count, x)) : json(x);
                return square({{"/cameras/0", R"({"type": "perspective", "perspective": {"yfov": 1}})"_json},
                               {"/nodes/0/camera", 0},
                               {"/extensions/KHR_lights_punctual/lights/0/type", "spot"},
                               {"/nodes/0/extensions/KHR_lights_punctual/light", 0},
                               {"/meshes/0/primitives/0/material", 0},
                               {"/materials/0/name", "m"},
                               {where, value}});
            };
            for (const double end : {row.low, row.high}) {
                if (end == INFINITY) continue;
                EXPECT_NO_THROW(decoded(with(end)));
                const double step = 0.01 * (end == 0 ? 1 : std::abs(end));
                expectError(with(end == row.low ? end - step : end + step),
                            {where.substr(where.rfind('/') + 1)});
            }
        }
}

// Work is bounded by what a file draws: nodes times primitives that draw nothing are not visited.
TEST(Gltf, PrimitivesAreDecodedOnceHoweverManyNodesPlaceThem) {
    constexpr size_t count = 20000;
    json scene = edited({{"/nodes", json::array()}, {"/scenes/0/nodes", numbers(count)}});
    for (size_t i = 0; i < count; ++i) {
        scene["nodes"].push_back({{"mesh", 0}});
        scene["meshes"][0]["primitives"].push_back(R"({"attributes": {"POSITION": 0}, "mode": 1})"_json);
    }
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(decoded(gltf::glb(scene.dump(), squareBuffer())).mesh.triangleCount(), 2 * count);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

#ifndef _WIN32  // without setenv
TEST(Gltf, DecodedAccessorsCountTowardsTheLimitOfInput) {
    ::setenv("PELLUCID_INPUT_LIMIT_MIB", "64", 1);
    json scene = edited({{"/accessors/0/bufferView", nullptr}, {"/accessors/0/count", 1000000}});
    scene["meshes"][0]["primitives"] =
        json::array_t(100, R"({"attributes": {"POSITION": 0}, "mode": 5})"_json);
    expectError(gltf::glb(scene.dump(), squareBuffer()), {"makes the scene too large"});
    // A mesh that is decoded once also counts each time that it is placed.
    scene["meshes"][0]["primitives"] = json::array({scene["meshes"][0]["primitives"][0]});
    scene["nodes"] = json::array_t(3, json{{"mesh", 0}});
    scene["scenes"][0]["nodes"] = {0, 1, 2};
    expectError(gltf::glb(scene.dump(), squareBuffer()), {"makes the scene too large"});
    ::unsetenv("PELLUCID_INPUT_LIMIT_MIB");
}
#endif

namespace {

// A node beside the square with a camera, or with a light of this intensity.
Edits nodeWith(json node, double intensity = 0) {
    node[intensity > 0 ? "extensions" : "camera"] =
        intensity > 0 ? R"({"KHR_lights_punctual": {"light": 0}})"_json : json(0);
    const json light = {{"type", "point"}, {"intensity", intensity}};
    return {{"/nodes", {{{"mesh", 0}, {"children", {1}}}, node}},
            {"/cameras", R"([{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}])"_json},
            {"/extensions/KHR_lights_punctual/lights", json::array({light})},
            {"/meshes/0/primitives/0/material", 0},
            {"/materials", R"([{"pbrMetallicRoughness": {"metallicFactor": 0}}])"_json}};
}

ImportedGltf imported(const Edits& edits, std::optional<double> lights = {}) {
    return importScene(decoded(square(edits)), {{}, 1000, lights});
}

bool warns(const ImportedGltf& made, const std::string& text) {
    return std::ranges::any_of(made.gltf.mesh.warnings,
                               [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

}  // namespace

// Cameras and lights that no scene file can hold are left out with a warning; the rest is imported.
TEST(Gltf, CamerasAndLightsAtInfinity) {
    for (const json& place : R"([{"translation": [0, 0, 1e12]},
                                 {"translation": [1e9, 0, 0], "scale": [1, 1, 1e-9]}])"_json) {
        const ImportedGltf made = imported(nodeWith(place));
        EXPECT_TRUE(made.gltf.cameras.empty()) << place;
        EXPECT_TRUE(warns(made, "cameras are left out")) << place;
        EXPECT_NO_THROW(parseScene("s.toml", sceneText(made.scene))) << place;
    }
    // An axis of no length and axes that coincide still give a direction and another one across.
    for (const json& place : R"([{"scale": [1, 0, 0], "translation": [0, 0, 3]},
                                 {"matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 3, 1]}])"_json) {
        const GltfCamera c = imported(nodeWith(place)).gltf.cameras.at(0);
        double cosine = 0;
        for (size_t i = 0; i < 3; ++i) cosine += c.up[i] * c.forward[i];
        EXPECT_LT(std::abs(cosine), 0.9) << place;
    }
}

// A lamp of 1 kW as Blender writes it would make everything white.
TEST(Gltf, LightsGetAFactorThatExposesTheScene) {
    const auto lit = [](double intensity, std::optional<double> factor = {}) {
        return imported(nodeWith(R"({"translation": [0.5, 0.5, 4]})"_json, intensity), factor);
    };
    const ImportedGltf made = lit(54351), literal = lit(54351, 1);
    // 54351 cd at 4 m are 3397 lx, and a white wall reflects 3397 / pi of it.
    EXPECT_NEAR(made.lightFactor, 0.8 / (54351 / (16 * M_PI)), 1e-5);
    EXPECT_NEAR(made.scene.lights.at(0).light.color[0], made.lightFactor * 54351e6 / M_PI, 1e3);
    EXPECT_FALSE(warns(made, "too bright"));
    EXPECT_EQ(literal.lightFactor, 1);
    EXPECT_TRUE(warns(literal, "too bright"));
    EXPECT_EQ(lit(16).lightFactor, 1);
}
