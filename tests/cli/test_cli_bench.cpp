// `pellucid bench`: a report with times, shares and errors, its page, and verdicts on two reports.

#include "cli_run.h"
#include "measure/power.h"
#include "measure/report.h"
#include "measure/scenes.h"
#include "measure/temporary_folder.h"
#include "variable.h"

using Json = nlohmann::ordered_json;

namespace {

class BenchCommand : public CommandTest {
  protected:
    Json reportIn(const std::string& folder) const { return Json::parse(read(path(folder + "/bench.json"))); }
    Json deviceIn(const std::string& folder) const { return reportIn(folder).at("devices").at(0); }
};

// A report of one device with one operation.
struct Made {
    double median = 10, mad = 0.01, error = 1e-6, copy = 1e10;
    const char* name = "table-arc";
    double flip = NAN;
};
Json report(const Made& made = {}) {
    const Json operation = {{"name", made.name},
                            {"group", "tables"},
                            {"items", 100},
                            {"samples", 9},
                            {"median_ms", made.median},
                            {"mad_ms", made.mad},
                            {"error_max", made.error},
                            {"flip", made.flip},
                            {"flip_noise", 0.01}};
    const Json device = {{"name", "D"},
                         {"platform", "P"},
                         {"copy_bytes_per_second", made.copy},
                         {"operations_per_second", 1e11},
                         {"operations", Json::array({operation})}};
    const Json host = {{"pellucid", "0"}, {"date", ""}, {"cpu", ""}};
    // As it is read from a file: NaN is null.
    return Json::parse(Json{{"host", host}, {"devices", Json::array({device})}}.dump());
}

// Energy counters as Linux has them, in `folder`.
struct Powercap {
    std::filesystem::path folder;
    void set(const std::string& zone, const std::string& name, uint64_t microjoules) const {
        std::filesystem::create_directories(folder / zone);
        std::ofstream(folder / zone / "name") << name << "\n";
        std::ofstream(folder / zone / "max_energy_range_uj") << 1000000000 << "\n";
        count(zone, microjoules);
    }
    void count(const std::string& zone, uint64_t microjoules) const {
        std::ofstream(folder / zone / "new") << microjoules << "\n";
        std::filesystem::rename(folder / zone / "new", folder / zone / "energy_uj");
    }
};

}  // namespace

TEST_F(BenchCommand, EnergyOfProcessorsIsThatOfAllPackages) {
    using pellucid::bench::packageEnergy;
    const Powercap counters{path("cap")};
    EXPECT_FALSE(packageEnergy(path("cap"))) << "no folder";
    counters.set("intel-rapl:2", "psys", 5);
    EXPECT_FALSE(packageEnergy(path("cap"))) << "no package";
    counters.set("intel-rapl:0", "package-0", 100);
    counters.set("intel-rapl:0:0", "core", 0);
    counters.set("intel-rapl-mmio:0", "package-0", 0);
    counters.set("intel-rapl:1", "package-1", 999000000);
    const pellucid::bench::EnergyMeter joules = packageEnergy(path("cap"));
    const double before = joules();
    counters.set("intel-rapl:0", "package-0", 2000100);
    counters.set("intel-rapl:1", "package-1", 500000);  // it began again
    for (const char* zone : {"intel-rapl:0:0", "intel-rapl:2", "intel-rapl-mmio:0"})
        counters.set(zone, "", 700000000);
    EXPECT_NEAR(joules() - before, 2 + 1.5, 1e-9);
    // As where only administrators may read.
    std::filesystem::remove(path("cap") + "/intel-rapl:1/energy_uj");
    EXPECT_TRUE(std::isnan(joules()));
    EXPECT_FALSE(packageEnergy(path("cap")));
}

