// G-buffers as Blender's Cycles writes them, through `pellucid shade` (docs/guide/blender.md): with
// scattering off the picture is Blender's Lambert picture; with it on it is nearer to the path-traced one.
// Pictures: PELLUCID_GBUFFER_DIR.
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <pellucid/pellucid.hpp>

#include "cli/cli_run.h"
#include "io/image/image_file.h"
#include "io/lut/lut_file.h"
#include "tolerances.h"

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

// Root of the mean square differences of two pictures where the mask is 1, per channel, and the largest one.
struct Difference {
    double rms[3] = {}, max = 0;
    size_t pixels = 0;
};

// `layer`: "" in our pictures, "Combined." in Blender's, which have other colours beside it.
std::vector<float> rgb(const io::Image& image, const std::string& layer = "Combined.") {
    const std::vector<std::string> channels{layer + "R", layer + "G", layer + "B"};
    return image.interleaved(channels);
}

Difference compare(const std::vector<float>& a, const std::vector<float>& b, const std::vector<float>& mask) {
    Difference e;
    for (size_t i = 0; i < mask.size(); ++i) {
        if (mask[i] != 1) continue;
        ++e.pixels;
        for (size_t c = 0; c < 3; ++c) {
            const double d = double(a[3 * i + c]) - b[3 * i + c];
            e.rms[c] += d * d;
            e.max = std::max(e.max, std::abs(d));
        }
    }
    for (double& r : e.rms) r = std::sqrt(r / double(std::max<size_t>(e.pixels, 1)));
    return e;
}

// The same of the means over pixels of equal N.L: a sphere lit by a sun has one value there, and its mean
// has little noise. Each mean counts as often as it has pixels.
Difference compareCurves(const std::vector<float>& a, const std::vector<float>& b,
                         const std::vector<float>& mask, const std::vector<double>& cosines) {
    constexpr size_t bins = 100;
    std::vector<float> means[2] = {std::vector<float>(3 * bins), std::vector<float>(3 * bins)};
    std::vector<float> counts(bins), smooth[2] = {a, b};
    const auto binOf = [&](size_t i) { return std::min(size_t((cosines[i] + 1) / 2 * bins), bins - 1); };
    for (size_t i = 0; i < mask.size(); ++i) counts[binOf(i)] += float(mask[i] == 1);
    for (const bool spread : {false, true})
        for (size_t i = 0; i < mask.size(); ++i)
            for (size_t c = 0; c < 3 && mask[i] == 1; ++c)
                for (size_t k = 0; k < 2; ++k) {
                    float& mean = means[k][3 * binOf(i) + c];
                    spread ? smooth[k][3 * i + c] = mean : mean += smooth[k][3 * i + c] / counts[binOf(i)];
                }
    return compare(smooth[0], smooth[1], mask);
}

class BlenderGBuffer : public CommandTest {
  protected:
    std::vector<float> shade(const std::string& gbuffer, const std::string& scene) const {
        const Result result =
            run({"shade", gbuffer, "--scene", write("scene.toml", scene), "-o", path("out.exr")});
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return result.exitCode == 0 ? rgb(io::readImage(path("out.exr")), "") : std::vector<float>();
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

// Ours is nearer to the path-traced picture than Lambert is, `share` times or less.
void expectNearer(const char* what, const Difference& ours, const Difference& lambert, double share = 1) {
    std::printf("%s: RMSE %.5f %.5f %.5f, Lambert %.5f %.5f %.5f, %zu pixels\n", what, ours.rms[0],
                ours.rms[1], ours.rms[2], lambert.rms[0], lambert.rms[1], lambert.rms[2], ours.pixels);
    for (int c = 0; c < 3; ++c) EXPECT_LT(ours.rms[c], share * lambert.rms[c]) << what << ", channel " << c;
}

}  // namespace

TEST_F(BlenderReference, WithoutScatteringItIsTheLambertPicture) {
    for (const std::string name : {"sphere10", "head"}) {
        const std::string gbuffer = root_ + name + "_gbuf.exr";
        const std::vector<float> out =
            shade(gbuffer, std::string(names) + light + "wide_shadow = \"Shadow.R\"\n[[material]]\nid = 1\n");
        ASSERT_FALSE(out.empty());
        const std::vector<float> mask = io::readImage(gbuffer).channel("IndexOB.X").pixels;
        const Difference e = compare(out, rgb(io::readImage(root_ + name + "_side_lambert.exr")), mask);
        std::printf("%s: RMSE %.2g, largest %.2g, %zu pixels\n", name.c_str(), e.rms[0], e.max, e.pixels);
        EXPECT_GT(e.pixels, 30000u);
        for (const double rms : e.rms) EXPECT_LT(rms, tolerance::blenderLambert) << name;
        // What is outside the object stays as it was: black.
        for (size_t i = 0; i < mask.size(); ++i)
            if (mask[i] != 1) {
                ASSERT_EQ(out[3 * i], 0) << name << ", pixel " << i;
            }
    }
}

TEST_F(BlenderReference, ScatteringComesCloserToThePathTracedSphere) {
    io::Image gbuffer = io::readImage(root_ + "sphere10_gbuf.exr");
    const std::vector<float> mask = gbuffer.channel("IndexOB.X").pixels;
    // The sphere's radius is 1, in cm like all lengths of these files.
    gbuffer.channels.push_back({"ViewLayer.Curvature.X", io::ChannelType::Float, mask});
    io::writeExr(path("gbuffer.exr"), gbuffer);

    // Blender's Burley "radius" is 4 pi d of R(d) = (exp(-r/d) + exp(-r/3d)) / (8 pi d r); s = 1.1 at albedo
    // 0.8.
    const float radius[3] = {0.367f, 0.137f, 0.068f};
    float meanFreePath[3];
    for (int c = 0; c < 3; ++c) meanFreePath[c] = 1.1f * radius[c] / (4 * std::numbers::pi_v<float>);
    const float albedo[3] = {0.8f, 0.8f, 0.8f};
    PelProfile handle = nullptr;
    check(pelProfileCreateBurley(meanFreePath, albedo, PEL_BURLEY_DIFFUSE_TRANSMISSION, &handle));
    const Profile profile(handle);
    const Device device("");
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.profile = profile.get();
    desc.form = PEL_FORM_SPHERE;
    desc.diffusionRadius = 0;
    desc.radiusMin = 0.1f;
    desc.radiusMax = 10;
    const Lut lut(device, desc);
    io::writeLut(path("burley.exr"), lut);
    const std::string material = "[[material]]\nid = 1\ncurvature_lut = \"burley\"\ndiffusion_radius = " +
                                 std::to_string(lut.info().curvature.diffusionRadius) +
                                 "\n[[curvature_lut]]\nname = \"burley\"\nfile = \"burley.exr\"\n";
    // No shadow: a sphere casts none on itself, and Blender's is black past the terminator, where scattered
    // light is.
    const std::vector<float> out =
        shade(path("gbuffer.exr"), std::string(names) + "curvature = \"Curvature.X\"\n" + light + material);
    ASSERT_FALSE(out.empty());

    const std::vector<float> lambert = rgb(io::readImage(root_ + "sphere10_side_lambert.exr"));
    const std::vector<std::string> normals{"NShading.R", "NShading.G", "NShading.B"};
    const std::vector<float> n = gbuffer.interleaved(normals);
    std::vector<float> band = mask;  // about the terminator, the one place where scattering shows on a sphere
    std::vector<double> cosines(mask.size());
    for (size_t i = 0; i < band.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) cosines[i] += n[3 * i + c] * toLight[c];
        if (std::abs(cosines[i]) > 0.2) band[i] = 0;
    }

