// glTF: geometry, nodes, materials, cameras and lights of small files that are made here, and files that
// are wrong.
#include "gltf/gltf_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include "gltf/gltf_import.h"
#include "gltf/tests/gltf_bytes.h"
#include "io/file_error.h"
#include "io/io_files.h"
#include "io/lut/profile_file.h"

using namespace pellucid::io;
using gltf::glb;
using gltf::square;
using gltf::squareBuffer;
using gltf::squareJson;

namespace {

std::string nothing(const std::string& name) {
    throw FileError(name, "is not there");
}

GltfScene decoded(const std::string& bytes) {
    return decodeGltf("s.glb", bytes, nothing);
}

std::string errorOf(const std::string& bytes) {
    try {
        decoded(bytes);
    } catch (const FileError& e) {
        return e.what();
    }
    return "no error";
}

std::string with(std::string text, const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

void expectSays(const std::string& said, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
}

std::vector<float> position(const GltfScene& s, size_t v) {
    return {s.mesh.positions[3 * v], s.mesh.positions[3 * v + 1], s.mesh.positions[3 * v + 2]};
}

}  // namespace

TEST(Gltf, ReadsASquare) {
    const GltfScene s = decoded(square());
    EXPECT_EQ(s.mesh.vertexCount(), 4u);
    EXPECT_EQ(s.mesh.triangles, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(s.mesh.uvs, (std::vector<float>{0, 0, 1, 0, 1, 1, 0, 1}));
    EXPECT_EQ(position(s, 2), (std::vector<float>{1, 1, 0}));
    EXPECT_FLOAT_EQ(s.mesh.normals[2], 1);  // made from the triangles
    EXPECT_EQ(s.materialOf, (std::vector<uint32_t>{0, 0}));
    ASSERT_EQ(s.materials.size(), 1u);
    EXPECT_TRUE(s.mesh.warnings.empty());
}

TEST(Gltf, JsonWithABufferInTextOrInAFile) {
    const std::string raw = squareBuffer(), base64 = gltf::base64(raw);
    const GltfScene text = decoded(squareJson(
        "", R"([{"mesh":0}])", "", R"(,"uri":"data:application/octet-stream;base64,)" + base64 + "\""));
    EXPECT_EQ(text.mesh.positions, decoded(square()).mesh.positions);
    EXPECT_EQ(text.mesh.triangles, decoded(square()).mesh.triangles);
    const std::string json = squareJson("", R"([{"mesh":0}])", "", R"(,"uri":"my%20parts/a.bin")");
    std::string asked;
    const GltfScene file =
        decodeGltf("s.gltf", json, [&](const std::string& name) { return asked = name, raw; });
    EXPECT_EQ(asked, "my parts/a.bin");
    EXPECT_EQ(file.mesh.positions, text.mesh.positions);
    for (const char* uri : {"/etc/passwd", "../a.bin", "a/../../b", "file:///etc/passwd", "http://x/y",
                            "%2e%2e/a", "a\\\\b", "", "a//b"})
        EXPECT_NE(errorOf(squareJson("", R"([{"mesh":0}])", "", R"(,"uri":")" + std::string(uri) + "\""))
                      .find("buffers[0].uri"),
                  std::string::npos)
            << uri;
}