TEST(BenchPower, OfAnNvidiaGpu) {
    double time = 0;
    const auto now = [&] { return time; };
    const auto watts = [&](const char* mode, const char* bus) {
        ::setenv("NVML_STAND_IN", mode, 1);
        const auto joules = pellucid::bench::nvidiaEnergy(bus, NVML_STAND_IN, now);
        return pellucid::bench::meanWatts(
                   joules, [&] { time += 10; }, now)
            .value_or(0);
    };
    EXPECT_DOUBLE_EQ(watts("energy", "00000000:C1:00.0"), 500);
    EXPECT_DOUBLE_EQ(watts("two", "00000000:C1:00.0"), 500);
    EXPECT_DOUBLE_EQ(watts("energy", ""), 300) << "the only one";
    EXPECT_EQ(watts("two", ""), 0) << "one of two";
    EXPECT_DOUBLE_EQ(watts("power", ""), 70);
    EXPECT_EQ(watts("none", ""), 0);
    EXPECT_FALSE(pellucid::bench::nvidiaEnergy("", "libnvidia-none.so"));
}

TEST(BenchPower, IsThatBetweenTwoStepsOfACounter) {
    double time = 0;
    int reads = 0;
    const auto watts = [&](double step, double run) {
        time = 140, reads = 0;
        const auto joules = [&] { return ++reads, 0.05 * step * std::floor(time / step); };
        return pellucid::bench::meanWatts(
            joules, [&] { time += run; }, [&] { return time; });
    };
    EXPECT_DOUBLE_EQ(watts(150, 10).value(), 50);
    EXPECT_DOUBLE_EQ(watts(5, 1).value(), 50);
    EXPECT_LT(reads, 100) << "reading takes time from short runs";
    EXPECT_FALSE(watts(1e6, 10)) << "it does not move";
    EXPECT_FALSE(watts(150, 5000)) << "there is no second step in time";
    EXPECT_FALSE(pellucid::bench::meanWatts({}, [] { FAIL(); }));
    EXPECT_FALSE(pellucid::bench::meanWatts([] { return double(NAN); }, [] {}));
}

TEST_F(BenchCommand, MeasuresTimeShareAndError) {
    // A folder that somebody else could have made for the process of this number is left alone.
    const auto said = reportOf(
        "bench --quick --limit 600 --only table-sh --only shade-plain --only shade-no --only curvature-edge "
        "--powercap @none -o @out",
        "mkdir -p @tmp/pellucid-bench-$$; TMPDIR=@tmp exec env");
    const auto left = std::filesystem::directory_iterator(path("tmp"));
    EXPECT_EQ(std::distance(begin(left), end(left)), 1);
    expectReport(said);
    EXPECT_EQ(said.at("report"), path("out") + "/bench.json");
    EXPECT_EQ(reportIn("out").at("quick"), true);
    const Json device = deviceIn("out");
    EXPECT_GT(device.at("copy_bytes_per_second").get<double>(), 1e8);
    EXPECT_GT(device.at("operations_per_second").get<double>(), 1e8);
    for (const char* key : {"name", "platform", "version", "driver"}) EXPECT_NE(device.at(key), "");
    // A process with empty caches, and another one with the caches that the first has filled.
    for (const char* key : {"first_use", "warm_start"})
        EXPECT_GT(device.at(key).at("total_ms").get<double>(), 0.0);
    std::string names;
    for (const auto& e : device.at("operations")) {
        const std::string name = e.at("name");
        names += name + " ";
        ASSERT_FALSE(e.contains("failed")) << e;
        const auto number = [&e](const char* key) { return e.at(key).get<double>(); };
        EXPECT_GT(number("median_ms"), 0.0) << name;
        EXPECT_GE(number("samples"), 5) << name;
        EXPECT_FALSE(e.contains("watts")) << "there is no counter";
        if (e.at("group") == "device") continue;
        // Results are right, and shares of the device's limits are at most 1, or unknown.
        EXPECT_LT(number("error_max"), tolerance::shadeSum) << name;
        EXPECT_GE(number("error_max"), number("error_rms")) << name;
        ASSERT_TRUE(e.contains("bandwidth_share")) << name;
        for (const char* key : {"bandwidth_share", "arithmetic_share"})
            if (e.contains(key) && e[key].is_number()) {
                EXPECT_GT(number(key), 0.0) << name;
                EXPECT_LE(number(key), 1.0) << name;
            }
    }
    EXPECT_EQ(
        names,
        "copy arithmetic curvature-edge curvature-edge-smoothed table-shadow shade-plain shade-no-skin ");
    // A report is the same as itself.
    EXPECT_EQ(reportOf("bench compare @out/bench.json @out/bench.json").at("same"), 5);
}

