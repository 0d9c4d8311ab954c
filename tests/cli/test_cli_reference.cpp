// `pellucid reference` and `pellucid compare` as users run them: a ball whose reference has a closed form.
#include "cli_shade.h"
#include "io/image/flip.h"
#include "reference/shade.h"
#include "sample/mesh.h"

using namespace pellucid;
using namespace shade_files;

namespace {

using Shape = std::vector<size_t>;

class CliReference : public CommandTest {
  protected:
    static constexpr int side = 16;
    static constexpr double radius = 10;

    void SetUp() override {
        CommandTest::SetUp();
        writeBall(sized(40, 12));
        write("burley.toml",
              "name = \"burley\"\nsource = \"test\"\nkind = \"burley\"\nunit = \"mm\"\n"
              "distance = [1, 0.5, 0.25]\n");
        // Seen from +z, in parallel; lit from +x.
        gbuffer_.width = gbuffer_.height = side;
        const auto inside = [](double u, double v) { return u * u + v * v < 0.95; };
        const auto normal = [inside](int x, int y, size_t c) {
            const double u = 2 * (x + 0.5) / side - 1, v = 1 - 2 * (y + 0.5) / side;
            const double n[3] = {u, v, std::sqrt(std::max(0.0, 1 - u * u - v * v))};
            return inside(u, v) ? n[c] : 0;
        };
        const Names normals{"N.X", "N.Y", "N.Z"};
        addChannels(gbuffer_, positionNames,
                    [&](int x, int y, size_t c) { return radius * normal(x, y, c); });
        addChannels(gbuffer_, normals, normal);
        addChannels(gbuffer_, {"Id.X"}, [&](int x, int y, size_t) { return normal(x, y, 2) > 0; });
        io::writeExr(path("g.exr"), gbuffer_);
        scene_.channels[PEL_SLOT_POSITION] = positionNames;
        scene_.channels[PEL_SLOT_NORMAL_SHADING] = normals;
        scene_.channels[PEL_SLOT_MATERIAL] = {"Id.X"};
        scene_.materials.resize(1);
        scene_.materials[0].profile = "skin";
        scene_.lights.resize(1);
        scene_.lights[0].light = directionalLight({1, 0, 0}, {1, 1, 1});
        writeScene();
    }
    void writeBall(int rings) const {
        const auto ball = sample::makeSphere(radius, rings, 2 * rings);
        std::ostringstream off;
        off << "OFF\n" << ball.positions.size() / 3 << ' ' << ball.triangles.size() / 3 << " 0";
        for (size_t i = 0; i < ball.positions.size(); ++i) off << (i % 3 ? " " : "\n") << ball.positions[i];
        for (size_t i = 0; i < ball.triangles.size(); ++i) off << (i % 3 ? " " : "\n3 ") << ball.triangles[i];
        write("ball.off", off.str() + "\n");
    }
    const std::vector<float>& given(const char* name) const { return gbuffer_.channel(name).pixels; }
    void npy(const std::string& name, const Shape& shape, const std::vector<float>& values) const {
        io::writeNpy(path(name), shape, values);
    }
    void writeScene() const { io::writeScene(path("s.toml"), scene_); }
    io::Image image(const std::string& file) const { return io::readImage(path(file)); }
    auto array(const std::string& file) const { return io::readNpy(path(file)); }
    io::Image gbuffer_;
    io::SceneFile scene_;
};

const std::string ofBall = "reference @ball.off --scene @s.toml ", picture = "--gbuffer @g.exr ",
                  fine = "--finest 0.3 --coarsest 1 ";

}  // namespace

// What the integral is: tests/diffusion/test_surface_integral.cpp.
TEST_F(CliReference, PixelsOfABall) {
    const auto report = reportOf(ofBall + picture + fine + "-o @o.exr");
    expectReport(report);
    EXPECT_LT(report["points_off_mesh"].get<double>(), 1);
    EXPECT_EQ(report["points"], std::ranges::count(given("Id.X"), 1.0f));
    const io::Image out = image("o.exr");
    for (size_t i = 0; i < out.pixelCount(); ++i) {
        const float light = out.channel("Irradiance.R").pixels[i];
        EXPECT_NEAR(light, std::max(0.0f, given("P.X")[i] / float(radius)), given("Id.X")[i] ? 0.1 : 0);
        for (const std::string name : {"R", "G", "B"})
            EXPECT_NEAR(out.channel(name).pixels[i], 0.5 * out.channel("Surface." + name).pixels[i], 1e-6)
                << "the material's albedo";
        EXPECT_NEAR(out.channel("Surface.B").pixels[i], light, 0.2) << "blue hardly scatters";
    }
}

