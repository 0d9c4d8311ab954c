// `pellucid reference` and `pellucid compare` as their users run them: a ball whose reference has a closed
// form.
#include <chrono>
#include <cmath>
#include <numbers>

#include "cli_run.h"
#include "io/image/image_file.h"
#include "io/image/npy_read.h"
#include "io/scene/scene_file.h"
#include "reference/random_walk.h"
#include "reference/surface_integral.h"
#include "sample/mesh.h"
#include "test_size.h"
#include "tolerances.h"

namespace {

using pellucid::io::Image;

constexpr char burley[] =
    "name = \"burley\"\nsource = \"test\"\nkind = \"burley\"\nunit = \"mm\"\ndistance = [1, 0.5, 0.25]\n";

class CliReference : public CommandTest {
  protected:
    static constexpr int side = 16;
    static constexpr double radius = 10;

    void SetUp() override {
        CommandTest::SetUp();
        const int rings = sized(120, 12);
        const auto ball = pellucid::sample::makeSphere(radius, rings, 2 * rings);
        std::string off = "OFF\n" + std::to_string(ball.positions.size() / 3) + " " +
                          std::to_string(ball.triangles.size() / 3) + " 0\n";
        for (size_t i = 0; i < ball.positions.size(); i += 3)
            off += std::to_string(ball.positions[i]) + " " + std::to_string(ball.positions[i + 1]) + " " +
                   std::to_string(ball.positions[i + 2]) + "\n";
        for (size_t i = 0; i < ball.triangles.size(); i += 3)
            off += "3 " + std::to_string(ball.triangles[i]) + " " + std::to_string(ball.triangles[i + 1]) +
                   " " + std::to_string(ball.triangles[i + 2]) + "\n";
        write("ball.off", off);
        // Seen from +z, in parallel; lit from +x.
        Image g;
        g.width = g.height = side;
        std::vector<float> positions, ids;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const double u = 2 * (x + 0.5) / side - 1, v = 1 - 2 * (y + 0.5) / side, r2 = u * u + v * v;
                const bool inside = r2 < 0.95;
                ids.push_back(inside);
                for (double p : {u, v, std::sqrt(std::max(0.0, 1 - r2))})
                    positions.push_back(inside ? float(radius * p) : 0);
            }
        g.addInterleaved(std::vector<std::string>{"P.X", "P.Y", "P.Z"}, positions);
        std::vector<float> normals;
        for (float p : positions) normals.push_back(p / float(radius));
        g.addInterleaved(std::vector<std::string>{"N.X", "N.Y", "N.Z"}, normals);
        g.addInterleaved(std::vector<std::string>{"Id.X"}, ids);
        pellucid::io::writeExr(path("g.exr"), g);
        gbuffer_ = g;
        pellucid::io::SceneFile scene;
        scene.channels[PEL_SLOT_POSITION] = {"P.X", "P.Y", "P.Z"};
        scene.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
        scene.channels[PEL_SLOT_MATERIAL] = {"Id.X"};
        scene.materials.resize(1);
        scene.lights.resize(1);
        const float toLight[3] = {1, 0, 0};
        std::copy(toLight, toLight + 3, scene.lights[0].light.toLight);
        pellucid::io::writeScene(path("s.toml"), scene);
    }
    std::vector<std::string> reference(const std::string& out, bool picture = true) const {
        std::vector<std::string> command{"reference", path("ball.off"), "--scene", path("s.toml"),
                                         "-o",        path(out),        "--json",  "--finest",
                                         "0.3",       "--coarsest",     "1"};
        if (picture) command.insert(command.end(), {"--gbuffer", path("g.exr")});
        return command;
    }
    Image gbuffer_;
};

}  // namespace