TEST(BenchTemporaryFolder, IsForThisUserAndRemoved) {
    const auto made = [] {
        const pellucid::bench::TemporaryFolder folder("pellucid-test-");
        EXPECT_EQ(std::filesystem::status(folder.path()).permissions(), std::filesystem::perms::owner_all);
        return std::string(folder.path());
    };
    EXPECT_FALSE(std::filesystem::exists(made()));
    const Variable nowhere("TMPDIR", "/none");
    EXPECT_TRUE(contains(messageOf<std::runtime_error>(made), "TMPDIR"));
}

// The scene, its truth, the methods on it, and what follows of them.
TEST_F(BenchCommand, MeasuresMethodsAgainstLight) {
    const Powercap counters{path("cap")};
    counters.set("intel-rapl:0", "package-0", 1);
    {
        const std::jthread takes([&](const std::stop_token& stop) {
            for (uint64_t energy = 1; !stop.stop_requested(); ++energy) {
                counters.count("intel-rapl:0", energy);
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }
        });
        done(
            "bench --quick --limit 600 --only 'ball-4: auto' --only 'ball-4: light' --budget 1e6ms --error "
            "1e-9 --powercap @cap -o @out");
    }
    const Json device = deviceIn("out");
    EXPECT_EQ(device.at("scenes").at(0).at("name"), "ball-4");
    std::map<std::string, double> errors, flips;
    int budgets = 0;
    for (const auto& e : device.at("operations")) {
        if (!e.contains("scene") || e.at("setting") == "error 0.002 of white") {
            EXPECT_GT(e.at("watts").get<double>(), 0) << e;
        }
        if (!e.contains("scene")) continue;
        ASSERT_FALSE(e.contains("failed")) << e;
        EXPECT_GE(e.at("passes").size(), 2u);  // how their times add up depends on what else the machine does
        for (const auto& pass : e.at("passes")) EXPECT_GT(pass.at("ms").get<double>(), 0) << pass;
        if (e.at("bandwidth_share").is_number()) {
            EXPECT_LE(e.at("bandwidth_share").get<double>(), 1);
        }
        if (e.at("group") == "budgets") {
            EXPECT_TRUE(e.at("expected_error").get<double>() > 0 && e.at("front_ratio").get<double>() >= 1);
            ++budgets;
            continue;
        }
        errors[e.at("method")] = e.at("error_rms");
        flips[e.at("method")] = e.at("flip");
        EXPECT_GT(e.at("flip").get<double>(), 1.5 * e.at("flip_noise").get<double>());
        for (const char* key : {"flip_noise", "median_ms", "memory_bytes"}) EXPECT_GT(e.at(key), 0) << key;
        EXPECT_GT(e.at("subsets").at("terminator").at("pixels").get<int>(), 20);
    }
    EXPECT_EQ(budgets, 2);
    EXPECT_EQ(device.at("budgets").at("frames"), 2);
    ASSERT_EQ(errors.size(), 3u) << "Lambert too, for the times beyond it";
    for (const char* method : {"auto", "light"}) {
        EXPECT_LT(errors[method], 0.7 * errors["Lambert"]) << method;
        EXPECT_LT(flips[method], 0.3 * flips["Lambert"]) << method;
    }
    EXPECT_GT(errors["light"], 1e-4) << "not the truth itself";
    const auto& answers = device.at("answers");
    EXPECT_LE(answers.at(0).at("take").at("error").get<double>(),
              std::min(errors["auto"], errors["light"]) + 1e-6);
    EXPECT_FALSE(answers.at(1).contains("take")) << "nothing is so near";
    const std::string page = read(path("out/bench.html"));
    EXPECT_TRUE(contains(page, device.at("name").get<std::string>()));
    EXPECT_FALSE(contains(page, "/*reports*/"));
    EXPECT_FALSE(contains(page, "http://") || contains(page, "https://")) << "it needs nothing else";
    // The record predicts the method's measured time: with one scene, the 90th percentile is that scene.
    done("bench --quick --limit 600 --only 'ball-4: auto, budget' -o @again",
         "PELLUCID_TUNING=" + path("out/tuning.txt"));
    const Json again = deviceIn("again");
    for (const Json& e : again.at("operations"))
        if (e.at("group") == "budgets") {
            EXPECT_NEAR(e.at("expected_error"),
                        errors[e.at("took") == "none" ? "Lambert" : e.at("took").get<std::string>()],
                        e.at("took") == "auto" ? 0.05 * errors["auto"] : 1e-4);
        }
}