TEST(Gltf, NodesMoveTurnScaleAndMirror) {
    const GltfScene s = decoded(
        square("", R"([{"children":[1,2],"translation":[10,0,0]},{"mesh":0,"rotation":[0,0,0.70710678,)"
                   R"(0.70710678],"scale":[2,1,1]},
                {"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])"));
    ASSERT_EQ(s.mesh.vertexCount(), 8u);
    EXPECT_NEAR(position(s, 1)[0], 10, 1e-6);  // (2, 0, 0) a quarter turn about z, moved
    EXPECT_NEAR(position(s, 1)[1], 2, 1e-6);
    EXPECT_EQ(position(s, 5), (std::vector<float>{9, 0, 5}));
    // The mirrored square still faces +z.
    EXPECT_EQ(std::vector<uint32_t>(s.mesh.triangles.begin() + 6, s.mesh.triangles.end()),
              (std::vector<uint32_t>{4, 6, 5, 4, 7, 6}));
    for (size_t v = 0; v < 8; ++v) EXPECT_NEAR(s.mesh.normals[3 * v + 2], 1, 1e-6) << v;
}

// However a node is turned, its triangles face the way of its normals, mirrored or not.
TEST(Gltf, TurnedAndMirroredFacesKeepTheirFront) {
    for (const char* turn :
         {"0,0,0,1", "0,0,0.70710678,0.70710678", "0,0.70710678,0,0.70710678", "0.70710678,0,0,0.70710678",
          "0.5,0.5,0.5,0.5", "0.18257,0.36515,0.54772,0.73030"})
        for (const char* scale : {"1,1,1", "-1,1,1", "1,-2,1", "1,1,-3", "-1,-1,-1"}) {
            const MeshData m = decoded(square("", "[{\"mesh\":0,\"rotation\":[" + std::string(turn) +
                                                      "],\"scale\":[" + scale + "]}]"))
                                   .mesh;
            for (size_t t = 0; t < m.triangles.size(); t += 3) {
                const float* p[3];
                for (size_t k = 0; k < 3; ++k) p[k] = &m.positions[3 * m.triangles[t + k]];
                double facing = 0;
                for (size_t c = 0; c < 3; ++c) {
                    const size_t d = (c + 1) % 3, e = (c + 2) % 3;
                    facing +=
                        m.normals[3 * m.triangles[t] + c] * (double(p[1][d] - p[0][d]) * (p[2][e] - p[0][e]) -
                                                             double(p[1][e] - p[0][e]) * (p[2][d] - p[0][d]));
                }
                EXPECT_GT(facing, 0.9) << turn << " times " << scale;
            }
        }
}

TEST(Gltf, StripsFansAndNoIndices) {
    const auto triangles = [](const char* mode) {
        return decoded(square(std::string(",\"mode\":") + mode)).mesh.triangles;
    };
    EXPECT_EQ(triangles("5"), (std::vector<uint32_t>{0, 1, 2, 2, 1, 0, 2, 0, 2, 2, 0, 3}));  // of 0 1 2 0 2 3
    EXPECT_EQ(triangles("6"), (std::vector<uint32_t>{0, 1, 2, 0, 2, 0, 0, 0, 2, 0, 2, 3}));
    const std::string noIndices = with(squareJson(",\"mode\":6"), ",\"indices\":2", "");
    EXPECT_EQ(decoded(glb(noIndices, squareBuffer())).mesh.triangles,
              (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
    const std::string strip = with(squareJson(",\"mode\":5"), ",\"indices\":2", "");
    EXPECT_EQ(decoded(glb(strip, squareBuffer())).mesh.triangles, (std::vector<uint32_t>{0, 1, 2, 2, 1, 3}));
    expectSays(errorOf(square(",\"mode\":1")), {"has no triangles"});
}

TEST(Gltf, SparseAndNormalisedAccessors) {
    // Vertex 1 is moved to (7, 8, 9).
    const std::string extra = gltf::bytesOf<uint32_t>({1}) + gltf::bytesOf<float>({7, 8, 9});
    std::string json =
        with(squareJson(), R"("count":4,"type":"VEC3")",
             R"("count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":3,"componentType":5125},)"
             R"("values":{"bufferView":3,"byteOffset":4}})");
    json = with(json, R"("byteLength":92)", R"("byteLength":108)");
    json = with(json, R"("byteLength":12}])",
                R"("byteLength":12},{"buffer":0,"byteOffset":92,)"
                R"("byteLength":16}])");
    const GltfScene s = decoded(glb(json, squareBuffer() + extra));
    EXPECT_EQ(position(s, 1), (std::vector<float>{7, 8, 9}));
    EXPECT_EQ(position(s, 2), (std::vector<float>{1, 1, 0}));
    expectSays(errorOf(glb(json, squareBuffer() + gltf::bytesOf<uint32_t>({4}) + extra.substr(4))),
               {"accessors[0].sparse.indices", "4 of 4"});
    // Bytes as fractions of 255: KHR_mesh_quantization.
    const std::string bytes =
        with(squareJson(), R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"})",
             R"({"bufferView":1,"componentType":5121,"normalized":true,"count":4,"type":"VEC2"})");
    std::string buffer = squareBuffer();
    buffer[50] = char(255);
    buffer[51] = char(51);
    const std::vector<float> uvs = decoded(glb(bytes, buffer)).mesh.uvs;
    EXPECT_FLOAT_EQ(uvs[2], 1);
    EXPECT_FLOAT_EQ(uvs[3], 0.2f);
}

TEST(Gltf, CamerasAndLights) {
    const GltfScene s =
        decoded(square("", R"([{"mesh":0,"children":[1,2,3]},{"camera":0,"translation":[0,0,5]},
                {"extensions":{"KHR_lights_punctual":{"light":0}},"rotation":[-0.70710678,0,0,0.70710678]},
                {"extensions":{"KHR_lights_punctual":{"light":1}},"translation":[0,2,0]}])",
                       R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1,)"
                       R"("aspectRatio":2}}],
            "extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional","intensity":3,)"
                       R"("color":[1,0.5,0]},
            {"type":"spot","intensity":10,"range":4,"spot":{"innerConeAngle":0.2,)"
                       R"("outerConeAngle":0.4}}]}})"));
    ASSERT_EQ(s.cameras.size(), 1u);
    EXPECT_EQ(s.cameras[0].position, (Triple{0, 0, 5}));
    EXPECT_EQ(s.cameras[0].verticalFov, 0.5);
    EXPECT_EQ(s.cameras[0].aspect, 2);
    ASSERT_EQ(s.lights.size(), 2u);
    EXPECT_NEAR(s.lights[0].forward[1], -1, 1e-6);  // -z, turned a quarter about -x
    const SceneLight sun = sceneLight(s.lights[0], 1), spot = sceneLight(s.lights[1], 2);
    EXPECT_NEAR(sun.light.toLight[1], 1, 1e-6);
    EXPECT_NEAR(sun.light.color[1], 1.5 / M_PI, 1e-6);
    EXPECT_EQ(spot.light.position[1], 2);
    EXPECT_NEAR(spot.light.color[0], 2 * 10 * 1e6 / M_PI, 1);  // 10 lux at a metre
    EXPECT_NEAR(spot.light.spotCosOuter, std::cos(0.4), 1e-6);
    EXPECT_EQ(spot.light.range, 4);
}