TEST_F(CliReference, BallEqualsTheClosedForm) {
    const Result result = run(reference("o.exr"));
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto report = result.json();
    expectReport(report);
    EXPECT_LT(report["points_off_mesh"].get<double>(), testsAreSmall() ? 1 : 0.01);
    const Image out = pellucid::io::readImage(path("o.exr"));
    const auto truth = reference::skinProfile();
    double square = 0;
    int count = 0;
    for (size_t i = 0; i < out.pixelCount(); ++i) {
        if (gbuffer_.channel("Id.X").pixels[i] == 0) {
            EXPECT_EQ(out.channel("R").pixels[i], 0) << "background";
            continue;
        }
        const double cosine = gbuffer_.channel("P.X").pixels[i] / radius;
        const reference::Rgb S = reference::surfaceIntegralOfSphere(*truth, radius, std::acos(cosine));
        EXPECT_NEAR(out.channel("Irradiance.R").pixels[i], std::max(0.0, cosine),
                    testsAreSmall() ? 0.1 : tolerance::litFacets);
        for (int c = 0; c < 3; ++c) {
            const std::string name(1, "RGB"[c]);
            const double e = out.channel("Surface." + name).pixels[i] - S[c];
            square += e * e, ++count;
            EXPECT_NEAR(out.channel(name).pixels[i], 0.5 * out.channel("Surface." + name).pixels[i], 1e-6)
                << "the material's albedo";
        }
    }
    EXPECT_LT(std::sqrt(square / count), testsAreSmall() ? 0.1 : tolerance::referenceRms);
}

TEST_F(CliReference, VerticesAndUnit) {
    ASSERT_EQ(run(reference("v.npy", false)).exitCode, 0);
    const auto values = pellucid::io::readNpy(path("v.npy"));
    ASSERT_EQ(values.shape.size(), 2u);
    EXPECT_EQ(values.shape[1], 3u);
    // A ball of 10 cm hardly scatters.
    auto command = reference("o.exr");
    command.insert(command.end(), {"--unit-mm", "10"});
    ASSERT_EQ(run(command).exitCode, 0);
    const Image wide = pellucid::io::readImage(path("o.exr"));
    for (size_t i = 0; i < wide.pixelCount(); ++i) {
        if (gbuffer_.channel("P.X").pixels[i] < 2) continue;
        EXPECT_NEAR(wide.channel("Surface.B").pixels[i], wide.channel("Irradiance.B").pixels[i],
                    testsAreSmall() ? 0.1 : 0.02);
    }
}

TEST_F(CliReference, TheMaterialsProfileUnlessAnotherIsNamed) {
    auto scene = pellucid::io::readScene(path("s.toml"));
    scene.materials[0].profile = "marble";
    pellucid::io::writeScene(path("marble.toml"), scene);
    const auto values = [&](const std::string& file, const std::vector<std::string>& more) {
        std::vector<std::string> command{"reference",   path("ball.off"), "--scene", path(file),   "-o",
                                         path("v.npy"), "--finest",       "0.5",     "--coarsest", "2"};
        command.insert(command.end(), more.begin(), more.end());
        const Result result = run(command);
        EXPECT_EQ(result.exitCode, 0) << result.err;
        return read(path("v.npy"));
    };
    EXPECT_TRUE(values("marble.toml", {}) == values("s.toml", {"--profile", "marble"}));
}