TEST_F(BenchCommand, StabilityNeedsNothingButTheCommand) {
    done("bench -o @out --only 'stability: normals' --stability-share 1e-3");
    const Json found = deviceIn("out").at("stability");
    ASSERT_EQ(found.at("operations").size(), 1u);
    const auto& normals = found.at("operations").at(0);
    EXPECT_GT(normals.at("points").get<int>(), 0);
    EXPECT_GT(normals.at("worst").get<double>(), 0);
    EXPECT_LE(normals.at("worst").get<double>(), normals.at("limit").get<double>());
    EXPECT_TRUE(contains(read(path("out/bench.html")), normals.at("where").get<std::string>()));
    refused("bench -o @out --stability-share 0", 2, "stability-share");
}

TEST(BenchReport, FrontAndAnswersFollowFromTheRows) {
    const auto row = [](const char* method, double ms, double error) {
        return Json{{"name", method},    {"group", "methods"}, {"scene", "s"},
                    {"method", method},  {"setting", "x"},     {"items", 1e6},
                    {"added_ms", ms},    {"error_rms", error}, {"rmse", {error, error, error}},
                    {"flip", 2 * error}, {"watts", 10 * ms}};
    };
    Json device = {
        {"scenes", {{{"name", "s"}, {"pixels", 1000}, {"height", 540}}}},
        {"operations", {row("fast", 1, 0.3), row("slow", 5, 0.1), row("bad", 6, 0.2), row("free", -1, 0.5)}}};
    Json budget = row("auto", 2, 0.3);
    budget.update({{"group", "budgets"}, {"budget_ms", 2}});
    device["operations"].push_back(budget);
    device["operations"].push_back({{"name", "s: gone"}, {"group", "methods"}, {"failed", "no result"}});
    pellucid::bench::summarize(device, {0.003, 0.03}, {0.2, 0.01});
    EXPECT_EQ(device["budgets"]["near"], 1) << "beside a method that failed";
    std::map<std::string, bool> front;
    for (const Json& e : device["summary"]) front[e["method"]] = e["pareto"];
    EXPECT_EQ(front,
              (std::map<std::string, bool>{{"fast", true}, {"slow", true}, {"bad", false}, {"free", true}}));
    EXPECT_DOUBLE_EQ(device["summary"][1]["flip"].get<double>(), 0.2);
    // 1 ns for each of 4000 pixels at 1080p.
    EXPECT_DOUBLE_EQ(device["summary"][0]["ms"]["1080p"].get<double>(), 0.004);
    EXPECT_EQ(device["summary"][0]["measured"]["1080p"], false);
    EXPECT_EQ(device["answers"][0]["take"]["method"], "free");
    EXPECT_EQ(device["answers"][1]["take"]["method"], "slow");
    EXPECT_EQ(device["answers"][2]["take"]["method"], "slow");
    EXPECT_FALSE(device["answers"][3].contains("take"));
    // The mean over the scenes of this method, unless one has none, as in older reports.
    for (const bool last : {false, true}) {
        device["operations"].push_back(row("slow", 5, 0.3));
        device["operations"].back()["watts"] = 70;
        device["operations"].back()["scene"] = last ? "u" : "t";
        if (last) device["operations"].back().erase("flip");
        pellucid::bench::summarize(device, {}, {});
        EXPECT_EQ(device["summary"][0].value("flip", 0.0), last ? 0.0 : 0.4);
        EXPECT_EQ(device["summary"][0]["watts"], last ? 70 : 60);
    }
}

TEST_F(BenchCommand, WrongArgumentsAreFoundBeforeAnythingIsMade) {
    for (const std::string words : {"--budget 0ms", "--error -1", "--limit 1e-9", "--stability-share 2"})
        refused("bench --quick -o @out " + words, 2, words.substr(0, words.rfind(' ')));
    refused("bench --quick -o @out --device 99", 4, "99");
}

