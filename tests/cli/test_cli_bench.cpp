// `pellucid bench`: a report with times, shares and errors, its page, and verdicts on two reports.
#include <cmath>

#include "cli_run.h"
#include "measure/report.h"
#include "tolerances.h"

using Json = nlohmann::ordered_json;

namespace {

class BenchCommand : public CommandTest {};

// A report of one device with one operation.
struct Made {
    double median = 10, mad = 0.01, error = 1e-6, copy = 1e10;
    const char* name = "table-arc";
};
Json report(const Made& made = {}) {
    const Json operation = {{"name", made.name},      {"group", "tables"},        {"items", 100},
                            {"samples", 9},           {"median_ms", made.median}, {"mad_ms", made.mad},
                            {"error_max", made.error}};
    const Json device = {{"name", "D"},
                         {"platform", "P"},
                         {"copy_bytes_per_second", made.copy},
                         {"operations_per_second", 1e11},
                         {"operations", Json::array({operation})}};
    const Json host = {{"pellucid", "0"}, {"date", ""}, {"cpu", ""}};
    // As it is read from a file: NaN is null.
    return Json::parse(Json{{"host", host}, {"devices", Json::array({device})}}.dump());
}

}  // namespace

TEST_F(BenchCommand, MeasuresTimeShareAndError) {
    const auto said =
        reportOf("bench --quick --only table-sh --only shade-plain --only curvature-edge -o @out");
    expectReport(said);
    EXPECT_EQ(said.at("report"), path("out") + "/bench.json");
    const auto report = nlohmann::json::parse(read(path("out/bench.json")));
    EXPECT_EQ(report.at("quick"), true);
    const auto& device = report.at("devices").at(0);
    EXPECT_GT(device.at("copy_bytes_per_second").get<double>(), 1e8);
    EXPECT_GT(device.at("operations_per_second").get<double>(), 1e8);
    for (const char* key : {"name", "platform", "version", "driver"}) EXPECT_NE(device.at(key), "");
    // A process that starts from nothing, and again from what that left.
    for (const char* key : {"first_use", "warm_start"})
        EXPECT_GT(device.at(key).at("total_ms").get<double>(), 0.0);
    std::string names;
    const std::string page = read(path("out/bench.html"));
    for (const auto& e : device.at("operations")) {
        const std::string name = e.at("name");
        names += name + " ";
        EXPECT_TRUE(contains(page, "<td>" + name + "</td>"));
        ASSERT_FALSE(e.contains("failed")) << e;
        const auto number = [&e](const char* key) { return e.at(key).get<double>(); };
        EXPECT_GT(number("median_ms"), 0.0) << name;
        EXPECT_GE(number("samples"), 5) << name;
        if (e.at("group") == "device") continue;
        // Right answers, and no faster than the device itself. Small memory may run in a cache, twice as fast
        // and more; arithmetic is above 1 where something else took the processors while the peak was
        // measured.
        EXPECT_LT(number("error_max"), tolerance::shadeSum) << name;
        EXPECT_GE(number("error_max"), number("error_rms")) << name;
        EXPECT_GT(number("bandwidth_share"), 0.0) << name;
        EXPECT_LT(number("bandwidth_share"), 20.0) << name;
        EXPECT_LT(e.value("arithmetic_share", 0.0), 20.0) << name;
    }
    EXPECT_EQ(names, "copy arithmetic curvature-edge curvature-edge-smoothed table-shadow shade-plain ");
    EXPECT_FALSE(contains(page, "frames a second")) << "none of the frames that it speaks of was measured";
    for (const char* outside : {"http:", "https:", "<script", "<link", "<img"})
        EXPECT_FALSE(contains(page, outside)) << outside;
    // A report is the same as itself.
    EXPECT_EQ(reportOf("bench compare @out/bench.json @out/bench.json").at("same"), 4);
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
        const auto report = nlohmann::json::parse(read(path("out/bench.json")));
        EXPECT_EQ(report.at("limit_s").get<double>(), std::stod(row.limit));
        std::string names;
        for (const auto& e : report.at("devices")[0].at("operations")) {
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
        EXPECT_TRUE(contains(read(path("out/bench.html")), row.why));
    }
}
#endif

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
        {"no time", {}, {.median = NAN}, "not compared", 0},
        {"another operation", {}, {.name = "table-ring"}, "only new", 0},
    };
    for (const auto& row : rows) {
        const auto result = pellucid::bench::compareReports(report(row.before), report(row.after));
        EXPECT_EQ(result.at("slower").get<int>() + result.at("less_accurate").get<int>(), row.exitCode)
            << row.what;
        EXPECT_EQ(result.at("devices")[0].at("operations")[0].at("verdict"), row.verdict) << row.what;
    }
    Json broken = report();
    for (auto& e : broken["devices"][0]["operations"])
        e = {{"name", e["name"]}, {"group", e["group"]}, {"failed", "out of memory"}};
    write("broken.json", broken.dump());
    write("old.json", report().dump());
    write("new.json", report({.median = 12}).dump());
    EXPECT_EQ(cli("bench compare @broken.json @broken.json").exitCode, 3) << "it fails as before";
    for (const auto& [name, said] : {std::pair{"broken", "1 fail,"}, {"new", "1 slower"}}) {
        const Result result = cli(std::string("bench compare @old.json @") + name + ".json");
        EXPECT_EQ(result.exitCode, 1);
        EXPECT_TRUE(contains(result.out, said));
    }
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
    // Two devices, one in each report. Their bandwidths differ, which is no noise.
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
    EXPECT_TRUE(contains(done("bench compare @old @new").out, "E, compared with another device: D"));
}

// The page of a report: which device, how many frames a second, at what error, before all else; and no
// mark-up from names.
TEST_F(BenchCommand, ThePageAnswersItsQuestionFirst) {
    Json made = report({.median = 20, .error = 3e-6, .name = "shade-surface"});
    made["devices"][0]["name"] = "<D&'\">";
    made["devices"][0]["operations"][0]["what"] = "64x32, 100 % skin";
    const std::string page = pellucid::bench::htmlPage(made);
    const size_t first = page.find("frames a second");
    ASSERT_NE(first, std::string::npos);
    EXPECT_LT(first, page.find("first use"));
    EXPECT_TRUE(contains(
        page, "<td>&lt;D&amp;&#39;&quot;&gt;</td><td>–</td><td>50.0</td><td>–</td><td>3.00e-06</td>"));
    EXPECT_TRUE(contains(page, "Frames of 64x32 pixels"));
}
