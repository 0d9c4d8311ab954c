// Launch sizes from a file: what counts, what is refused, and that no size changes a bit of a result.
#include "tuning/launch_sizes.h"

#include "device_lanes.h"
#include "diffusion/lit_scenes.h"
#include "io/io_files.h"

using pel::LaunchPolicy;

namespace {

PelDeviceInfo infoOf(uint32_t lanes) {
    PelDeviceInfo info = pelDeviceInfoDefaults();
    std::strcpy(info.name, "a GPU"), std::strcpy(info.platform, "a platform"),
        std::strcpy(info.driver, "1.2");
    info.mathWidth = lanes, info.maxWorkGroupSize = 1024;
    return info;
}

class LaunchSizes : public FolderTest {
  protected:
    void SetUp() override {
        FolderTest::SetUp();
        tuning_.set(nullptr);
    }
    const Variable tuning_{"PELLUCID_TUNING"};
};

}  // namespace

TEST_F(LaunchSizes, AFileCountsForItsOwnDeviceDriverAndVersion) {
    const Variable cache("PELLUCID_CACHE_DIR", path("cache").c_str());
    const PelDeviceInfo info = infoOf(1);
    const LaunchPolicy wanted{128, 4, 2, 32};
    const std::string text = pel::launchText(info, wanted), own = pel::launchFile(info).string();
    EXPECT_EQ(pel::launchRule(info).policy, pel::builtInPolicy(1));
    EXPECT_EQ(pel::launchRule(info).warning, "") << "no file is usual";
    std::filesystem::create_directories(path("cache"));
    write(own.substr(path("").size()), text);
    EXPECT_EQ(pel::launchRule(info).policy, wanted);
    EXPECT_EQ(pel::launchRule(info).file, own);
    tuning_.set("off");
    EXPECT_EQ(pel::launchRule(info).policy, pel::builtInPolicy(1));
    write("named.txt",
          "pellucid tuning 1\r\ndevice another, one\r\nlaunch 1 1 1 1 0 0\r\n" + text.substr(18));
    tuning_.set(path("named.txt").c_str());
    EXPECT_EQ(pel::launchRule(info).policy, wanted);
    for (const auto change : {&PelDeviceInfo::name, &PelDeviceInfo::platform}) {
        PelDeviceInfo other = info;
        (other.*change)[0] = 'X';
        EXPECT_EQ(pel::launchRule(other).policy, pel::builtInPolicy(1));
        EXPECT_TRUE(contains(pel::launchRule(other).warning, "no sizes for this device"));
        EXPECT_NE(pel::launchFile(other), own);
    }
    PelDeviceInfo later = info;
    std::strcpy(later.driver, "1.3");
    EXPECT_EQ(pel::launchRule(later).policy, pel::builtInPolicy(1));
    EXPECT_TRUE(contains(pel::launchRule(later).warning, "1.2, but this is "))
        << pel::launchRule(later).warning;
    EXPECT_NE(pel::launchFile(later), own);
}

TEST_F(LaunchSizes, DamagedFilesAreIgnoredWithTheReason) {
    const PelDeviceInfo info = infoOf(1);
    const std::string good = pel::launchText(info, {128, 4, 2, 32}),
                      head = good.substr(0, good.find("launch "));
    const std::string made = good.substr(good.find("launch ") + std::string("launch 128 4 2 32").size());
    tuning_.set(path("tuning.txt").c_str());
    EXPECT_TRUE(contains(pel::launchRule(info).warning, "not a readable file"));
    for (size_t length = 0; length < good.size() - 1; ++length) {
        write("tuning.txt", good.substr(0, length));
        EXPECT_EQ(pel::launchRule(info).policy, pel::builtInPolicy(1)) << length;
    }
    for (const std::string& text :
         {head + "launch 128 4 2" + made, head + "launch 128 4 2 -32" + made, head + "launch 0 4 2 32" + made,
          head + "launch 1e9 4 2 32" + made, head + "launch 99999999999999999999 4 2 32" + made,
          head + "launch " + std::string(1000, '\xff'), "pellucid tuning 2\n" + good,
          std::string(2 << 20, 'a'), std::string(1000, '\0')}) {
        write("tuning.txt", text);
        const pel::LaunchRule rule = pel::launchRule(info);
        EXPECT_EQ(rule.policy, pel::builtInPolicy(1)) << text.substr(0, 100);
        EXPECT_TRUE(contains(rule.warning, path("tuning.txt") + " does not set launch sizes: "))
            << rule.warning;
    }
    // Well-formed but impossible sizes are replaced by possible ones.
    write("tuning.txt", head + "launch 1048576 3 1048576 1" + made);
    EXPECT_EQ(pel::launchRule(info).policy, (LaunchPolicy{256, 2, 4096, 16}));
    PelDeviceInfo small = infoOf(16);
    small.maxWorkGroupSize = 100;
    EXPECT_EQ(pel::allowedPolicy({1 << 20, 1, 100, 1 << 20}, small), (LaunchPolicy{64, 16, 64, 64}));
    tuning_.set(path("").c_str());
    EXPECT_TRUE(contains(pel::launchRule(info).warning, "not a readable file")) << "a folder";
}