TEST_F(BenchCommand, EndsWithItsProcessesWhenItIsTerminated) {
    const Result result =
        cli("bench --quick --only table-arc -o @out", "TMPDIR=@ timeout --foreground -s TERM 1");
    EXPECT_EQ(result.exitCode, 124) << result.err;  // of `timeout`
    EXPECT_TRUE(contains(result.err, "cancelled"));
    for (const auto& entry : std::filesystem::directory_iterator(path("")))
        EXPECT_EQ(entry.path().filename(), "out");
}

// A sanitizer's library has to be the first of all.
#ifndef __SANITIZE_ADDRESS__
TEST_F(BenchCommand, ADriverThatHangsOrCrashesCostsOneOperation) {
    struct Row {
        std::string ending, limit, why;
    };
    for (const Row& row : {Row{"hang", "15", "no result within 15"}, {"crash", "100", "ended by signal 6"}}) {
        SCOPED_TRACE(row.ending);
        const std::string said =
            done("bench --quick --only table-shadow --only table-specular -o @out --limit " + row.limit,
                 "LD_PRELOAD='" BAD_DRIVER "' BAD_KERNEL=shadow_texels BAD_ENDING=" + row.ending)
                .out;
        EXPECT_EQ(reportIn("out").at("limit_s").get<double>(), std::stod(row.limit));
        std::string names;
        const Json device = deviceIn("out");
        for (const Json& e : device.at("operations")) {
            const std::string name = e.at("name");
            names += name + " ";
            ASSERT_EQ(e.contains("failed"), name == "table-shadow") << e;
            if (name == "table-shadow") {
                EXPECT_TRUE(contains(e["failed"], row.why));
                EXPECT_EQ(e.at("group"), "tables");
            } else {
                EXPECT_GE(e.at("samples").get<int>(), 1) << name;
            }
        }
        EXPECT_EQ(names, "copy arithmetic table-specular table-shadow ");
        EXPECT_TRUE(contains(said, row.why));
    }
}
#endif

// Of the parts that a report shows: an ear that glows, where it lies in the picture.
TEST_F(BenchCommand, ShownPartsHaveTheirLight) {
    using namespace pellucid::bench;
    const ShownPart& part = shownParts[1];
    const FrozenScene& ear = frozenScenes()[1];
    ASSERT_EQ(std::string(ear.name) + "-4", part.scene);
    const pellucid::Device device("");
    const lit_scenes::Stage stage(device, ear.body(PELLUCID_SOURCE_DIR "/data/heads/head_female.obj"), 1);
    lit_scenes::SceneRequest request = ear.request;
    request.profileScale = 4;
    const lit_scenes::LitScene s = stage.look(request, usualProfile());
    const std::vector<float> light = readPart(PELLUCID_SOURCE_DIR "/data/bench", part, s),
                             shaded = lit_scenes::shade(device, s, usualProfile(), 4, {.gain = 1});
    double sum = 0, off = 0;
    const std::vector<size_t> pixels = part.pixels(s);
    ASSERT_EQ(light.size(), 3 * pixels.size());
    for (size_t i = 0; i < pixels.size(); ++i)
        if (s.covered[pixels[i]] && s.irradiance[3 * pixels[i]] == 0) {  // of light that came through
            sum += light[3 * i];
            off += std::abs(light[3 * i] - sceneAlbedo * shaded[3 * pixels[i]]);
        }
    EXPECT_LT(off, 0.4 * sum);  // 0.29 measured, most of it the noise of the walk
}

// A scene in which `light` has all its parts to do.
TEST_F(BenchCommand, KeptPicturesAreThoseOfTheseKernels) {
    const std::string said =
        cli("bench --events first --limit 600 --only 'side-4: light'", "PELLUCID_MATH_WIDTH=1").out;
    const size_t row = said.find("{\"row\":");
    ASSERT_NE(row, said.npos) << said;
    EXPECT_LT(Json::parse(said.substr(row, said.find('\n', row) - row)).at("row").at("error_rms"), 1e-6);
}