TEST_F(CliReference, VerticesUnitAndProfile) {
    done(ofBall + fine + "-o @v.npy");
    const auto values = array("v.npy");
    ASSERT_EQ(values.shape.size(), 2u);
    EXPECT_EQ(values.shape[1], 3u);
    // A ball of 10 cm hardly scatters.
    done(ofBall + picture + fine + "--unit-mm 10 -o @o.exr");
    const io::Image wide = image("o.exr");
    for (size_t i = 0; i < wide.pixelCount(); ++i) {
        if (given("P.X")[i] < 2) continue;
        EXPECT_NEAR(wide.channel("Surface.B").pixels[i], wide.channel("Irradiance.B").pixels[i],
                    testsAreSmall() ? 0.1 : 0.02);
    }
    // The material's profile, unless another is named.
    done(ofBall + "--finest 0.5 --coarsest 2 --profile marble -o @named.npy");
    scene_.materials[0].profile = "marble";
    writeScene();
    done(ofBall + "--finest 0.5 --coarsest 2 -o @own.npy");
    EXPECT_TRUE(read(path("own.npy")) == read(path("named.npy")));
    // The same of its radius, in the scene's unit.
    scene_.options.millimetresPerUnit = 2;
    writeScene();
    done(ofBall + "--finest 0.5 --coarsest 2 --diffusion-radius 0.6 -o @named.npy");
    scene_.materials[0].material.diffusionRadius = 0.3f;
    writeScene();
    done(ofBall + "--finest 0.5 --coarsest 2 -o @own.npy");
    EXPECT_TRUE(read(path("own.npy")) == read(path("named.npy")));
}

TEST_F(CliReference, AmbientLightIsThatOfItsHarmonics) {
    scene_.lights.clear();
    reference::Ambient truth{{2, 0, 0}, {}};
    scene_.ambient.constant[0] = 2;
    for (size_t i = 0; i < 9; ++i) {
        truth.harmonics[i] = {0.1 * double(i + 1), double(i == 1), 0};
        for (int c = 0; c < 3; ++c) scene_.ambient.sh[i][c] = float(truth.harmonics[i][c]);
    }
    writeScene();
    done(ofBall + picture + fine + "-o @o.exr");
    const io::Image out = image("o.exr");
    for (size_t i = 0; i < out.pixelCount(); ++i) {
        if (!given("Id.X")[i]) continue;
        const auto light = reference::irradiance(truth, {given("N.X")[i], given("N.Y")[i], given("N.Z")[i]});
        EXPECT_NEAR(out.channel("Irradiance.R").pixels[i], light.x, 0.02) << i;
        EXPECT_NEAR(out.channel("Irradiance.G").pixels[i], light.y, 0.02) << i;
    }
}

// A lamp at x = 20, by its distance and the cosine from its axis.
TEST_F(CliReference, LampsEndAtTheirRangeAndCone) {
    PelLight& lamp = scene_.lights[0].light;
    lamp.position[0] = 20, lamp.spotDirection[0] = -1, lamp.spotDirection[2] = 0;
    const auto lit = [&](PelLightType type, float range) {
        lamp.type = type, lamp.range = range;
        writeScene();
        done(ofBall + picture + "--finest 2 --coarsest 4 -o @o.exr");
        return image("o.exr").channel("Irradiance.R").pixels;
    };
    lamp.spotCosInner = 0.92f, lamp.spotCosOuter = 0.88f;
    const auto whole = lit(PEL_LIGHT_POINT, 0), ended = lit(PEL_LIGHT_POINT, 14),
               cone = lit(PEL_LIGHT_SPOT, 0);
    int inside = 0;
    for (size_t i = 0; i < whole.size(); ++i) {
        const double x = 20 - given("P.X")[i], y = given("P.Y")[i], z = given("P.Z")[i],
                     distance = std::hypot(x, y, z), cosine = x / distance;
        if (whole[i] == 0) continue;
        EXPECT_LE(ended[i], whole[i]) << i;
        if (std::abs(distance - 14) > 0.5) {
            EXPECT_EQ(ended[i] > 0, distance < 14) << distance;
        }
        if (std::abs(cosine - 0.88) > 0.01) {
            EXPECT_EQ(cone[i] > 0, cosine > 0.88) << cosine;
        }
        if (cosine > 0.93) {
            EXPECT_EQ(cone[i], whole[i]) << cosine;
        }
        inside += distance < 13 && cosine > 0.93;
    }
    EXPECT_GT(inside, 2);
}

