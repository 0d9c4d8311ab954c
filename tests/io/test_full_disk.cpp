// Every writer of host/io on a disk that is full, and on one that becomes full while it writes: an error that
// names the file, the old file as it was, and nothing left behind.
#include <functional>
#include <memory>

#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image/image_file.h"
#include "io/image/texture_file.h"
#include "io/lut/lut_file.h"
#include "io/mesh/mesh_file.h"
#include "io/scene/scene_file.h"
#include "io_files.h"
#include "small_disk.h"

using namespace pellucid;
using namespace pellucid::io;

namespace {

constexpr int side = 64;  // pixels: most formats take several pages

struct Writer {
    const char* file;
    std::function<void(const std::string&)> write;
};

std::vector<uint8_t> noise(size_t count) {
    std::vector<uint8_t> bytes(count);
    uint32_t state = 1;
    for (uint8_t& b : bytes) b = uint8_t((state = state * 1664525u + 1013904223u) >> 24);
    return bytes;
}

Image noisyImage() {
    Image image;
    image.width = image.height = side;
    std::vector<float> values;
    for (uint8_t b : noise(3 * side * side)) values.push_back(float(b) * 1.37f);
    image.addInterleaved(std::vector<std::string>{"R", "G", "B"}, values);
    return image;
}

MeshData manyTriangles() {
    MeshData mesh;
    for (uint32_t i = 0; i < 3000; ++i) {
        mesh.positions.push_back(float(i));
        mesh.triangles.push_back(i % 1000);
    }
    return mesh;
}

SceneFile manyLights() {
    SceneFile scene;
    scene.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
    scene.lights.resize(100);
    return scene;
}

const std::vector<Writer>& writers() {
    static const std::vector<Writer> all = [] {
        std::vector<Writer> w;
        for (const char* name : {"o.png", "o.bmp", "o.tga"})
            w.push_back(
                {name, [](const std::string& p) { writeImage8(p, side, side, 3, noise(3 * side * side)); }});
        w.push_back({"o.exr", [](const std::string& p) { writeExr(p, noisyImage()); }});
        const size_t shape[] = {side, side, 3};
        w.push_back(
            {"o.npy", [shape](const std::string& p) {
                 writeNpy(p, shape, noisyImage().interleaved(std::vector<std::string>{"R", "G", "B"}));
             }});
        w.push_back({"u.npy", [shape](const std::string& p) { writeNpy(p, shape, noise(3 * side * side)); }});
        w.push_back({"o.ply", [](const std::string& p) {
                         writePly(p, manyTriangles(), std::vector<float>(1000, 0.5f), 0, 1);
                     }});
        w.push_back({"o.dds", [](const std::string& p) {
                         writeDds(p, {Texture::Format::Rgba16Float, side, side, noise(8 * side * side)});
                     }});
        w.push_back({"o.ktx2", [](const std::string& p) {
                         writeKtx2(p, {Texture::Format::Rgba16Float, side, side, noise(8 * side * side)}, {});
                     }});
        w.push_back({"o.toml", [](const std::string& p) { writeScene(p, manyLights()); }});
        const auto lut = std::make_shared<Lut>(Device(""), [] {
            PelShadowLutDesc desc = pelShadowLutDescFaceWorks();
            desc.width = desc.height = side;
            return desc;
        }());
        for (const char* name :
             {"lut.exr", "lut.npy", "lut.png", "lut.bmp", "lut.tga", "lut.dds", "lut.ktx2"})
            w.push_back({name, [lut](const std::string& p) { writeLut(p, *lut); }});
        for (const char* name : {"bc6h.dds", "bc6h.ktx2"})
            w.push_back({name, [lut](const std::string& p) { writeLutBc6h(p, *lut); }});
        w.push_back({"o.html", [](const std::string& p) { writeWholeFile(p, std::string(20000, 'x')); }});
        return w;
    }();
    return all;
}

}  // namespace

TEST(FullDisk, EveryWriterFailsAndLeavesWhatWasThere) {
    const SmallDisk disk(1024);
    NEEDS_DISK(disk);
    for (const Writer& w : writers()) {
        disk.empty();
        const std::string path = disk.path(w.file);
        w.write(path);
        const size_t whole = std::filesystem::file_size(path);
        // A disk that is full, one that is almost full, and one that lacks the last page of this file.
        for (size_t left : {size_t{0}, size_t{4096}, (whole - 1) / 4096 * 4096}) {
            if (left / 4096 >= (whole + 4095) / 4096) continue;  // a small one fits
            disk.empty();
            writeWholeFile(path, "old");
            disk.fill(left);
            const std::string message = messageOf<FileError>([&] { w.write(path); });
            EXPECT_TRUE(contains(message, path + ": cannot be written: No space left on device"))
                << left << " bytes left";
            EXPECT_EQ(std::filesystem::file_size(path), 3u) << w.file << " with " << left << " bytes left";
            EXPECT_EQ(disk.files(), 1u) << w.file << ": something is left behind";
        }
        disk.empty();
        w.write(path);
        EXPECT_EQ(std::filesystem::file_size(path), whole) << w.file;
    }
}