#ifndef __SANITIZE_ADDRESS__
// PoCL's compiler refuses the option, and the message names all of them.
TEST_F(BenchCommand, LimitsTheRegistersOfNvidiasCompiler) {
    const std::string build = "lut specular --size 4x4 -o @a.npy", driver = "LD_PRELOAD='" BAD_DRIVER "' ";
    EXPECT_EQ(cli(build, driver + "BAD_EXTENSIONS=cl_khr_icd").exitCode, 0);
    EXPECT_TRUE(contains(cli(build, driver + "BAD_EXTENSIONS=cl_nv_compiler_options").err,
                         "-DPEL_REGISTERS=96 -DPEL_WIDTH="));
    EXPECT_TRUE(contains(cli(build, driver + "BAD_EXTENSIONS=cl_nv_compiler_options").err,
                         " -cl-nv-maxrregcount=96"));
}
#endif

// The kept pictures were made by PoCL with one lane, which this test uses too.
TEST_F(BenchCommand, TheFirstTimeOnAGpuJudgesWhatItMakes) {
    const std::string command =
        "bench --first-gpu --quick --limit 600 -o @out --only table-arc --only 'ball-4: disk' ";
    const auto rows = [&] {
        std::map<std::string, Json> found;
        const Json device = deviceIn("out");
        EXPECT_EQ(device.at("math_width"), 1);
        for (const Json& e : device.at("operations")) found[e.at("name")] = e;
        found["all"] = device.at("first_gpu");
        return found;
    };
    const std::string disk = "ball-4: disk, 32 taps", frame = "270p: disk, 32 taps",
                      more = "--only 'ball-4: auto' --only '270p: disk, 32'";
    EXPECT_TRUE(contains(done(command + more).out, path("out") + "/bench.html"));
    std::map<std::string, Json> of = rows();
    EXPECT_EQ(of["all"], (Json{{"checked", 3}, {"out", Json::array()}}));
    for (const std::string name : {disk.c_str(), "ball-4: auto, error 0.002 of white", "table-arc"})
        EXPECT_EQ(of[name]["within"], true);
    for (const Json& pass : of[frame]["passes"]) {
        EXPECT_GT(pass.at("ms").get<double>(), 0) << pass;
        EXPECT_GT(pass.at("predicted_ms").get<double>(), 0) << pass;
    }
    EXPECT_TRUE(contains(read(path("out/bench.html")), "first_gpu"));
#ifndef __SANITIZE_ADDRESS__
    const std::string bad = "LD_PRELOAD='" BAD_DRIVER "' BAD_KERNEL=scatter_disk BAD_ENDING=";
    const Result skips = cli(command, bad + "skip");
    EXPECT_EQ(skips.exitCode, 1);
    EXPECT_TRUE(contains(skips.err, "out of tolerance, or not done:\n  " + disk)) << skips.err;
    of = rows();
    EXPECT_EQ(of[disk]["within"], false);
    EXPECT_EQ(of["table-arc"]["within"], true);
    EXPECT_EQ(cli(command, bad + "crash").exitCode, 1);
    of = rows();
    EXPECT_EQ(of["all"]["out"], Json::array({disk}));
    EXPECT_TRUE(contains(of[disk]["failed"].get<std::string>(), "ended by signal 6"));
    EXPECT_EQ(of["table-arc"]["within"], true);
#endif
    refused("bench --first-gpu --stability -o @none", 2, "leave --stability out");
    refused("bench --first-gpus -o @none", 2, "--first-gpu");
}

