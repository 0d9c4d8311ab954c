// PelEye and PelEyeLutDesc: defaults, and errors by name for what does not fit together.
#include <gtest/gtest.h>

#include <pellucid/pellucid.hpp>

#include <cmath>
#include <functional>

#include "refusal.h"

using namespace pellucid;

namespace {

class EyeSettings : public ::testing::Test {
  protected:
    Device device{""};
    Shader shader{device};
    EyeSettings() { shader.setMaterial(1, pelMaterialDefaults()); }
};

}  // namespace

TEST_F(EyeSettings, WrongFieldsAreNamed) {
    const float nan = std::nanf(""), inf = INFINITY;
    const std::pair<const char*, std::function<void(PelEye&)>> wrong[] = {
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
    shader.setEye(1, pelEyeDefaults());
    for (const auto& [field, change] : wrong) {
        PelEye eye = pelEyeDefaults();
        change(eye);
        expectRefused({"PelEye.", field}, [&] { shader.setEye(1, eye); });
    }
}

TEST_F(EyeSettings, AMaterialComesFirst) {
    expectRefused("pelShaderSetMaterial", [&] { shader.setEye(2, pelEyeDefaults()); });
    Buffer texels(device, 16 * 16 * 12);
    const auto texture = imageDesc(texels, PEL_FORMAT_RGB32F, 16, 16);
    expectRefused("pelShaderSetEye", [&] { shader.setIrisTexture(1, texture); });
    shader.setEye(1, pelEyeDefaults());
    shader.setIrisTexture(1, texture).clearIrisTexture(1);
    expectRefused("square", [&] { shader.setIrisTexture(1, imageDesc(texels, PEL_FORMAT_RGB32F, 16, 8)); });
    shader.clearEye(1);
    expectRefused("pelShaderSetEye", [&] { shader.setIrisTexture(1, texture); });
    expectRefused("six", [&] { shader.setReflectionCube(imageDesc(texels, PEL_FORMAT_RGB32F, 4, 16)); });
}

TEST_F(EyeSettings, SixtyFourAreTheMost) {
    for (uint32_t id = 1; id <= 65; ++id) shader.setMaterial(id, pelMaterialDefaults());
    for (uint32_t id = 1; id <= 64; ++id) shader.setEye(id, pelEyeDefaults());
    shader.setEye(7, pelEyeDefaults());  // once more
    expectRefused("64", [&] { shader.setEye(65, pelEyeDefaults()); });
    shader.clearEye(7).setEye(65, pelEyeDefaults());
}

TEST_F(EyeSettings, OtherTablesAreRefused) {
    PelSpecularLutDesc desc = pelSpecularLutDescDefaults();
    desc.width = desc.height = 4;
    const Lut other(device, desc);
    expectRefused("pelEyeLutCreate", [&] { shader.setEye(1, pelEyeDefaults(), other); });
}

TEST_F(EyeSettings, WrongFieldsOfTablesAreNamed) {
    const std::pair<const char*, std::function<void(PelEyeLutDesc&)>> wrong[] = {
        {"width", [](PelEyeLutDesc& d) { d.width = 1; }},
        {"depth", [](PelEyeLutDesc& d) { d.depth = 257; }},
        {"corneaRadius", [](PelEyeLutDesc& d) { d.corneaRadius = -1; }},
        {"irisRadius", [](PelEyeLutDesc& d) { d.irisRadius = 8; }},
        {"millimetresPerUnit", [](PelEyeLutDesc& d) { d.millimetresPerUnit = 0; }},
    };
    for (const auto& [field, change] : wrong) {
        PelEyeLutDesc desc = pelEyeLutDescDefaults();
        change(desc);
        expectRefused({"PelEyeLutDesc.", field}, [&] { Lut(device, desc); });
    }
}