TEST(Gltf, MaterialsThatScatter) {
    const auto material = [](const std::string& json) {
        const GltfScene s =
            decoded(square(",\"material\":0", R"([{"mesh":0}])", ",\"materials\":[" + json + "]"));
        EXPECT_EQ(s.materials.size(), 1u);
        return s.materials.at(0);
    };
    const GltfMaterial wax = material(
        R"({"name":"Wax","pbrMetallicRoughness":{"baseColorFactor":[0.8,0.7,0.6,1],"metallicFactor":0,)"
        R"("roughnessFactor":0.5},"extensions":{
            "KHR_materials_ior":{"ior":1.4},)"
        R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":1,)"
        R"("diffuseTransmissionColorFactor":[1,0.9,0.8]},
            "KHR_materials_volume":{"thicknessFactor":0.02,"attenuationDistance":0.002,)"
        R"("attenuationColor":[0.5,0.25,0.1]},
            "KHR_materials_volume_scatter":{"multiscatterColor":[0.9,0.6,0.3],"scatterAnisotropy":0.5}}})");
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
    const ProfileFile profile = parseProfile("Wax.toml", look.profileText);
    const PelProfileInfo info = profile.profile.info();
    const float* path = info.meanFreePath;
    // Half is left after 2 mm
    const double one = singleScatterAlbedo(0.9, 0.5), extinction = std::log(2.0) / 2;
    EXPECT_NEAR(path[0], 1 / (extinction * (1 - 0.5 * one)), 1e-4);
    EXPECT_GT(path[0], path[2]);

    const GltfMaterial leaf = material(
        R"({"pbrMetallicRoughness":{"baseColorFactor":[0.3,0.5,0.2,1],"metallicFactor":0},"extensions":{
            "KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.4,)"
        R"("diffuseTransmissionColorFactor":[0.2,0.6,0.1]}}})");
    const GltfLook sheet = lookOf(leaf, "Leaf", 1, "");
    EXPECT_EQ(sheet.how, "thin sheet");
    EXPECT_GT(sheet.material.material.thinThickness, 0);
    const double distance[] = {sheet.material.material.thinThickness};
    const std::vector<double> through =
        parseProfile("Leaf.toml", sheet.profileText).profile.transmission({distance[0]});
    for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(sheet.albedo[c], 0.6 * leaf.baseColor[c], 1e-9);
        EXPECT_NEAR(sheet.albedo[c] * through[c], 0.4 * leaf.diffuseTransmissionColor[c], 2e-3) << c;
    }
    EXPECT_EQ(lookOf(material("{}"), "m", 1, "").how, "metal");
    EXPECT_EQ(lookOf(material(R"({"pbrMetallicRoughness":{"metallicFactor":0}})"), "m", 1, "")
                  .material.material.scattering,
              PEL_SCATTERING_NONE);
    EXPECT_EQ(lookOf(material("{}"), "m", 1, "skin").material.profile, "skin");
    GltfMaterial scene;
    scene.name = "scene";
    EXPECT_EQ(plainNames({scene}), (std::vector<std::string>{"scene_2"}));  // scene.toml is another file
    EXPECT_EQ(plainNames({leaf, leaf}), (std::vector<std::string>{"material_0", "material_0_2"}));
}

