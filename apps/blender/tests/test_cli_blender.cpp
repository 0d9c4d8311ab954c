// G-buffers as Blender's Cycles writes them, through `pellucid shade` (docs/guide/blender.md): with
// scattering off the picture is Blender's Lambert picture; with scattering on, it is closer to the
// path-traced picture. Pictures: PELLUCID_GBUFFER_DIR.
#include "cli/cli_run.h"
#include "io/image/image_compare.h"
#include "io/image/image_file.h"

using namespace pellucid;

namespace {

const double toLight[3] = {0.7990018725395203, -0.44943854212760925, 0.39950093626976013};

const char* const names = R"(version = 1
[channels]
material = "IndexOB.X"
normal_shading = ["NShading.R", "NShading.G", "NShading.B"]
albedo = ["DiffCol.R", "DiffCol.G", "DiffCol.B"]
)";
const char* const light = R"([[light]]
to_light = [0.7990018725395203, -0.44943854212760925, 0.39950093626976013]
)";

// `layer`: "" in our pictures, "Combined." in Blender's, which have other colours beside it.
std::vector<float> rgb(const io::Image& image, const std::string& layer = "Combined.") {
    const std::vector<std::string> channels{layer + "R", layer + "G", layer + "B"};
    return image.interleaved(channels);
}

class BlenderGBuffer : public CommandTest {
  protected:
    std::vector<float> shade(const std::string& gbuffer, const std::string& scene) const {
        write("scene.toml", scene);
        done("shade '" + gbuffer + "' --scene @scene.toml -o @out.exr");
        return rgb(io::readImage(path("out.exr")), "");
    }
};

class BlenderReference : public BlenderGBuffer {
  protected:
    void SetUp() override {
        BlenderGBuffer::SetUp();
        const char* folder = std::getenv("PELLUCID_GBUFFER_DIR");
        if (!folder) GTEST_SKIP() << "PELLUCID_GBUFFER_DIR does not say where Blender's pictures are";
        root_ = std::string(folder) + "/";
    }
    std::string root_;
};

// The pixels whose id is 1.
std::vector<uint8_t> maskOf(const io::Image& gbuffer) {
    std::vector<uint8_t> mask;
    for (const float id : gbuffer.channel("IndexOB.X").pixels) mask.push_back(id == 1);
    return mask;
}

}  // namespace

TEST_F(BlenderReference, WithoutScatteringItIsTheLambertPicture) {
    for (const std::string name : {"sphere10", "head"}) {
        const std::string gbuffer = root_ + name + "_gbuf.exr";
        const std::vector<float> out =
            shade(gbuffer, std::string(names) + light + "wide_shadow = \"Shadow.R\"\n[[material]]\nid = 1\n");
        ASSERT_FALSE(out.empty());
        const std::vector<uint8_t> mask = maskOf(io::readImage(gbuffer));
        const io::ImageDifference e =
            io::compareImages(out, rgb(io::readImage(root_ + name + "_side_lambert.exr")), mask);
        EXPECT_GT(e.pixels, 30000u);
        for (const double rms : e.rmse) EXPECT_LT(rms, tolerance::blenderLambert) << name;
        // What is outside the object stays as it was: black.
        for (size_t i = 0; i < mask.size(); ++i)
            if (!mask[i]) {
                ASSERT_EQ(out[3 * i], 0) << name << ", pixel " << i;
            }
    }
}