TEST_F(CliReference, WalkWritesHalvesForCompare) {
    const std::string walk =
        ofBall + picture + "--walk --profile @burley.toml --reflectance 0.8 0.8 0.8 --samples 24 -o ";
    const auto medium = reportOf(walk + "@w.exr", "OMP_NUM_THREADS=3")["media"][0];
    EXPECT_NEAR(medium["mean_free_path"][1].get<double>(), 1.087 * 0.5, 0.01);
    EXPECT_NEAR(medium["single_scattering_albedo"][2].get<double>(), 0.99055, 1e-4);
    const io::Image out = image("w.exr");
    double difference = 0;
    int count = 0;
    for (size_t i = 0; i < out.pixelCount(); ++i) {
        const float first = out.channel("First.R").pixels[i], second = out.channel("Second.R").pixels[i];
        EXPECT_NEAR(out.channel("R").pixels[i], (first + second) / 2, 1e-5);
        EXPECT_NEAR(out.channel("R").pixels[i], 0.5 * out.channel("Surface.R").pixels[i], 1e-5) << "albedo";
        if (given("Id.X")[i] == 0) continue;
        difference += std::pow(first - second, 2), ++count;
        EXPECT_NEAR(out.channel("MeanCurvature").pixels[i], 1 / radius, testsAreSmall() ? 0.05 : 0.002);
        EXPECT_NEAR(out.channel("Thickness").pixels[i], 2 * radius, testsAreSmall() ? 1 : 0.1);
    }
    EXPECT_GT(difference / count, 1e-5) << "halves are independent";
    done(walk + "@again.exr", "OMP_NUM_THREADS=1");
    EXPECT_TRUE(read(path("w.exr")) == read(path("again.exr"))) << "one thread and three";
    // A medium of almost no reach is thick and flat everywhere.
    const auto report = reportOf("compare @w.exr @w.exr --gbuffer @g.exr --scene @s.toml");
    EXPECT_EQ(report["subsets"]["hollows"]["pixels"].get<size_t>(), 0u);
    EXPECT_EQ(report["subsets"]["thin"]["pixels"].get<size_t>(), 0u);
    EXPECT_NEAR(report["all"]["noise"][0].get<double>(), std::sqrt(difference / count) / 2, 1e-5);
    // As A, a walk is its mean.
    io::Image mean;
    mean.width = mean.height = side;
    mean.addInterleaved(colorNames, out.interleaved(colorNames));
    io::writeExr(path("mean.exr"), mean);
    EXPECT_LT(reportOf("compare @w.exr @mean.exr")["all"]["rmse_all"].get<double>(), 1e-6);
}

// In a walk too, and at vertices.
TEST_F(CliReference, MaterialsWithoutAProfileReflectWhatArrives) {
    scene_.materials[0].profile = "";
    writeScene();
    done(ofBall + picture + "-o @o.exr");
    done(ofBall + picture + "--walk -o @w.exr");
    const io::Image plain = image("o.exr");
    EXPECT_EQ(plain.channel("Surface.R").pixels, plain.channel("Irradiance.R").pixels);
    EXPECT_EQ(image("w.exr").channel("Second.R").pixels, plain.channel("R").pixels);
    done(ofBall + "-o @v.npy");
    done(ofBall + "--walk -o @w.npy");
    const auto once = array("v.npy"), twice = array("w.npy");
    EXPECT_EQ(twice.shape, (Shape{2, once.shape[0], 3}));
    EXPECT_GT(*std::max_element(once.values.begin(), once.values.end()), 0.8f);
    EXPECT_TRUE(std::equal(once.values.begin(), once.values.end(),
                           twice.values.end() - ptrdiff_t(once.values.size())));
    scene_.materials[0].preset = io::ScenePreset::faceworks;  // the profile is that of skin
    writeScene();
    done(ofBall + "-o @p.npy");
    EXPECT_NE(array("p.npy").values, once.values);
}