TEST(Gltf, WrongFilesSayWhatAndWhere) {
    const std::string json = squareJson();
    const auto json2 = [&](const std::string& from, const std::string& to) {
        return errorOf(glb(with(json, from, to), squareBuffer()));
    };
    expectSays(errorOf("{}"), {"s.glb", "asset"});
    expectSays(errorOf("nothing"), {"neither a .glb nor JSON"});
    expectSays(errorOf(square().substr(0, 40)), {"header says"});
    expectSays(errorOf(square().substr(0, 16)), {"ends within the header"});
    expectSays(json2("\"2.0\"", "\"1.0\""), {"asset", "1.0"});
    expectSays(json2(R"("byteLength":92)", R"("byteLength":93)"), {"buffers[0]", "93"});
    expectSays(json2(R"("byteOffset":80)", R"("byteOffset":81)"),
               {"bufferViews[2]", "ends at byte 93", "92"});
    // Bytes behind what the buffer says it has are nobody's.
    expectSays(json2(R"("byteLength":92)", R"("byteLength":91)"),
               {"bufferViews[2]", "ends at byte 92", "91"});
    expectSays(json2(R"("byteOffset":80)", R"("byteOffset":9007199254740992)"), {"bufferViews[2]"});
    expectSays(json2(R"("byteOffset":80)", R"("byteOffset":-1)"), {"bufferViews[2].byteOffset"});
    expectSays(json2(R"("byteOffset":80)", R"("byteOffset":"x")"),
               {"bufferViews[2].byteOffset", "not a number"});
    expectSays(json2(R"("count":6)", R"("count":7)"), {"accessors[2]", "ends at byte 14 of a view of 12"});
    expectSays(json2(R"("count":6)", R"("count":1e15)"), {"accessors[2].count", "MiB"});
    expectSays(json2(R"("count":6)", R"("count":5)"), {"multiple of 3"});
    expectSays(json2(R"("type":"VEC3")", R"("type":"VEC4")"), {"accessors[0]"});
    expectSays(json2(R"("POSITION":0)", R"("POSITION":9)"),
               {"meshes[0].primitives[0].attributes.POSITION", "9", "there are 3 accessors"});
    expectSays(json2(R"("POSITION":0)", R"("position":0)"), {"has no 'POSITION'"});
    expectSays(json2(R"("indices":2)", R"("indices":0)"), {"accessors[0]"});
    expectSays(json2(R"([{"mesh":0}])", R"([{"mesh":0,"children":[0]}])"), {"nodes[0]", "of itself"});
    expectSays(json2(R"([{"mesh":0}])", R"([{"mesh":0,"children":[1]},{"children":[2]},{"children":[1]}])"),
               {"nodes[1]"});
    expectSays(json2(R"([{"mesh":0}])", R"([{"mesh":0,"scale":[1,1]}])"), {"nodes[0].scale", "2 values"});
    expectSays(errorOf(square("", R"([{"mesh":0}])",
                              R"(,)"
                              R"("extensionsRequired":["KHR_draco_mesh_compression"])")),
               {"extensionsRequired[0]", "KHR_draco"});
    std::string bad = squareBuffer();
    const float infinite = INFINITY;
    std::memcpy(&bad[16], &infinite, 4);
    expectSays(errorOf(glb(json, bad)), {"POSITION", "vertex 1", "not finite"});
    bad = squareBuffer();
    bad[80] = 9;
    expectSays(errorOf(glb(json, bad)), {"meshes[0].primitives[0]", "index 9", "4 vertices"});
}

namespace {

// `count` times `element`, as the elements of a JSON array.
std::string repeated(const std::string& element, size_t count) {
    std::string list;
    for (size_t i = 0; i < count; ++i) (list += i ? "," : "") += element;
    return list;
}

ImportedGltf imported(const std::string& nodes, const std::string& more, std::optional<double> lights = {}) {
    return importScene(decoded(square("", nodes, more)), {{}, 1000, lights});
}

bool warns(const ImportedGltf& made, const std::string& text) {
    return std::ranges::any_of(made.gltf.mesh.warnings,
                               [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

const std::string camera = R"("cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}])";
const std::string lamp =
    R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":54351}]}})";

std::string nodesWith(const std::string& key, const std::string& place) {
    return R"([{"mesh":0,"children":[1]},{)" + key + "," + place + "}]";
}

}  // namespace

