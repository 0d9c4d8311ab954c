#include "io/lut/lut_describe.h"

namespace pellucid::io {

std::pair<uint32_t, uint32_t> lutSize(const PelLutInfo& info) {
    switch (info.kind) {
        case PEL_LUT_CURVATURE:
            return {info.curvature.width, info.curvature.height};
        case PEL_LUT_SHADOW:
            return {info.shadow.width, info.shadow.height};
        case PEL_LUT_EYE:
            return {info.eye.width, info.eye.height * info.eye.depth};
        case PEL_LUT_SPECULAR:
            break;
    }
    return {info.specular.width, info.specular.height};
}

std::vector<std::pair<std::string, Attribute>> describeLut(const PelLutInfo& info) {
    std::vector<std::pair<std::string, Attribute>> all;
    all.emplace_back("pellucid:kind", std::string(lutKinds[info.kind]));
    all.emplace_back("pellucid:version", int(pelVersion()));
    all.emplace_back("pellucid:format", lutFormatVersion);
    all.emplace_back("pellucid:colorSpace", std::string("linear"));
    if (info.kind != PEL_LUT_SPECULAR) all.emplace_back("pellucid:profile", std::string(info.profile));
    if (info.kind == PEL_LUT_CURVATURE) {
        all.emplace_back("pellucid:form", std::string(curvatureForms[info.curvature.form]));
        all.emplace_back("pellucid:axis", std::string(lutAxes[info.curvature.axis]));
    }
    if (info.kind == PEL_LUT_SHADOW) {
        all.emplace_back("pellucid:axis", std::string(lutAxes[info.shadow.axis]));
        all.emplace_back("pellucid:closedEnds", int(info.shadow.closedEnds));
    }
    if (info.kind == PEL_LUT_EYE) all.emplace_back("pellucid:depth", int(info.eye.depth));
    visitLutNumbers(info, [&](const char* name, float value) { all.emplace_back(name, value); });
    return all;
}

}  // namespace pellucid::io
