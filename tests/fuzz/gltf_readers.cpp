#include <nlohmann/json.hpp>

#include "fuzz/readers.h"
#include "gltf/gltf_import.h"
#include "gltf/tests/gltf_bytes.h"
#include "io/lut/profile_file.h"

namespace fuzz {

using namespace pellucid;

// Scenes with everything that is read: nodes, sparse accessors, materials, cameras, lights, a texture.
Reader gltfScenes(const Folder& folder) {
    const std::string nodes =
        R"([{"mesh":0,"children":[1,2]},{"camera":0,"rotation":[0,0.6,0,0.8],"scale":[1,-1,2]},)"
        R"({"extensions":{"KHR_lights_punctual":{"light":0}},"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,1,2,3,1]}])";
    const std::string more =
        R"(,"scene":0,"materials":[{"name":"a","pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],)"
        R"("baseColorTexture":{"index":0}},"extensions":{"KHR_materials_ior":{"ior":1.4},)"
        R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.5},)"
        R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":2,"attenuationColor":[0.5,)"
        R"(0.5,0.5]},)"
        R"("KHR_materials_volume_scatter":{"multiscatterColor":[0.5,0.5,0.5],)"
        R"("scatterAnisotropy":0.1}}}],"textures":[{"source":0}],"images":[{"bufferView":1,)"
        R"("mimeType":"image/png"}],)"
        R"("cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],)"
        R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{}}]}},)"
        R"("extensionsUsed":["KHR_materials_ior"])";
    std::vector<std::string> seeds = {
        gltf::square(), gltf::square(",\"material\":0,\"mode\":5", nodes, more),
        gltf::squareJson("", nodes, more, R"(,"uri":"a.bin")"),
        gltf::squareJson("", "[{\"mesh\":0}]", "",
                         R"(,"uri":"data:;base64,)" + gltf::base64(gltf::squareBuffer()) + "\"")};
    std::string sparse = gltf::squareJson();
    sparse.insert(
        sparse.find(R"("count":4,"type":"VEC3")"),
        R"("sparse":{"count":1,"indices":{"bufferView":2,"componentType":5123},"values":{"bufferView":0}},)");
    seeds.push_back(gltf::glb(sparse, gltf::squareBuffer()));
    return {
        "gltf",
        std::move(seeds),
        [picture = picture(folder, "png", 3)](const std::string& bytes) {
            const io::GltfScene scene = io::decodeGltf("s.glb", bytes, [&](const std::string& name) {
                return name.ends_with(".png") ? picture : gltf::squareBuffer();
            });
            if (scene.materialOf.size() != scene.mesh.triangleCount())
                throw std::logic_error("a triangle without a material");
            for (uint32_t t : scene.mesh.triangles)
                if (t >= scene.mesh.vertexCount())
                    throw std::logic_error("a triangle of a vertex that there is not");
            for (uint32_t m : scene.materialOf)
                if (m >= scene.materials.size())
                    throw std::logic_error("a triangle of a material that there is not");
            // The scene that `pellucid import` writes, which can then be read.
            const io::ImportedGltf made = io::importScene(scene);
            for (const io::GltfLook& look : made.looks)
                if (!look.profileText.empty()) io::parseProfile("m.toml", look.profileText);
            io::parseScene("scene.toml", io::sceneText(made.scene));
        },
        {},
        wordsOf(R"("bufferView": "byteOffset": "byteStride": "count": "sparse": "children":[0] "uri":"a")"
                R"( "componentType":5125 5121 5126 VEC4 null {} [] -1 1e308 9007199254740992 4294967295)"
                R"( "mode":6 true)"),
        [json = nlohmann::json::parse(gltf::squareJson(",\"material\":0,\"mode\":5", nodes, more))](
            Random& random) {
            static const std::vector<std::string> words = wordsOf(
                "SCALAR VEC2 VEC3 VEC4 MAT4 orthographic perspective spot point directional POSITION a.bin "
                "data:;base64,AAAA image/png");
            nlohmann::json document = json;
            mutateJson(random, document, words);
            std::string buffer = gltf::squareBuffer();
            for (size_t i = random.below(3); i > 0; --i)
                buffer[random.below(buffer.size())] = char(random.next());
            return gltf::glb(document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), buffer);
        }};
}

}  // namespace fuzz