TEST_F(LaunchSizes, NoSizeChangesABit) {
    using namespace lit_scenes;
    const std::map<int, LaunchPolicy> others{{1, {16, 2, 4, 256}},
                                             {int(device().info().mathWidth), {4, 16, 128, 64}}};
    const Profile skin = Profile::skin();
    SceneRequest request;
    request.size = 144, request.mapSize = 512;
    const LitScene scene = Stage(device(), relief(60, 6, pores), 1).look(request, skin);
    struct Made {
        std::vector<std::vector<float>> values;
        std::string warnings;
    };
    const auto make = [&](int lanes, const LaunchPolicy& policy) {
        Made made;
        pelSetLogCallback([](void* said, PelLogLevel, const char*,
                             const char* line) { static_cast<Made*>(said)->warnings += line; },
                          &made);
        write("tuning.txt", pel::launchText(lanes::deviceOf(lanes).info(), policy));
        const pellucid::Device device = lanes::deviceOf(lanes);
        for (const Profile& profile : {skin, Profile::named("jade")}) {
            PelCurvatureLutDesc curvature = pelCurvatureLutDescDefaults();
            PelShadowLutDesc shadow = pelShadowLutDescDefaults();
            curvature.profile = shadow.profile = profile.get();
            curvature.width = curvature.height = shadow.width = shadow.height = 70;
            made.values.push_back(pellucid::Lut(device, curvature).read<float>(PEL_LUT_FLOAT));
            made.values.push_back(pellucid::Lut(device, shadow).read<float>(PEL_LUT_FLOAT));
        }
        for (const PelScattering method : {PEL_SCATTERING_PREINTEGRATED, PEL_SCATTERING_AUTO,
                                           PEL_SCATTERING_LIGHT, PEL_SCATTERING_SCREEN}) {
            // One lane shares its kernels' code with several, and takes as long to compile.
            if (lanes == 1 && method != PEL_SCATTERING_AUTO && method != PEL_SCATTERING_SCREEN) continue;
            ShadeRequest how;
            how.scattering = method, how.scatterTaps = method == PEL_SCATTERING_SCREEN ? 8 : 0;
            made.values.push_back(shoot(device, scene, skin, 1, how).light);
        }
        pelSetLogCallback(nullptr, nullptr);
        return made;
    };
    tuning_.set(path("tuning.txt").c_str());
    for (const auto& [lanes, policy] : others) {
        const Made usual = make(lanes, pel::builtInPolicy(uint32_t(lanes))), other = make(lanes, policy);
        EXPECT_EQ(other.warnings, "");
        for (size_t i = 0; i < usual.values.size(); ++i)
            EXPECT_EQ(usual.values[i], other.values[i]) << lanes << " lanes, " << i;
    }
    std::string said;
    pelSetLogCallback(
        [](void* to, PelLogLevel level, const char*, const char* line) {
            if (level == PEL_LOG_WARNING) *static_cast<std::string*>(to) += line;
        },
        &said);
    write("tuning.txt", "no record");
    EXPECT_GT(lanes::deviceOf(1).info().mathWidth, 0u);
    pelSetLogCallback(nullptr, nullptr);
    EXPECT_TRUE(contains(said, "does not set launch sizes: it does not begin with pellucid tuning 1"))
        << said;
}