TEST_F(CliReference, WalkWritesHalvesForCompare) {
    write("burley.toml", burley);
    std::vector<std::string> command{"reference",
                                     path("ball.off"),
                                     "--scene",
                                     path("s.toml"),
                                     "--gbuffer",
                                     path("g.exr"),
                                     "--walk",
                                     "--profile",
                                     path("burley.toml"),
                                     "--reflectance",
                                     "0.8",
                                     "0.8",
                                     "0.8",
                                     "--samples",
                                     "24",
                                     "--json",
                                     "-o",
                                     path("w.exr")};
    const Result result = run(command, "OMP_NUM_THREADS=3");
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto medium = result.json()["media"][0];
    EXPECT_NEAR(medium["mean_free_path"][1].get<double>(), 1.087 * 0.5, 0.01);
    EXPECT_NEAR(medium["single_scattering_albedo"][2].get<double>(), 0.99055, 1e-4);
    const Image out = pellucid::io::readImage(path("w.exr"));
    const reference::WalkResult walked =
        reference::walkBall({1.087, 0.99055}, radius, 20, sized(100000, 2000), 3);
    double square = 0, difference = 0;
    int count = 0;
    for (size_t i = 0; i < out.pixelCount(); ++i) {
        const float first = out.channel("First.R").pixels[i], second = out.channel("Second.R").pixels[i];
        EXPECT_NEAR(out.channel("R").pixels[i], (first + second) / 2, 1e-5);
        EXPECT_NEAR(out.channel("R").pixels[i], 0.5 * out.channel("Surface.R").pixels[i], 1e-5) << "albedo";
        if (gbuffer_.channel("Id.X").pixels[i] == 0) continue;
        const double cosine = gbuffer_.channel("P.X").pixels[i] / radius;
        const double expected = 0.5 / 0.8 * walked.radiance[size_t(std::min(19.0, 10 * (cosine + 1)))];
        square += (first - expected) * (second - expected), difference += std::pow(first - second, 2),
            ++count;
        EXPECT_NEAR(out.channel("MeanCurvature").pixels[i], 1 / radius, testsAreSmall() ? 0.05 : 0.002);
        EXPECT_NEAR(out.channel("Thickness").pixels[i], 2 * radius, testsAreSmall() ? 1 : 0.1);
    }
    EXPECT_LT(square / count, testsAreSmall() ? 0.1 : 2e-3) << "within the bins of 0.1";
    EXPECT_GT(difference / count, 1e-5) << "halves are independent";
    command.back() = path("again.exr");
    ASSERT_EQ(run(command, "OMP_NUM_THREADS=1").exitCode, 0);
    EXPECT_TRUE(read(path("w.exr")) == read(path("again.exr"))) << "one thread and three";
    // A medium of almost no reach is thick and flat everywhere.
    const auto report = run({"compare", path("w.exr"), path("w.exr"), "--gbuffer", path("g.exr"), "--scene",
                             path("s.toml"), "--json"})
                            .json();
    EXPECT_EQ(report["subsets"]["hollows"]["pixels"].get<size_t>(), 0u);
    EXPECT_EQ(report["subsets"]["thin"]["pixels"].get<size_t>(), 0u);
    EXPECT_GT(report["all"]["noise"][0].get<double>(), 0);
}

TEST_F(CliReference, WalkOfTheVerticesAndBodies) {
    write("burley.toml", burley);
    const char* faces[] = {"f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "f 5 7 6\nf 5 6 8\nf 6 7 8\nf 7 5 8\n"};
    // Two tetrahedra beside each other.
    std::string obj;
    for (const char* corner : {"0 0 0", "0 5 0", "0 0 5", "3 1 1", "9 0 0", "9 5 0", "9 0 5", "12 1 1"})
        obj += std::string("v ") + corner + "\n";
    write("two.obj", obj + "g one\n" + faces[0] + "g two\n" + faces[1]);
    const auto walked = [&](const std::vector<std::string>& more,
                            const std::string& profile = "burley.toml") {
        std::vector<std::string> command{"reference",
                                         path("two.obj"),
                                         "--scene",
                                         path("s.toml"),
                                         "--walk",
                                         "--profile",
                                         profile == "skin" ? profile : path(profile),
                                         "-o",
                                         path("v.npy"),
                                         "--samples",
                                         "4"};
        command.insert(command.end(), more.begin(), more.end());
        return command;
    };
    ASSERT_EQ(run(walked({"--part", "1=one", "--part", "2=two"})).exitCode, 0);
    const auto values = pellucid::io::readNpy(path("v.npy"));
    EXPECT_EQ(values.shape, (std::vector<size_t>{2, 8, 3}));
    std::filesystem::remove(path("v.npy"));
    expectRefused(walked({"--part", "one", "--part", "two"}), 2, "ID=GROUP");
    expectRefused(walked({"--part", "1=three"}), 3, "has no part 'three'");
    expectRefused(walked({"--part", "7=one"}), 3, "has the id 1");
    expectRefused(walked({}, "skin"), 3, "has no known medium");
    expectRefused(walked({"--reflectance", "0.5", "1", "0.5"}), 3, "--reflectance");
    expectRefused(walked({"--noise", "0.1"}), 2, "--samples");
    expectRefused(
        {"reference", path("two.obj"), "--scene", path("s.toml"), "-o", path("v.npy"), "--noise", "1"}, 2,
        "--walk");
}

TEST_F(CliReference, InterruptEndsAWalk) {
    write("burley.toml", burley);
    const std::string line = std::string("timeout -s INT 2 ") + PELLUCID_COMMAND + " reference " +
                             path("ball.off") + " --scene " + path("s.toml") + " --gbuffer " + path("g.exr") +
                             " --profile " + path("burley.toml") + " --walk --samples 65536 -o " +
                             path("w.exr") + " 2>" + path("err.txt");
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(std::system(line.c_str()), 0);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30)) << "of many minutes";
    EXPECT_TRUE(contains(read(path("err.txt")), "interrupted"));
    EXPECT_FALSE(std::filesystem::exists(path("w.exr")));
}