TEST_F(BenchCommand, TuneKeepsWhatIsFasterAndShowsWhatIsInForce) {
    const auto device = reportOf("devices").at("devices").at(0);
    const auto text = [&](const char* key) { return device.at(key).get<std::string>(); };
    const std::string none = "PELLUCID_TUNING= PELLUCID_CACHE_DIR='" + path("cache") + "'",
                      named = "PELLUCID_TUNING='" + path("own.txt") + "'",
                      own =
                          "pellucid tuning 1\ndevice " + text("name") + ", " + text("platform") + "\nlaunch ";
    const std::string made = " " + done("--version").out;
    write("own.txt", own + "4 64 128 32" + made.substr(0, made.size() - 1) + " " + text("driver") + "\n");
    const auto shown = [&](const std::string& environment) {
        return reportOf("tune --show --device 0", environment);
    };
    const auto builtIn = shown(none);
    EXPECT_EQ(builtIn.at("from"), "built in");
    EXPECT_EQ(shown("PELLUCID_TUNING=off").at("sizes"), builtIn.at("sizes"));
    EXPECT_EQ(shown(named).at("from"), path("own.txt"));
    EXPECT_EQ(shown(named).at("sizes").at("texels"), 32);
    write("own.txt", own);
    EXPECT_EQ(shown(named).at("sizes"), builtIn.at("sizes"));
    EXPECT_TRUE(contains(shown(named).at("warnings").at(0).get<std::string>(), "does not set launch sizes"));
    EXPECT_EQ(cli("tune --show --strict --device 0", named).exitCode, 3);
    EXPECT_TRUE(
        contains(done("lut specular -o @s.npy --size 8x8 --device 0", named).err, "own.txt does not"));
    const auto tuned = reportOf("tune --quick --device 0 -o @tuned.txt");
    EXPECT_EQ(tuned.at("built_in"), builtIn.at("sizes"));
    EXPECT_GE(tuned.at("measured").size(), 8u);
    EXPECT_EQ(std::filesystem::exists(path("tuned.txt")), tuned.at("sizes") != tuned.at("built_in"));
    EXPECT_EQ(shown("PELLUCID_TUNING='" + path("tuned.txt") + "'").at("sizes"), tuned.at("sizes"));
    refused("tune -o @none/tuned.txt", 2, "none/tuned.txt");
    refused("tune --sho", 2, "--show");
    refused("tune --show --quick", 2, "--show excludes --quick");
    refused("tune --show -o @t.txt", 2, "--show excludes --output");
    refused("tune", 2, "name one with -o", "PELLUCID_CACHE_DIR=off");
}

TEST_F(BenchCommand, VerdictsSurviveNoise) {
    const struct {
        const char* what;
        Made before, after;
        const char* verdict;
        int exitCode;
    } rows[] = {
        {"a twentieth is nothing", {}, {.median = 10.4}, "same", 0},
        {"a fifth over a steady clock", {}, {.median = 12}, "slower", 1},
        {"and the other way", {.median = 12}, {}, "faster", 0},
        {"a fifth within the scatter", {.mad = 1}, {.median = 12, .mad = 1}, "same", 0},
        {"twice, beyond the scatter", {.mad = 1}, {.median = 21, .mad = 1}, "slower", 1},
        {"a fifth, but copies slowed down as well", {}, {.median = 12, .copy = 0.8e10}, "same", 0},
        {"a larger error", {}, {.median = 5, .error = 2e-6}, "less accurate", 1},
        {"an error of rounding", {.error = 1e-8}, {.error = 5e-8}, "same", 0},
        {"an error that became NaN", {}, {.error = NAN}, "less accurate", 1},
        {"a visible difference", {.flip = 0.05}, {.flip = 0.065}, "less accurate", 1},
        {"one that the truth's noise hides", {.flip = 0.05}, {.flip = 0.059}, "same", 0},
        {"a twentieth of it", {.flip = 0.4}, {.flip = 0.42}, "same", 0},
        {"a report of before it was measured", {}, {.flip = 0.3}, "same", 0},
        {"no time", {}, {.median = NAN}, "not compared", 0},
        {"another operation", {}, {.name = "table-ring"}, "only new", 0},
    };
    for (const auto& row : rows) {
        const auto result = pellucid::bench::compareReports(report(row.before), report(row.after));
        EXPECT_EQ(result.at("slower").get<int>() + result.at("less_accurate").get<int>(), row.exitCode)
            << row.what;
        EXPECT_EQ(result.at("devices")[0].at("operations")[0].at("verdict"), row.verdict) << row.what;
    }
}