// The work of a file is bounded by what the file draws: nodes times primitives that draw nothing are not
// visited.
TEST(Gltf, PrimitivesAreDecodedOnceHoweverManyNodesPlaceThem) {
    std::string json = with(
        squareJson("", "[" + repeated(R"({"mesh":0})", 20000) + "]"),
        R"([{"nodes":[0]}])", R"([{"nodes":[)" + [] {
            std::string list = "0";
            for (int i = 1; i < 20000; ++i) list += "," + std::to_string(i);
            return list;
        }() + "]}]");
    json = with(json, R"("primitives":[)",
                R"("primitives":[)" + repeated(R"({"attributes":{"POSITION":0},"mode":1})", 20000) + ",");
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(decoded(glb(json, squareBuffer())).mesh.triangleCount(), 40000u);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

#ifndef _WIN32  // without setenv
TEST(Gltf, DecodedAccessorsCountTowardsTheLimitOfInput) {
    ::setenv("PELLUCID_INPUT_LIMIT_MIB", "64", 1);
    std::string json = with(squareJson(), R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,)",
                            R"("accessors":[{"componentType":5126,"count":1000000,)");
    json = with(json, R"("primitives":[)",
                R"("primitives":[)" + repeated(R"({"attributes":{"POSITION":0},"mode":5})", 100) + ",");
    EXPECT_NE(errorOf(glb(json, squareBuffer())).find("makes the scene too large"), std::string::npos);
    ::unsetenv("PELLUCID_INPUT_LIMIT_MIB");
}
#endif

// Cameras and lights that no scene file can hold are left out with a warning; the rest is imported.
TEST(Gltf, CamerasAndLightsAtInfinity) {
    for (const char* place : {R"("translation":[0,0,1e12])", R"("translation":[1e9,0,0],"scale":[1,1,)"
                                                             R"(1e-9])"}) {
        const ImportedGltf made = imported(nodesWith("\"camera\":0", place), "," + camera);
        EXPECT_TRUE(made.gltf.cameras.empty()) << place;
        EXPECT_TRUE(warns(made, "cameras are left out")) << place;
        EXPECT_NO_THROW(parseScene("s.toml", sceneText(made.scene))) << place;
    }
    // An axis of no length and axes that coincide still give a direction and another one across.
    for (const char* place :
         {R"("scale":[1,0,0],"translation":[0,0,3])", R"("matrix":[1,0,0,0, 0,0,1,0, 0,0,1,0, 0,0,3,1])"}) {
        const GltfCamera c = imported(nodesWith("\"camera\":0", place), "," + camera).gltf.cameras.at(0);
        double cosine = 0;
        for (size_t i = 0; i < 3; ++i) cosine += c.up[i] * c.forward[i];
        EXPECT_LT(std::abs(cosine), 0.9) << place;
    }
    EXPECT_NE(errorOf(square("", R"([{"mesh":0,"scale":[1e12,1e12,1e12],"children":[1]},{"scale":[1e12,1e12,)"
                                 R"(1e12],"children":[2]},{"scale":[1e12,1,1]}])"))
                  .find("nodes[2]"),
              std::string::npos);
}

// A lamp of 1 kW as Blender writes it would make everything white.
TEST(Gltf, LightsGetAFactorThatExposesTheScene) {
    const std::string nodes =
        nodesWith(R"("extensions":{"KHR_lights_punctual":{"light":0}})", R"("translation":[0.5,0.5,4])");
    const std::string material = R"(,"materials":[{"pbrMetallicRoughness":{"metallicFactor":0}}],)";
    const auto lit = [&](const std::string& light, std::optional<double> factor = {}) {
        return importScene(decoded(square(",\"material\":0", nodes, material + light)), {{}, 1000, factor});
    };
    const ImportedGltf made = lit(lamp);
    // 54351 cd at 4 m are 3397 lx, and a white wall reflects 3397 / pi of it.
    EXPECT_NEAR(made.lightFactor, 0.8 / (54351 / (16 * M_PI)), 1e-5);
    EXPECT_NEAR(made.scene.lights.at(0).light.color[0], made.lightFactor * 54351e6 / M_PI, 1e3);
    EXPECT_FALSE(warns(made, "too bright"));
    const ImportedGltf literal = lit(lamp, 1);
    EXPECT_EQ(literal.lightFactor, 1);
    EXPECT_TRUE(warns(literal, "too bright"));
    EXPECT_EQ(lit(R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point",)"
                  R"("intensity":16}]}})")
                  .lightFactor,
              1);
}
