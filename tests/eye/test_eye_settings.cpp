// PelEye and PelEyeLutDesc: defaults, and errors by name for what does not fit together.
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <functional>
#include <string>

using namespace pellucid;

namespace {

// The message of an error, or "" without one.
std::string errorOf(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), PEL_ERROR_INVALID_ARGUMENT) << e.what();
        return e.what();
    }
    return "";
}

class EyeSettings : public ::testing::Test {
  protected:
    Device device{""};
    Shader shader{device};
    EyeSettings() { shader.setMaterial(1, pelMaterialDefaults()); }
    std::string eyeError(const std::function<void(PelEye&)>& change) {
        PelEye eye = pelEyeDefaults();
        change(eye);
        return errorOf([&] { shader.setEye(1, eye); });
    }
};

struct Wrong {
    const char* field;
    std::function<void(PelEye&)> change;
};

}  // namespace

TEST_F(EyeSettings, DefaultsAreAnEye) {
    EXPECT_EQ(eyeError([](PelEye&) {}), "");
}

TEST_F(EyeSettings, WrongFieldsAreNamed) {
    const float nan = std::nanf(""), inf = INFINITY;
    const Wrong wrong[] = {
        {"gaze", [](PelEye& e) { e.gaze[2] = 0; }},
        {"gaze", [=](PelEye& e) { e.gaze[1] = nan; }},
        {"up", [](PelEye& e) { e.up[1] = 0; }},
        {"up", [](PelEye& e) { e.up[1] = 0, e.up[2] = -3; }},  // along gaze
        {"center", [=](PelEye& e) { e.center[0] = inf; }},
        {"scleraRadius", [](PelEye& e) { e.scleraRadius = 0; }},
        {"corneaRadius", [](PelEye& e) { e.corneaRadius = 0; }},
        {"corneaConic", [=](PelEye& e) { e.corneaConic = nan; }},
        {"limbusRadius", [](PelEye& e) { e.limbusRadius = 0; }},
        {"limbusRadius", [](PelEye& e) { e.limbusRadius = 12; }},
        {"limbusRadius", [](PelEye& e) { e.corneaRadius = 6, e.corneaConic = 0; }},  // a half ball
        {"limbusWidth", [](PelEye& e) { e.limbusWidth = -1; }},
        {"limbusDarkening", [](PelEye& e) { e.limbusDarkening = 2; }},
        {"chamberDepth", [](PelEye& e) { e.chamberDepth = 1; }},
        {"chamberDepth", [](PelEye& e) { e.chamberDepth = 30; }},
        {"corneaIndex", [](PelEye& e) { e.corneaIndex = 0.5f; }},
        {"aqueousIndex", [=](PelEye& e) { e.aqueousIndex = nan; }},
        {"irisRadius", [](PelEye& e) { e.irisRadius = 7; }},
        {"irisConcavity", [](PelEye& e) { e.irisConcavity = -1; }},
        {"pupilRadius", [](PelEye& e) { e.pupilRadius = 6; }},
        {"pupilRadius", [](PelEye& e) { e.pupilRadius = -1; }},
        {"texturePupil", [](PelEye& e) { e.texturePupil = 1; }},
        {"irisColor", [](PelEye& e) { e.irisColor[1] = -0.5f; }},
        {"tearRoughness", [](PelEye& e) { e.tearRoughness = 0; }},
        {"wetLineRoughness", [=](PelEye& e) { e.wetLineRoughness = nan; }},
        {"tearIndex", [](PelEye& e) { e.tearIndex = 0; }},
    };
    for (const Wrong& w : wrong) {
        const std::string message = eyeError(w.change);
        EXPECT_NE(message.find(std::string("PelEye.") + w.field), std::string::npos)
            << w.field << ": " << message;
    }
}

TEST_F(EyeSettings, AMaterialComesFirst) {
    EXPECT_NE(errorOf([&] { shader.setEye(2, pelEyeDefaults()); }).find("pelShaderSetMaterial"),
              std::string::npos);
    Buffer texels(device, 16 * 16 * 12);
    const auto texture = imageDesc(texels, PEL_FORMAT_RGB32F, 16, 16);
    EXPECT_NE(errorOf([&] { shader.setIrisTexture(1, texture); }).find("pelShaderSetEye"), std::string::npos);
    shader.setEye(1, pelEyeDefaults());
    shader.setIrisTexture(1, texture).clearIrisTexture(1);
    EXPECT_NE(errorOf([&] {
                  shader.setIrisTexture(1, imageDesc(texels, PEL_FORMAT_RGB32F, 16, 8));
              }).find("square"),
              std::string::npos);
    shader.clearEye(1);
    EXPECT_NE(errorOf([&] { shader.setIrisTexture(1, texture); }), "");
    EXPECT_NE(
        errorOf([&] { shader.setReflectionCube(imageDesc(texels, PEL_FORMAT_RGB32F, 4, 16)); }).find("six"),
        std::string::npos);
}

TEST_F(EyeSettings, SixtyFourAreTheMost) {
    for (uint32_t id = 1; id <= 65; ++id) shader.setMaterial(id, pelMaterialDefaults());
    for (uint32_t id = 1; id <= 64; ++id) shader.setEye(id, pelEyeDefaults());
    shader.setEye(7, pelEyeDefaults());  // once more
    EXPECT_NE(errorOf([&] { shader.setEye(65, pelEyeDefaults()); }).find("64"), std::string::npos);
    shader.clearEye(7).setEye(65, pelEyeDefaults());
}

TEST_F(EyeSettings, OtherTablesAreRefused) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = desc.height = 4;
    const Lut other(device, desc);
    EXPECT_NE(errorOf([&] { shader.setEye(1, pelEyeDefaults(), other); }).find("pelEyeLutCreate"),
              std::string::npos);
}

TEST_F(EyeSettings, WrongFieldsOfTablesAreNamed) {
    const auto lutError = [&](const std::function<void(PelEyeLutDesc&)>& change) {
        PelEyeLutDesc desc = pelEyeLutDescDefaults();
        change(desc);
        return errorOf([&] { Lut(device, desc); });
    };
    const std::pair<const char*, std::function<void(PelEyeLutDesc&)>> wrong[] = {
        {"width", [](PelEyeLutDesc& d) { d.width = 1; }},
        {"depth", [](PelEyeLutDesc& d) { d.depth = 257; }},
        {"corneaRadius", [](PelEyeLutDesc& d) { d.corneaRadius = -1; }},
        {"irisRadius", [](PelEyeLutDesc& d) { d.irisRadius = 8; }},
        {"millimetresPerUnit", [](PelEyeLutDesc& d) { d.millimetresPerUnit = 0; }},
    };
    for (const auto& [field, change] : wrong)
        EXPECT_NE(lutError(change).find(std::string("PelEyeLutDesc.") + field), std::string::npos) << field;
}