TEST_F(BenchCommand, FailsOnlyWhereItIsAskedTo) {
    Json broken = report();
    Json& only = broken["devices"][0]["operations"][0];
    only = {{"name", only["name"]}, {"group", only["group"]}, {"failed", "out of memory"}};
    write("broken.json", broken.dump());
    write("old.json", report().dump());
    write("slow.json", report({.median = 12}).dump());
    write("bad.json", report({.error = 2e-6}).dump());
    EXPECT_EQ(cli("bench compare @broken.json @broken.json").exitCode, 3) << "it fails as before";
    for (const auto& [more, exitCode, said] : {std::tuple{"@slow.json", 0, "1 slower"},
                                               {"@slow.json --fail-if-slower 10%", 1, ""},
                                               {"@slow.json --fail-if-slower 30%", 0, ""},
                                               {"@bad.json --fail-if-slower 10%", 0, ""},
                                               {"@bad.json --fail-if-less-accurate 50%", 1, ""},
                                               {"@bad.json --fail-if-less-accurate 150%", 0, ""},
                                               {"@broken.json", 0, "1 fail,"},
                                               {"@broken.json --fail-if-slower 10%", 1, ""},
                                               {"@broken.json --fail-if-less-accurate 50%", 1, ""},
                                               {"@old.json @slow.json --fail-if-slower 10%", 1, ""},
                                               {"@slow.json @bad.json -o @all.html", 0, ""}}) {
        const Result result = cli(std::string("bench compare @old.json ") + more);
        EXPECT_EQ(result.exitCode, exitCode) << more;
        EXPECT_TRUE(contains(result.out, said)) << more;
    }
    EXPECT_TRUE(contains(read(path("all.html")), "table-arc"));
    refused("bench compare @old.json", 2, "two or more reports");
    refused("bench compare @old.json @slow.json --fail-if-slower 10", 2, "a number and %");
    refused("bench -o @out --budget 1s", 2, "a number and ms");
    const Result none = cli("bench -o @out --only nosuch");
    EXPECT_EQ(none.exitCode, 2);
    EXPECT_TRUE(contains(none.err, "no operation has that in its name"));
}

// Reports of another size, of another device, of several devices; folders in place of their bench.json.
TEST_F(BenchCommand, ComparesOnlyWhatIsComparable) {
    const auto edited = [](const std::function<void(Json&)>& edit) {
        Json json = report();
        edit(json["devices"]);
        return json;
    };
    const auto& compared = pellucid::bench::compareReports;
    const Json base = edited([](Json&) {});
    // Another extent with the same number of texels, and another number.
    for (const Json& other : {edited([](Json& d) { d[0]["operations"][0]["what"] = "10x10, skin"; }),
                              edited([](Json& d) { d[0]["operations"][0]["items"] = 400; })}) {
        Json worse = other;
        worse["devices"][0]["operations"][0]["error_max"] = 1;
        const Json result = compared(base, worse);
        EXPECT_EQ(result["devices"][0]["operations"][0]["verdict"], "other size");
        EXPECT_EQ(result["other_size"], 1);
        EXPECT_EQ(result["less_accurate"], 0);
        write("a.json", base.dump());
        write("b.json", worse.dump());
        refused("bench compare @a.json @b.json", 3, "all operations have other sizes");
    }
    // A clip has errors alone.
    const auto clip = [&edited](double error) {
        return edited([error](Json& d) {
            d[0]["operations"][0].erase("median_ms");
            d[0]["operations"][0]["error_max"] = error;
        });
    };
    for (const auto& [error, verdict] : {std::pair{1e-3, "same"}, {2e-3, "less accurate"}})
        EXPECT_EQ(compared(clip(1e-3), clip(error))["devices"][0]["operations"][0]["verdict"], verdict);
    // Two devices, one in each report. Their difference in bandwidth does not count as noise.
    const Json other = edited([](Json& d) {
        d[0]["name"] = "E", d[0]["copy_bytes_per_second"] = 4e10;
        d[0]["operations"][0]["median_ms"] = 5;
    });
    Json result = compared(base, other);
    EXPECT_EQ(result["devices"][0]["old_name"], "D");
    EXPECT_EQ(result["devices"][0]["operations"][0]["verdict"], "faster");
    // Equal devices in turn; a device that only one report has.
    const Json twins = edited([](Json& d) { d.push_back(d[0]), d[1]["operations"][0]["median_ms"] = 20; });
    result = compared(twins, twins);
    EXPECT_EQ(result["same"], 2);
    result = compared(twins, base);
    EXPECT_EQ(result["same"], 1);
    EXPECT_EQ(result["devices"][1]["only"], "old");
    std::filesystem::create_directories(path("old"));
    std::filesystem::create_directories(path("new"));
    write("old/bench.json", base.dump());
    write("new/bench.json", other.dump());
    const std::string text = done("bench compare @old @new").out;
    EXPECT_TRUE(contains(text, "E, compared with another device: D"));
    EXPECT_TRUE(contains(text, path("new") + " against " + path("old"))) << text;
}