// Burley's profile by tables, against Cycles' Burley and, near the terminator, its random walk.
TEST_F(BlenderReference, ScatteringComesCloserToThePathTracedSphere) {
    io::Image gbuffer = io::readImage(root_ + "sphere10_gbuf.exr");
    // The sphere's radius is 1, in cm like all lengths of these files.
    gbuffer.channels.push_back(
        {"ViewLayer.Curvature.X", io::ChannelType::Float, gbuffer.channel("IndexOB.X").pixels});
    io::writeExr(path("gbuffer.exr"), gbuffer);
    // Blender's Burley "radius" is 4 pi d.
    write("burley.toml",
          "name = \"burley\"\nkind = \"burley\"\nunit = \"cm\"\nsource = \"Blender\"\n"
          "distance = [0.0292, 0.0109, 0.00541]\n");
    // No shadow: a sphere casts none on itself, and Blender's is black past the terminator.
    const std::vector<float> out = shade(
        path("gbuffer.exr"), "unit_mm = 10\n" + std::string(names) + "curvature = \"Curvature.X\"\n" + light +
                                 "[[material]]\nid = 1\nprofile = \"burley.toml\"\n"
                                 "scattering = \"preintegrated\"\n");
    ASSERT_FALSE(out.empty());
    const std::vector<std::string> normals{"NShading.R", "NShading.G", "NShading.B"};
    const std::vector<float> n = gbuffer.interleaved(normals),
                             lambert = rgb(io::readImage(root_ + "sphere10_side_lambert.exr"));
    const std::vector<uint8_t> mask = maskOf(gbuffer);
    std::vector<uint8_t> band =
        mask;  // about the terminator, the one place where scattering shows on a sphere
    for (size_t i = 0; i < band.size(); ++i) {
        double cosine = 0;
        for (size_t c = 0; c < 3; ++c) cosine += n[3 * i + c] * toLight[c];
        if (std::abs(cosine) > 0.2) band[i] = 0;
    }
    for (const auto& [file, within] : {std::pair{"BURLEY", &mask}, {"BURLEY", &band}, {"RW", &band}}) {
        const std::vector<float> truth = rgb(io::readImage(root_ + "sphere10_side_" + file + ".exr"));
        const io::ImageDifference ours = io::compareImages(out, truth, *within),
                                  plain = io::compareImages(lambert, truth, *within);
        for (size_t c = 0; c < 3; ++c) EXPECT_LT(ours.rmse[c], plain.rmse[c]) << file << ", channel " << c;
        // Scattering matters most for red light near the terminator.
        if (file == std::string("BURLEY") && within == &band) {
            EXPECT_LT(ours.rmse[0], tolerance::blenderTerminator * plain.rmse[0]);
        }
    }
}

// The same names and habits in a file made here: layers, half and float mixed, depth of 1e10, z up.
TEST_F(BlenderGBuffer, ConventionsOnAFileOfOurOwn) {
    const int size = 48;
    io::Image image;
    image.width = image.height = size;
    std::vector<float> normal, albedo, id, depth, expected;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            // A unit sphere seen along +y from below 0, z up: image right is +x.
            const double px = (x + 0.5) / size * 2.4 - 1.2, pz = 1.2 - (y + 0.5) / size * 2.4,
                         rest = 1 - px * px - pz * pz;
            const bool hit = rest > 0;
            const double n[3] = {px, hit ? -std::sqrt(rest) : 0, pz};
            double lit = 0;
            for (int i = 0; i < 3; ++i) {
                normal.push_back(hit ? float(n[i]) : 0);
                albedo.push_back(hit ? 0.25f * float(i + 1) : 0);
                lit += n[i] * toLight[i];
            }
            id.push_back(hit);
            depth.push_back(hit ? float(10 - std::sqrt(rest)) : 1e10f);
            for (int i = 0; i < 3; ++i)
                expected.push_back(hit ? float(0.25 * (i + 1) * std::max(lit, 0.0)) : 0);
        }
    using Names = std::vector<std::string>;
    image.addInterleaved(Names{"ViewLayer.Depth.Z"}, depth);
    image.addInterleaved(Names{"ViewLayer.DiffCol.R", "ViewLayer.DiffCol.G", "ViewLayer.DiffCol.B"}, albedo,
                         io::ChannelType::Half);
    image.addInterleaved(Names{"ViewLayer.IndexOB.X"}, id, io::ChannelType::Half);
    image.addInterleaved(Names{"ViewLayer.NShading.R", "ViewLayer.NShading.G", "ViewLayer.NShading.B"},
                         normal);
    io::writeExr(path("gbuffer.exr"), image);
    const std::vector<float> out =
        shade(path("gbuffer.exr"), std::string(names) + light + "[[material]]\nid = 1\n");
    ASSERT_EQ(out.size(), expected.size());
    for (const double most : io::compareImages(out, expected).max) EXPECT_LT(most, tolerance::shadeTerm);

    // A missing pass is named, with what there is.
    std::string wrong = names;
    wrong.replace(wrong.find("DiffCol.R"), 9, "Diffuse.R");
    write("scene.toml", wrong + light + "[[material]]\nid = 1\n");
    refused("shade @gbuffer.exr --scene @scene.toml -o @no.exr", 3, "ViewLayer.DiffCol.R");
}