    const std::vector<float> burley = rgb(io::readImage(root_ + "sphere10_side_BURLEY.exr"));
    const std::vector<float> walk = rgb(io::readImage(root_ + "sphere10_side_RW.exr"));
    expectNearer("Burley", compare(out, burley, mask), compare(lambert, burley, mask));
    expectNearer("Burley, |N.L| < 0.2", compare(out, burley, band), compare(lambert, burley, band));
    expectNearer("random walk, |N.L| < 0.2", compare(out, walk, band), compare(lambert, walk, band));
    expectNearer("Burley, means over equal N.L", compareCurves(out, burley, mask, cosines),
                 compareCurves(lambert, burley, mask, cosines));
    // Where it matters most: red light near the terminator.
    EXPECT_LT(compare(out, burley, band).rms[0],
              tolerance::blenderTerminator * compare(lambert, burley, band).rms[0]);

    // Blender's random walk reflects more than the albedo it was given, by one factor per channel wherever
    // the light is. Brighter by that factor, measured in the light and in every other pixel, ours comes
    // closer over the other pixels of the whole sphere too, and closer than Lambert's does.
    std::vector<float> others = mask, bright = out, brightLambert = lambert;
    for (size_t i = 0; i < mask.size(); i += 2) others[i] = 0;
    for (std::vector<float>* picture : {&bright, &brightLambert})
        for (size_t c = 0; c < 3; ++c) {
            double both = 0, square = 0;  // least squares
            for (size_t i = 0; i < mask.size(); i += 2)
                if (mask[i] == 1 && cosines[i] >= 0.5) {
                    const double p = (*picture)[3 * i + c];
                    both += walk[3 * i + c] * p, square += p * p;
                }
            for (size_t i = 0; i < mask.size(); ++i) (*picture)[3 * i + c] *= float(both / square);
        }
    expectNearer("random walk, albedo as measured, other pixels", compare(bright, walk, others),
                 compare(lambert, walk, others));
    const Difference curve = compareCurves(bright, walk, mask, cosines);
    expectNearer("the same, means over equal N.L", curve, compareCurves(lambert, walk, mask, cosines),
                 tolerance::blenderCurve);
    expectNearer("against Lambert with its albedo as measured", curve,
                 compareCurves(brightLambert, walk, mask, cosines));
}

// The same names and habits in a file made here: layers, half and float mixed, depth of 1e10 and zeros
// behind, z up.
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
    const Difference e = compare(out, expected, std::vector<float>(id.size(), 1.0f));
    EXPECT_LT(e.max, tolerance::shadeTerm);

    // A missing pass is named, with what there is.
    std::string wrong = names;
    wrong.replace(wrong.find("DiffCol.R"), 9, "Diffuse.R");
    expectRefused({"shade", path("gbuffer.exr"), "--scene",
                   write("scene.toml", wrong + light + "[[material]]\nid = 1\n"), "-o", path("no.exr")},
                  3, "ViewLayer.DiffCol.R");
}