// The corners of a flat square have normals that lean away from the light.
TEST_F(CliReference, PartsKeepTheNormalsOfTheirFile) {
    scene_.materials[0].profile = "";
    writeScene();
    write("leaning.obj",
          "v 0 0 0\nv 0 9 0\nv 0 9 9\nv 0 0 9\nvn .6 .8 0\ng one\nf 1//1 2//1 3//1 4//1\ng two\nf 4 3 2\n");
    for (const char* part : {"", "--part one ", "--part 1=one --part 2=two "}) {
        done("reference @leaning.obj --scene @s.toml -o @v.npy " + std::string(part));
        const auto light = array("v.npy").values;
        for (size_t i = 0; i < 12; ++i) EXPECT_NEAR(light[i], 0.6, 1e-5) << part;
    }
}

// How much comes back: tests/sample/test_walk.cpp.
TEST_F(CliReference, SkinIsWalkedInItsLayers) {
    write("cheek.toml",
          "name = \"cheek\"\nkind = \"skin\"\nsource = \"test\"\nmelanin = 0.03\nepidermis = 0.1\n");
    const std::string walk =
        ofBall + picture + "--walk --unit-mm 10 --profile @cheek.toml --samples 4 -o @w.exr ";
    const auto medium = reportOf(walk)["media"][0];
    EXPECT_NEAR(medium["epidermis"].get<double>(), 0.01, 1e-6) << "cm";
    refused(walk + "--reflectance 0.5 0.5 0.5", 3, "follows from its pigments");
    scene_.channels[PEL_SLOT_SKIN] = {"Melanin.V", "Blood.V"};
    writeScene();
    refused(walk + "--strict", 3, "maps of pigments are left out");
}

TEST_F(CliReference, WalkOfTheVerticesAndBodies) {
    std::string obj;  // two tetrahedra beside each other
    for (const char* corner : {"0 0 0", "0 5 0", "0 0 5", "3 1 1", "9 0 0", "9 5 0", "9 0 5", "12 1 1"})
        obj += std::string("v ") + corner + "\n";
    write("two.obj",
          obj + "g one\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\ng two\nf 5 7 6\nf 5 6 8\nf 6 7 8\nf 7 5 8\n");
    const std::string two = "reference @two.obj --scene @s.toml -o @v.npy ",
                      walk = two + "--walk --samples 4 --profile @burley.toml ";
    done(walk + "--part 1=one --part 2=two");
    EXPECT_EQ(array("v.npy").shape, (Shape{2, 8, 3}));
    std::filesystem::remove(path("v.npy"));
    refused(walk + "--part one --part two", 2, "ID=GROUP");
    refused(walk + "--part 1=three", 3, "has no part 'three'");
    refused(walk + "--part 7=one", 3, "has the id 1");
    refused(two + "--walk --samples 4 --profile skin", 3, "has no known medium");
    refused(walk + "--reflectance 0.5 1 0.5", 3, "--reflectance");
    done(walk + "--reflectance 0.5 0.95 0.5");
    std::filesystem::remove(path("v.npy"));
    refused(walk + "--reflectance 0.5 0.95 0.5 --boundary fresnel", 3, "values above 0 and below 0.928");
    refused(walk + "--noise 0.1", 2, "--samples");
    refused(two + "--noise 1", 2, "--walk");
}

TEST_F(CliReference, InterruptEndsAWalk) {
    // A shell ignores Ctrl-C for what it runs beside itself, so none is lost before the handler is there.
    const std::string line = PELLUCID_COMMAND " " + ofBall + picture +
                             "--profile @burley.toml --walk --samples 65536 -o @w.exr 2>@err.txt & walk=$!; "
                             "until grep -q 'SigCgt:.*[2367abef]$' /proc/$walk/status; do sleep .05; done; "
                             "sleep .5; kill -INT $walk; wait $walk";
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(std::system(filled(line).c_str()), 0);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30)) << "of many minutes";
    EXPECT_TRUE(contains(read(path("err.txt")), "interrupted"));
    EXPECT_FALSE(std::filesystem::exists(path("w.exr")));
}

