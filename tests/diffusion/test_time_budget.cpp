// PelShaderOptions.timeBudget: the choices of auto by a record of the device, and damaged records.
#include "diffusion/lit_scenes.h"
#include "io/io_files.h"
#include "variable.h"

using namespace lit_scenes;

namespace {

struct Row {
    const char* name;
    PelScattering method;
    double target, perPixel, perFrame, error;
    bool half = false;
};
constexpr Row rows[] = {{"none", PEL_SCATTERING_NONE, 0, 0, 1, 0.05},
                        {"preintegrated", PEL_SCATTERING_PREINTEGRATED, 0, 20, 1, 0.03},
                        {"auto", PEL_SCATTERING_AUTO, 0.02, 60, 2, 0.012},
                        {"auto", PEL_SCATTERING_AUTO, 0.004, 100, 2, 0.010},
                        {"auto", PEL_SCATTERING_AUTO, 0.003, 150, 2, 0.0099},  // no nearer to speak of
                        {"light-half", PEL_SCATTERING_LIGHT, 0, 900, 3, 0.006, true},
                        {"light", PEL_SCATTERING_LIGHT, 0, 4000, 5, 0.004}};

class TimeBudget : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        tuning_.set(record().c_str());
    }
    std::string record() const { return path("record.txt"); }
    void writeRecord(const std::string& device) {
        std::string text = "pellucid tuning 1\r\n\n# for a test\ndevice another, one\nauto 0 0 0 0\n";
        text += "device " + device + "\n";
        for (const Row& r : rows) {
            char line[128];
            std::snprintf(line, sizeof line, "%s %g %g %g %g\n", r.name, r.target, r.perPixel, r.perFrame,
                          r.error);
            text += line;
        }
        write("record.txt", text);
    }
    Shot shot(const LitScene& scene, PelScattering method, float target, float budget = 0,
              bool half = false) {
        ShadeRequest request;
        request.scattering = method, request.targetError = target, request.timeBudget = budget;
        request.halfRate = half;
        return shoot(device(), scene, profile_, 1, request);
    }
    LitScene scene(double ambient = 0) {
        SceneRequest request;
        request.size = 64, request.mapSize = 128, request.ambient = ambient;
        return Stage(device(), ball(10, 60), 1).look(request, profile_);
    }
    const Variable tuning_{"PELLUCID_TUNING"};
    const std::string device_ = std::string(device().info().name) + ", " + device().info().platform;
    const Profile profile_ = Profile::skin();
};

TEST_F(TimeBudget, TakesWhatIsNearestToLightOfWhatFits) {
    writeRecord(device_);
    const LitScene lit = scene();
    const double skin = double(lit.places.size()), frame = double(lit.width) * lit.height;
    ASSERT_GT(skin, 0.2 * frame);
    ASSERT_LT(skin, 0.9 * frame);
    const auto expected = [&](const Row& r, double pixels) {
        return 1e-6 * (r.perPixel * pixels + r.perFrame * frame);
    };
    for (const Row& r : rows) {
        SCOPED_TRACE(r.name + std::to_string(r.target));
        const Row& taken = r.target == 0.003 ? rows[3] : r;
        const Shot by = shot(lit, PEL_SCATTERING_AUTO, 0.003f, float(1.001 * expected(r, skin)));
        EXPECT_NEAR(by.stats.expectedMilliseconds, expected(taken, skin), 1e-9);
        EXPECT_EQ(by.stats.expectedError, taken.error);
        EXPECT_EQ(by.stats.takenTargetError, taken.target > 0 ? float(taken.target) : 0.003f);
        EXPECT_EQ(by.stats.tuned, 1u);
        const auto as = taken.method == PEL_SCATTERING_AUTO ? PEL_SCATTERING_SCREEN : taken.method;
        EXPECT_EQ(by.shader.material(1).scattering, as);
        EXPECT_EQ(by.stats.takenHalfRate, taken.half);
        EXPECT_EQ(by.light, shot(lit, taken.method, float(by.stats.takenTargetError), 0, taken.half).light);
        EXPECT_EQ(by.shader.warnings(), "");
    }
    const Shot short_ = shot(lit, PEL_SCATTERING_AUTO, 0.003f, 1e-6f);
    EXPECT_EQ(short_.stats.pixelsByChoice[PEL_SCATTERING_NONE], lit.places.size());
    EXPECT_NE(short_.shader.warnings().find("timeBudget is 1e-06"), std::string::npos)
        << short_.shader.warnings();
    // Ids of every format are counted.
    Shot by = shot(lit, PEL_SCATTERING_AUTO, 0.003f, 1e3f);
    const auto& ids = lit.gbuffer.material;
    const auto counts = [&](const auto& values, PelFormat format) {
        by.shader.set(PEL_SLOT_MATERIAL, imageDesc(pellucid::Buffer(device(), values), format,
                                                   uint32_t(lit.width), uint32_t(lit.height)));
        const double before = by.stats.expectedMilliseconds,
                     now = by.shader.commit().stats().expectedMilliseconds;
        EXPECT_EQ(now, before) << "format " << int(format);
    };
    std::vector<uint16_t> halves(ids.size());
    std::ranges::transform(ids, halves.begin(), [](auto id) { return uint16_t(id ? 0x3C00 : 0); });
    counts(halves, PEL_FORMAT_R16F);
    counts(std::vector<float>(ids.begin(), ids.end()), PEL_FORMAT_R32F);
    counts(std::vector<uint16_t>(ids.begin(), ids.end()), PEL_FORMAT_R16_UINT);
    counts(std::vector<uint32_t>(ids.begin(), ids.end()), PEL_FORMAT_R32_UINT);
    // Errors below targetError are not aimed at; maps do not hold ambient light.
    const auto least = [&](const LitScene& s) { return shot(s, PEL_SCATTERING_AUTO, 0.05f, 1e3f).stats; };
    EXPECT_EQ(least(lit).expectedError, rows[6].error);
    const PelShaderStats around = least(scene(0.2));
    EXPECT_EQ(around.expectedError, rows[3].error);
    EXPECT_EQ(around.takenTargetError, 0.05f);
    // Where half rate is asked for, light has no other.
    EXPECT_EQ(shot(lit, PEL_SCATTERING_AUTO, 0.003f, 1e3f, true).stats.expectedError, rows[5].error);
    // The frame is not drawn yet.
    LitScene empty = lit;
    std::ranges::fill(empty.gbuffer.material, uint8_t(0));
    EXPECT_NEAR(shot(empty, PEL_SCATTERING_AUTO, 0.003f, 1e3f).stats.expectedMilliseconds,
                expected(rows[6], frame), 1e-9);
    // Other methods, and no budget.
    for (const PelShaderStats& stats : {shot(lit, PEL_SCATTERING_SCREEN, 0.003f, 1e-6f).stats,
                                        shot(lit, PEL_SCATTERING_AUTO, 0.003f).stats}) {
        EXPECT_EQ(stats.expectedMilliseconds, 0);
        EXPECT_EQ(stats.takenTargetError, 0);
        EXPECT_GT(stats.pixelsScattered, 0u);
    }
}

