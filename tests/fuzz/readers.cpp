#include <OpenImageIO/imageio.h>

#include <boost/crc.hpp>
#include <cstring>
#include <nlohmann/json.hpp>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "fuzz/readers.h"

#include "batch/batch_manifest.h"
#include "gltf/gltf_import.h"
#include "gltf/tests/gltf_bytes.h"
#include "io/file_error.h"
#include "io/image/image_file.h"
#include "io/input_file.h"
#include "io/lut/lut_exr.h"
#include "io/lut/lut_file.h"
#include "io/lut/profile_file.h"
#include "io/mesh/mesh_parts.h"
#include "io/scene/scene_file.h"
#include "measure/report.h"
#include "measure/temporary_folder.h"

namespace fuzz {
namespace {

using namespace pellucid;

// The words of a text between blanks.
std::vector<std::string> wordsOf(const std::string& text) {
    std::istringstream words(text);
    return {std::istream_iterator<std::string>(words), {}};
}

// --- meshes ---

Reader mesh(const std::string& extension, std::vector<std::string> seeds, std::vector<std::string> words) {
    return {extension,
            std::move(seeds),
            [file = "m." + extension](const std::string& bytes) {
                io::MeshData mesh = io::decodeMesh(file, bytes, {true});
                if (!mesh.uvs.empty() && mesh.uvs.size() != 2 * mesh.vertexCount())
                    throw std::logic_error("texture coordinates of another number of vertices");
                if (mesh.normals.empty()) io::computeNormals(mesh);
                for (const std::vector<float>* values : {&mesh.positions, &mesh.normals})
                    for (float x : *values)
                        if (!std::isfinite(x))
                            throw std::logic_error("a position or normal that is not finite");
                for (uint32_t t : mesh.triangles)
                    if (t >= mesh.vertexCount())
                        throw std::logic_error("a triangle of a vertex that there is not");
                io::decodeMesh(file, bytes, {false});
                try {
                    io::loopSubdivide(mesh, 1);
                } catch (const io::FileError&) {  // not manifold
                }
            },
            {},
            std::move(words)};
}

// XXH32, behind 8 + 4 + 24 bytes of header, as host/mesh/mesh_topology_file.cpp has it.
std::string mendTopology(std::string b) {
    constexpr size_t sumAt = 36, start = sumAt + 4 + sizeof(PelMeshReport);
    if (b.size() < start) return b;
    const uint32_t hash = XXH32(&b[start], (b.size() - start) / 4 * 4, 0);
    std::memcpy(b.data() + sumAt, &hash, 4);
    return b;
}

void addMeshes(std::vector<Reader>& all, const std::string& folder) {
    all.push_back(
        mesh("off",
             {"OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n4 0 1 2 3\n",
              "STNOFF\n# c\n3 1 0\n0 0 0 0 0 1 0 0\n1 0 0 0 0 1 1 0\n0 1 0 0 0 1 0 1\n3 0 1 2 255 0 0\n",
              "COFF 3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n"},
             {"STOFF", "NOFF", "COFF", "STCNOFF", "BINARY", "4OFF", "nan", "-1", "99999999999", "#"}));
    all.push_back(mesh("obj",
                       {"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 "
                        "1\nusemtl x\nf 1/1/1 2/2/1 3/3/1\nf -4//1 -3//1 -1//1\nf 1 2 3 4\n",
                        "o a\ng b\ns off\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nvt 0 0 0\nf 1/1 2/1 "
                        "3/1\nl 1 2\np 1\n"},
                       {"vt", "vn", "vp", "f ", "v ", "/", "//", "\\\n", "curv", "call x", "mtllib", "usemtl",
                        "-1", "nan", "1e39"}));
    all.push_back(
        {"parts",
         {"g a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\ng b\nf 1 2 5\nf -5 -1 -2\n"},
         [](const std::string& t) { io::decodeParts("m.obj", t, 1); },
         {},
         {"g ", "g", "f ", "v ", "-1", "99", "\n"}});
    io::MeshData data;
    data.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    data.triangles = {0, 1, 2};
    io::writePly(folder + "m.ply", data, std::vector<float>{0, 1, 2}, 0, 1);
    const std::string head =
        " 1.0\ncomment c\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty "
        "list uchar short extra\nelement face 1\nproperty list uchar int vertex_indices\nproperty double "
        "q\nelement edge 1\nproperty int a\nend_header\n";
    std::string big = "ply\nformat binary_big_endian" + head;
    for (int v = 0; v < 3; ++v) big += std::string(12, '\0') + "\x01" + std::string("\0\7", 2);
    big += std::string("\3\0\0\0\0\0\0\0\1\0\0\0\2", 13) + std::string(8, '\0') + std::string(4, '\1');
    all.push_back(
        mesh("ply",
             {io::readWholeFile(folder + "m.ply"),
              "ply\nformat ascii" + head + "0 0 0 1 7\n1 0 0 0\n0 1 0 2 7 7\n3 0 1 2 1.5\n9\n", big},
             {"element", "property", "list", "uchar", "double", "int", "vertex", "face", "vertex_indices",
              "binary_big_endian", "4294967295", "-1", "s", "t", "nx"}));
    std::string binaryStl(80, 'x');
    binaryStl += std::string("\1\0\0\0", 4);
    const float facet[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    binaryStl.append(reinterpret_cast<const char*>(facet), sizeof facet).append(2, '\0');
    all.push_back(mesh("stl",
                       {"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                        "0\nendloop\nendfacet\nendsolid a\n",
                        binaryStl},
                       {"solid", "facet", "vertex", "endfacet", "endsolid", "outer loop", "nan"}));
}

Reader topology(const Device& device) {
    // A tetrahedron and a square whose corners are met twice.
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0,
                                          3, 0, 0, 3, 1, 0, 2, 0, 0, 3, 1, 0, 2, 1, 0};
    const std::vector<uint32_t> triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    std::vector<std::string> seeds;
    for (PelWeld weld : {PEL_WELD_NONE, PEL_WELD_EXACT}) {
        PelMeshTopologyDesc desc = pelMeshTopologyDescDefaults();
        desc.indices = triangles.data();
        desc.numIndices = triangles.size();
        desc.numVertices = uint32_t(positions.size() / 3);
        desc.weld = weld;
        desc.positions = positions.data();
        const std::vector<char> bytes = MeshTopology(device, desc).save();
        seeds.emplace_back(bytes.begin(), bytes.end());
    }
    return {"topology",
            std::move(seeds),
            [device, positions](const std::string& bytes) {
                PelMeshReport report = pelMeshReportDefaults();
                const MeshTopology t = MeshTopology::load(device, bytes.data(), bytes.size(), &report);
                if (report.vertices > 100000) return;
                std::vector<float> all(3 * size_t(report.vertices));
                for (size_t i = 0; i < all.size(); ++i) all[i] = positions[i % positions.size()];
                if (all.empty()) return;
                const Buffer p(device, all), result(device, std::vector<float>(report.vertices));
                t.curvature(pelCurvatureParamsDefaults(), vertexView(p, report.vertices),
                            vertexView(result, report.vertices));
            },
            mendTopology,
            {}};
}

// --- pictures and tables ---

std::string parts(const std::string& folder) {
    const std::string file = folder + "parts.exr";
    std::vector<OIIO::ImageSpec> specs(2, OIIO::ImageSpec(9, 7, 3, OIIO::TypeDesc::HALF));
    specs[0].attribute("oiio:subimagename", "colour");
    specs[1].attribute("oiio:subimagename", "normal");
    const std::vector<float> pixels(9 * 7 * 3, 0.25f);
    auto out = OIIO::ImageOutput::create(file);
    out->open(file, 2, specs.data());
    out->write_image(OIIO::TypeDesc::FLOAT, pixels.data());
    out->open(file, specs[1], OIIO::ImageOutput::AppendSubimage);
    out->write_image(OIIO::TypeDesc::FLOAT, pixels.data());
    out->close();
    return io::readWholeFile(file);
}

// CRC of each chunk [PNG Specification 1.2, annex D].
std::string mendPng(std::string b) {
    for (size_t at = 8; b.size() - std::min(at, b.size()) >= 12;) {
        uint32_t length = 0;
        for (size_t i = 0; i < 4; ++i) length = length << 8 | uint8_t(b[at + i]);
        if (length > b.size() - at - 12) break;
        boost::crc_32_type crc;
        crc.process_bytes(&b[at + 4], 4 + length);
        for (size_t i = 0; i < 4; ++i) b[at + 8 + length + i] = char(crc.checksum() >> (24 - 8 * i));
        at += 12 + length;
    }
    return b;
}

Reader image(const std::string& extension, std::vector<std::string> seeds) {
    return {extension,
            std::move(seeds),
            [file = "i." + extension](const std::string& bytes) {
                const io::Image image = io::decodeImage(file, bytes);
                for (const io::Channel& c : image.channels)
                    if (c.pixels.size() != image.pixelCount())
                        throw std::logic_error("a channel of another size");
            },
            extension == "png" ? mendPng : std::function<std::string(std::string)>(),
            {}};
}

std::string smallLut(const std::string& folder, const Lut& lut) {
    io::writeLut(folder + "t.exr", lut);
    return io::readWholeFile(folder + "t.exr");
}

// A small picture, as OpenImageIO writes it: by the compression `how`, in tiles of that side.
std::string picture(const std::string& folder, const std::string& extension, int channels,
                    const std::string& how = "", int tile = 0, const char* type = "uint8") {
    const std::string file = folder + "p." + extension;
    OIIO::ImageSpec spec(19, 13, channels, OIIO::TypeDesc(type));
    if (!how.empty()) spec.attribute("compression", how);
    if (tile) spec.tile_width = spec.tile_height = tile;
    spec.attribute("DateTime", "");
    std::vector<float> pixels(size_t(19 * 13) * size_t(channels));
    for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(i * 37 % 101) / 101;
    auto out = OIIO::ImageOutput::create(file);
    if (!out || !out->open(file, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) ||
        !out->close())
        throw std::runtime_error("no seed " + extension + " " + how + ": " + OIIO::geterror());
    return io::readWholeFile(file);
}

void addImages(std::vector<Reader>& all, const std::string& folder) {
    std::vector<std::string> exrs = {parts(folder), picture(folder, "exr", 4, "zip", 8, "half")};
    for (const char* how : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
        exrs.push_back(picture(folder, "exr", 3, how, 0, "half"));
        exrs.push_back(picture(folder, "exr", 1, how, 0, "float"));
    }
    all.push_back(image("exr", exrs));
    all.push_back(image("png", {picture(folder, "png", 1), picture(folder, "png", 3),
                                picture(folder, "png", 4, "", 0, "uint16")}));
    all.push_back(image("jpg", {picture(folder, "jpg", 1), picture(folder, "jpg", 3)}));
    all.push_back(image(
        "tga", {picture(folder, "tga", 1), picture(folder, "tga", 3, "rle"), picture(folder, "tga", 4)}));
    all.push_back(
        image("bmp", {picture(folder, "bmp", 1), picture(folder, "bmp", 3), picture(folder, "bmp", 4)}));
}

Reader table(const std::string& folder, const Device& device) {
    PelCurvatureLutDesc c = pelCurvatureLutDescFaceWorks();
    PelShadowLutDesc s = pelShadowLutDescFaceWorks();
    c.width = c.height = s.width = s.height = 8;
    const Lut curvature(device, c);
    const std::vector<uint16_t> halves = curvature.read<uint16_t>(PEL_LUT_HALF);
    const std::string batch =
        io::encodeLutExr(curvature.info(), PEL_LUT_HALF,
                         {reinterpret_cast<const char*>(halves.data()), 2 * halves.size()}, "key");
    return {"table",
            {smallLut(folder, curvature), smallLut(folder, Lut(device, s)), batch},
            [](const std::string& bytes) {
                io::verifyLutExr(bytes, "key");
                io::decodeLut("t.exr", bytes);
            },
            {},
            {"pellucid:kind", "curvature", "shadow", "specular", "arc", "pellucid:checksum"}};
}

// --- scenes of glTF ---

// Scenes with everything that is read: nodes, sparse accessors, materials, cameras, lights, a texture.
Reader gltfScenes(const std::string& folder) {
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

// --- texts ---

const std::string tomlWords =
    R"([[ ]] [ ] { } """ ''' = . , inf nan 1e400 -1 9223372036854775807 0x7f \u0000 true 2020-01-01 a.b.c ")";

Reader text(const std::string& name, std::vector<std::string> seeds,
            std::function<void(const std::string&)> read, const std::vector<std::string>& more) {
    Reader r{name, std::move(seeds), std::move(read), {}, wordsOf(tomlWords)};
    r.words.emplace_back("\n");
    r.words.insert(r.words.end(), more.begin(), more.end());
    return r;
}

io::SceneFile scene() {
    io::SceneFile s;
    s.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
    s.channels[PEL_SLOT_DEPTH] = {"Z"};
    s.outputs[PEL_SLOT_OUT_DIFFUSE] = "../d.exr";
    s.lights.resize(2);
    s.lights[0].shadowMapFile = "map.exr";
    s.materials.resize(1);
    s.materials[0].curvatureLut = "skin";
    s.eyes.resize(1);
    s.eyes[0].irisTexture = "iris.png";
    s.eyes[0].irisProfile = "skin";
    s.options.targetError = 0.5f;
    s.luts.resize(1);
    s.luts[0].name = "skin";
    return s;
}

}  // namespace

std::vector<Reader> readers() {
    const bench::TemporaryFolder temporary("pellucid-fuzz-");
    const std::string folder = temporary.path() + "/";
    const Device device("");
    std::vector<Reader> all;
    addMeshes(all, folder);
    addImages(all, folder);
    all.push_back(table(folder, device));
    const std::string head = "name = \"a\"\nsource = \"s\"\nkind = ";
    const std::vector<std::string> profiles{
        head + "\"skin\"\n",
        head +
            "\"dipole\"\nunit = \"mm\"\nabsorption = [0.0021, 0.0041, 0.0071]\n"
            "reduced_scattering = [2.19, 2.62, 3.00]\neta = 1.5\n",
        head +
            "\"burley\"\nunit = \"cm\"\nmean_free_path = [1.3, 0.95, 0.67]\n"
            "albedo = [0.44, 0.22, 0.13]\nfit = \"searchlight\"\n",
        head + "\"burley\"\nunit = \"um\"\ndistance = [300, 100, 50]\n",
        head +
            "\"table\"\nunit = \"mm\"\n[[sample]]\ndistance = 0\nvalue = [1, 1, 1]\n"
            "[[sample]]\ndistance = 2\nvalue = [0, 0, 0]\n"};
    all.push_back(text(
        "profile", profiles, [](const std::string& t) { io::parseProfile("p.toml", t); },
        {"variance", "weight", "albedo", "mean_free_path", "eta", "table", "[[gaussian]]", "[[sample]]"}));
    io::writeScene(folder + "s.toml", scene());
    all.push_back(text("scene", {io::readWholeFile(folder + "s.toml")},
                       [](const std::string& t) {
                           // A scene that can be read can be written, and read again.
                           io::parseScene("s.toml", io::sceneText(io::parseScene("s.toml", t)));
                       },
                       {"[[light]]", "[[material]]", "[channels]", "[outputs]", "shadow_map", "cascade_1",
                        "thickness_taps", "version = 2", "[[eye]]", "iris_radius", "limbus_radius",
                        "iris_texture", "caustics", "target_error"}));
    all.push_back(
        text("manifest",
             {"[[lut]]\nkind = \"shadow\"\nsize = 256\n[[grid]]\nkind = \"curvature\"\nprofile = [\"skin\", "
              "\"own.toml\"]\ndiffusion_radius = [1.0, 2.7]\nform = [\"arc\", \"sphere\"]\naxis = "
              "\"root\"\nsize = [32, 64]\nencoding = \"half\"\nradius_min = 1.0\n"},
             [own = profiles[1]](const std::string& t) {
                 io::parseManifest("m.toml", t, {{"own.toml", own}});
             },
             {"[[lut]]", "[[grid]]", "size", "profile", "encoding", "16384", "specular"}));
    all.push_back(topology(device));
    all.push_back(gltfScenes(folder));
    all.push_back(
        {"report",
         {R"({"host":{"pellucid":"0","date":"","cpu":"c"},"devices":[{"name":"a","platform":"p",)"
          R"("copy_bytes_per_second":1e10,"operations_per_second":1e11,"operations":[{"name":"o",)"
          R"("group":"tables","items":100,"samples":9,"median_ms":1.5,"mad_ms":0.1,"error_max":1e-6},)"
          R"({"name":"q","group":"tables","items":1,"failed":"x"}]}]})"},
         [](const std::string& t) {
             const auto report = bench::parseReport(t);
             if (report.is_discarded()) return;
             bench::describeComparison(bench::compareReports(report, report));
         },
         {},
         {"null", "{}", "[]", "1e999", "-0", "\"\"", "\\u0000", ","}});
    return all;
}

bool promised(const std::exception& error) {
    return dynamic_cast<const io::FileError*>(&error) || dynamic_cast<const Error*>(&error) ||
           dynamic_cast<const nlohmann::json::exception*>(&error);
}

}  // namespace fuzz