TEST_F(CliReference, WrongUseIsRefused) {
    npy("a.npy", {3, 2, 3}, std::vector<float>(18));
    npy("b.npy", {4, 2, 3}, std::vector<float>(24));
    refused(ofBall + "-o @o.exr", 2, "needs --gbuffer");
    refused(ofBall + picture + "-o @o.npy", 2, "goes to an .exr");
    refused("reference @none.off --scene @s.toml -o @o.npy", 3, "none.off");
    refused(ofBall + "-o @o.npy --part skin", 3, "has no parts");
    refused(ofBall + "-o @o.npy --profile nobody", 3, "nobody");
    refused(ofBall + "-o @o.jpg", 2, "o.jpg");
    for (const char* surface : {"--cut 1 1 1", "--finest 1", "--coarsest 1", "--tolerance 0.1"})
        refused(ofBall + picture + "-o @o.exr --walk " + surface, 2, "excludes --walk");
    refused(ofBall + picture + "-o @o.exr --cut 1 -1 1", 2, "--cut");
    refused("compare @a.npy @b.npy", 3, "only pictures of the same size");
    refused("compare @a.npy @none.npy", 3, "none.npy");
    refused("compare @a.npy @a.npy --second-half @none.npy", 3, "none.npy");
    refused("compare @a.npy @a.npy --gbuffer @g.exr", 2, "go together");
    refused("compare @a.npy @a.npy --gbuffer @g.exr --scene @s.toml", 3,
            "the pictures are 2 wide and 3 high");
    for (const bool asWide : {false, true}) {  // one of two sides is the G-buffer's
        const size_t side = gbuffer_.width, high = asWide ? 2 : side, wide = asWide ? side : 2;
        npy("c.npy", {high, wide, 3}, std::vector<float>(3 * high * wide));
        refused("compare @c.npy @c.npy --gbuffer @g.exr --scene @s.toml", 3, "the pictures are");
    }
    refused("compare @a.npy @a.npy --picture @d.jpg", 2, "d.jpg");
}

TEST_F(CliReference, Compare) {
    io::Image a;
    a.width = a.height = side;
    std::vector<float> values(3 * side * side, 0.5f);
    a.addInterleaved(colorNames, values);
    io::writeExr(path("a.exr"), a);
    for (float& v : a.channels[1].pixels) v += 0.1f;
    io::writeExr(path("b.exr"), a);
    const std::string compare = "compare @b.exr @a.exr --gbuffer @g.exr --scene @s.toml";
    const auto report = reportOf(compare + " --picture @d.png");
    EXPECT_EQ(report["a"], path("b.exr"));
    EXPECT_EQ(report["b"], path("a.exr"));
    EXPECT_EQ(report["width"], side);
    EXPECT_NEAR(report["all"]["rmse"][1].get<double>(), 0.1, 1e-6);
    EXPECT_EQ(report["all"]["rmse"][0].get<double>(), 0);
    const auto covered = size_t(std::ranges::count(given("Id.X"), 1.0f));
    EXPECT_EQ(report["all"]["pixels"].get<size_t>(), covered);
    EXPECT_GT(report["subsets"]["unlit"]["pixels"].get<size_t>(), covered / 3);
    EXPECT_GT(report["subsets"]["rest"]["pixels"].get<size_t>(), covered / 4);
    const auto penumbra = report["subsets"]["penumbra"];
    EXPECT_EQ(penumbra["pixels"].get<size_t>(), 0u) << "no image says where shadows are";
    for (const char* key : {"rmse_all", "psnr", "delta_e_mean", "delta_e_p99", "delta_e_max"})
        EXPECT_TRUE(penumbra[key].is_null()) << key;
    for (const char* key : {"rmse", "mean", "p99", "max"}) EXPECT_TRUE(penumbra[key][2].is_null()) << key;
    EXPECT_TRUE(contains(done(compare).out, "penumbra           0 pixels   empty"));
    EXPECT_TRUE(contains(done(compare).err, "without ambient light, or of the light's wide_shadow"));
    EXPECT_FALSE(report["all"].contains("flip")) << "the background does not count";
    EXPECT_NEAR(reportOf("compare @b.exr @a.exr")["all"]["flip"].get<double>(),
                io::flip(values, a.interleaved(colorNames), side), 1e-6);
    expectKept("d.png", "compare.png", "0.0003");
    // In other formats; exit codes.
    npy("a.npy", {side, side, 3}, values);
    values[7] = std::nanf("");
    npy("one.npy", {side, side, 3}, values);
    npy("nan.npy", {side, side, 3}, std::vector<float>(values.size(), std::nanf("")));
    for (const auto& [arguments, message] :
         {std::pair{"@a.npy @a.exr --max-rmse 0", ""},
          {"@b.exr @a.npy --max-rmse 0.06", ""},
          {"@b.exr @a.npy --second-half @b.exr --max-rmse 0", ""},  // (b - a)(b - b): all is noise
          {"@b.exr @a.npy --max-rmse 0.05", "more than --max-rmse 0.05"},
          {"@a.exr @a.npy --scale-b 1.5 --max-rmse 0.24", "more than --max-rmse 0.24"},
          {"@one.npy @a.exr --max-rmse 1", "1 pixels with NaN"},
          {"@one.npy @a.exr --max-rmse 1", "--max-rmse allows no pixel with NaN"},
          {"@nan.npy @a.exr --max-rmse 1", "no pixel could be compared"}}) {
        const Result result = cli(std::string("compare ") + arguments);
        EXPECT_EQ(result.exitCode, *message ? 1 : 0) << arguments;
        EXPECT_TRUE(contains(result.err, message)) << arguments;
    }
}