TEST_F(TimeBudget, GuessesWithoutARecord) {
    const LitScene lit = scene();
    double last = INFINITY;
    for (const float budget : {1e-6f, 1e6f}) {
        writeRecord("a device that is not here");
        const PelShaderStats of = shot(lit, PEL_SCATTERING_AUTO, 0.002f, budget).stats;
        EXPECT_EQ(of.tuned, 0u);
        EXPECT_EQ(of.takenHalfRate, uint64_t(budget > 1));
        EXPECT_LT(of.expectedError, last);
        last = of.expectedError;
        tuning_.set(nullptr);
        EXPECT_EQ(shot(lit, PEL_SCATTERING_AUTO, 0.002f, budget).stats.expectedError, last);
        tuning_.set(record().c_str());
    }
}

TEST_F(TimeBudget, RefusesDamagedRecordsByName) {
    const std::string head = "pellucid tuning 1\ndevice " + device_ + "\n";
    const struct {
        std::string text;
        const char* said;
    } bad[] = {{"", "cannot be read"},
               {"pellucid tuning 2\n", "line 1: \"pellucid tuning 1\" must be here"},
               {std::string(64, '\0'), "line 1"},
               {head + "auto 0.1 1\n", "line 3: a method and four numbers"},
               {head + "auto 0.1 1 1 0.1 7\n", "line 3: a method and four numbers"},
               {head + "auto nan 1 1 0.1\n", "line 3: a method and four numbers"},
               {head + "auto 0.1 1e999 1 0.1\n", "line 3: a method and four numbers"},
               {head + "auto 0.1 -1 1 0.1\n", "line 3: -1 is not between"},
               {head + "auto 2 1 1 0.1\n", "line 3: errors are shares"},
               {head + "\n\nsmooth 0 1 1 0.1\n", "line 5: \"smooth\" is not one of"},
               {head + "texture 0 1 1 0.1\n", "\"texture\" is not one of"},
               {std::string((1 << 20) + 1, '#'), "more than 1048576 bytes"},
               {[&] {
                    std::string many = head;
                    for (int i = 0; i < 65; ++i) many += "none 0 0 0 0.1\n";
                    return many;
                }(),
                "more than 64 settings"}};
    const LitScene lit = scene();
    for (const auto& [text, said] : bad) {
        const std::string file = write("record.txt", text);
        expectRefused({"PELLUCID_TUNING: ", file.c_str(), said},
                      [&] { shot(lit, PEL_SCATTERING_AUTO, 0.002f, 1); });
        shot(lit, PEL_SCATTERING_AUTO, 0.002f);  // without a budget nobody reads it
    }
}

}  // namespace