TEST_F(CliReference, WrongUseIsRefused) {
    expectRefused({"reference", path("ball.off"), "--scene", path("s.toml"), "-o", path("o.exr")}, 2,
                  "needs --gbuffer");
    expectRefused({"reference", path("ball.off"), "--scene", path("s.toml"), "--gbuffer", path("g.exr"), "-o",
                   path("o.npy")},
                  2, "goes to an .exr");
    expectRefused({"reference", path("none.off"), "--scene", path("s.toml"), "-o", path("o.npy")}, 3,
                  "none.off");
    expectRefused(
        {"reference", path("ball.off"), "--scene", path("s.toml"), "-o", path("o.npy"), "--part", "skin"}, 3,
        "has no parts");
    expectRefused({"reference", path("ball.off"), "--scene", path("s.toml"), "-o", path("o.npy"), "--profile",
                   "nobody"},
                  3, "nobody");
    expectRefused({"reference", path("ball.off"), "--scene", path("s.toml"), "-o", path("o.jpg")}, 2,
                  "o.jpg");
}

TEST_F(CliReference, Compare) {
    Image a;
    a.width = a.height = side;
    std::vector<float> values(3 * side * side, 0.5f);
    a.addInterleaved(std::vector<std::string>{"R", "G", "B"}, values);
    pellucid::io::writeExr(path("a.exr"), a);
    for (float& v : a.channels[1].pixels) v += 0.1f;
    pellucid::io::writeExr(path("b.exr"), a);
    Result result = run({"compare", path("b.exr"), path("a.exr"), "--json", "--gbuffer", path("g.exr"),
                         "--scene", path("s.toml"), "--picture", path("d.png")});
    ASSERT_EQ(result.exitCode, 0) << result.err;
    const auto report = result.json();
    EXPECT_NEAR(report["all"]["rmse"][1].get<double>(), 0.1, 1e-6);
    EXPECT_EQ(report["all"]["rmse"][0].get<double>(), 0);
    size_t covered = 0;
    for (float id : gbuffer_.channel("Id.X").pixels) covered += id > 0;
    EXPECT_EQ(report["all"]["pixels"].get<size_t>(), covered);
    EXPECT_GT(report["subsets"]["unlit"]["pixels"].get<size_t>(), covered / 3);
    EXPECT_GT(report["subsets"]["rest"]["pixels"].get<size_t>(), covered / 4);
    const auto penumbra = report["subsets"]["penumbra"];
    EXPECT_EQ(penumbra["pixels"].get<size_t>(), 0u) << "no image says where shadows are";
    for (const char* key : {"rmse_all", "psnr", "delta_e_mean", "delta_e_p99", "delta_e_max"})
        EXPECT_TRUE(penumbra[key].is_null()) << key;
    for (const char* key : {"rmse", "mean", "p99", "max"}) EXPECT_TRUE(penumbra[key][2].is_null()) << key;
    result =
        run({"compare", path("b.exr"), path("a.exr"), "--gbuffer", path("g.exr"), "--scene", path("s.toml")});
    EXPECT_TRUE(contains(result.out, "penumbra           0 pixels   empty")) << result.out;
    const Image picture = pellucid::io::readImage(path("d.png"));
    EXPECT_GT(picture.width, 3 * side);
    // In other formats; as far apart as before; exit codes.
    const size_t shape[] = {side, side, 3};
    pellucid::io::writeNpy(path("a.npy"), shape, values);
    EXPECT_EQ(run({"compare", path("a.npy"), path("a.exr"), "--max-rmse", "0"}).exitCode, 0);
    EXPECT_EQ(run({"compare", path("b.exr"), path("a.npy"), "--max-rmse", "0.06"}).exitCode, 0);
    result = run({"compare", path("b.exr"), path("a.npy"), "--max-rmse", "0.05"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_TRUE(contains(result.err, "more than --max-rmse 0.05"));
    EXPECT_EQ(
        run({"compare", path("a.exr"), path("a.npy"), "--scale-b", "1.5", "--max-rmse", "0.24"}).exitCode, 1);
    values[7] = std::nanf("");
    pellucid::io::writeNpy(path("n.npy"), shape, values);
    result = run({"compare", path("n.npy"), path("a.exr"), "--max-rmse", "1"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_TRUE(contains(result.err, "1 pixels with NaN"));
    values.assign(values.size(), std::nanf(""));
    pellucid::io::writeNpy(path("n.npy"), shape, values);
    result = run({"compare", path("n.npy"), path("a.exr"), "--max-rmse", "1"});
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_TRUE(contains(result.err, "no pixel could be compared"));
}

TEST_F(CliReference, CompareTakesNoiseOutOfTheError) {
    const size_t shape[] = {1, 2, 3};
    pellucid::io::writeNpy(path("v.npy"), shape, std::vector<float>(6, 0.5f));
    const std::vector<float> first{0.6f, 0.6f, 0.6f, 0.5f, 0.5f, 0.5f},
        second{0.4f, 0.6f, 0.7f, 0.5f, 0.5f, 0.5f};
    pellucid::io::writeNpy(path("first.npy"), shape, first);
    pellucid::io::writeNpy(path("second.npy"), shape, second);
    Image halves;
    halves.width = 2, halves.height = 1;
    halves.addInterleaved(std::vector<std::string>{"R", "G", "B"}, std::vector<float>(6, 9.0f));
    halves.addInterleaved(std::vector<std::string>{"First.R", "First.G", "First.B"}, first);
    halves.addInterleaved(std::vector<std::string>{"Second.R", "Second.G", "Second.B"}, second);
    pellucid::io::writeExr(path("halves.exr"), halves);
    const auto expectError = [&](const std::vector<std::string>& arguments) {
        const auto all = run(arguments).json()["all"];
        EXPECT_NEAR(all["rmse"][0].get<double>(), 0, 1e-6) << "(0.5 - 0.6)(0.5 - 0.4) < 0";
        EXPECT_NEAR(all["rmse"][1].get<double>(), std::sqrt(0.1 * 0.1 / 2), 1e-6);
        EXPECT_NEAR(all["rmse"][2].get<double>(), std::sqrt(0.1 * 0.2 / 2), 1e-6);
        EXPECT_NEAR(all["noise"][0].get<double>(), std::sqrt(0.1 * 0.1 / 2), 1e-6);
        EXPECT_NEAR(all["mean"][2].get<double>(), -0.15 / 2, 1e-6);
    };
    expectError({"compare", path("v.npy"), path("first.npy"), "--second-half", path("second.npy"), "--json"});
    expectError({"compare", path("v.npy"), path("halves.exr"), "--json"});
    expectRefused({"compare", path("v.npy"), path("first.npy"), "--second-half", path("none.npy")}, 3,
                  "none.npy");
}

TEST_F(CliReference, CompareRefuses) {
    const size_t shape[] = {2, 2, 3}, other[] = {3, 2, 3};
    pellucid::io::writeNpy(path("a.npy"), shape, std::vector<float>(12));
    pellucid::io::writeNpy(path("b.npy"), other, std::vector<float>(18));
    expectRefused({"compare", path("a.npy"), path("b.npy")}, 3, "only pictures of the same size");
    expectRefused({"compare", path("a.npy"), path("none.npy")}, 3, "none.npy");
    expectRefused({"compare", path("a.npy"), path("a.npy"), "--gbuffer", path("g.exr")}, 2, "go together");
    expectRefused(
        {"compare", path("a.npy"), path("a.npy"), "--gbuffer", path("g.exr"), "--scene", path("s.toml")}, 3,
        "the pictures are 2 wide and 2 high");
    expectRefused({"compare", path("a.npy"), path("a.npy"), "--picture", path("d.jpg")}, 2, "d.jpg");
}