TEST_F(CliReference, CompareValuesAtVertices) {
    std::vector<float> values(15, 0.5f), halves(30, 0.5f);
    npy("a.npy", {5, 3}, values);
    for (size_t i = 0; i < 15; ++i)
        values[i] += i % 3 == 0 ? 0.1f : 0.0f, halves[i] -= 0.1f, halves[15 + i] += 0.1f;
    npy("b.npy", {5, 3}, values);
    npy("walk.npy", {2, 5, 3}, halves);
    const auto all = reportOf("compare @b.npy @a.npy")["all"];
    EXPECT_EQ(all["pixels"], 5);
    EXPECT_NEAR(all["rmse"][0].get<double>(), 0.1, 1e-6);
    EXPECT_EQ(all["rmse"][1].get<double>(), 0);
    EXPECT_FALSE(all.contains("flip"));
    EXPECT_NEAR(reportOf("compare @a.npy @walk.npy")["all"]["noise"][0].get<double>(), 0.1, 1e-6);
    EXPECT_NEAR(reportOf("compare @walk.npy @a.npy")["all"]["rmse"][0].get<double>(), 0, 1e-6);
    refused("compare @a.npy @b.npy --picture @d.png", 2, "values at vertices");
}

// The picture's third part shows the largest difference of a pixel, whichever channel has it.
TEST_F(CliReference, ComparePaintsTheLargestChannel) {
    constexpr uint32_t size = 30;
    npy("grey.npy", {size, size, 3}, std::vector<float>(3 * size * size, 0.5f));
    std::set<std::vector<float>> colors;
    for (size_t c = 0; c < 3; ++c) {
        std::vector<float> values(3 * size * size, 0.5f);
        for (size_t i = 0; i < size * size / 2; ++i) values[3 * i + c] += 0.1f;
        npy("other.npy", {size, size, 3}, values);
        done("compare @grey.npy @other.npy --picture @d.png");
        const io::Image sheet = image("d.png");
        std::vector<float> column;
        for (size_t y = 0; y < size_t(sheet.height); ++y)
            for (const auto& channel : sheet.channels)
                column.push_back(channel.pixels[y * size_t(sheet.width) + size_t(sheet.width) * 7 / 10]);
        EXPECT_GT(std::set(column.begin(), column.end()).size(), 3u);
        colors.insert(column);
    }
    EXPECT_EQ(colors.size(), 1u);
}
