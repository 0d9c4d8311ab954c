#include "lut/luts.h"

#include <cmath>

#include "core/launch_policy.h"
#include "lut/lut_terms.h"
#include "shared/choices.h"

namespace pel {
namespace {

// Of a row: with two Gauss points between two of them the error is about 1e-7.
constexpr int curvatureNodes = 64;

// What the kernel calls the forms.
#define FORM_NUMBER(name, number, key) {"PEL_FORM_" #name, #number},

CurvatureLutParams paramsOf(const PelCurvatureLutDesc& desc, double curvatureMin, double curvatureMax,
                            size_t terms) {
    CurvatureLutParams params{};
    params.width = desc.width;
    params.height = desc.height;
    params.gaussians = uint32_t(terms);
    params.axis = uint32_t(desc.axis);
    const RowAxis axis = rowAxis(desc.axis, desc.height, curvatureMin, curvatureMax);
    params.rowMin = float(axis.min);
    params.rowStep = float(axis.step);
    params.cut = float(profileCut);
    return params;
}

}  // namespace

Ref<Lut> integrateCurvatureLut(Ref<Device> device, const PelCurvatureLutDesc& desc) {
    checkCurvatureDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_CURVATURE;
    info.curvature = desc;
    Ref<Lut> lut = make<Lut>(device, info);

    const double radius = lut->diffusionRadius();
    const double curvatureMin = rowLimit(lut->info().curvature.radiusMax, radius),
                 curvatureMax = rowLimit(lut->info().curvature.radiusMin, radius);
    const Profile& profile = *lut->profile();
    if (profile.terms().empty()) {
        integrateTabulatedCurvature(*lut, curvatureMin, curvatureMax);
        return lut;
    }
    std::vector<LutGaussian> terms = deviceTerms(profile, curvatureMax);
    // 1/d has no finite integral along a ring. The limit of the ratio is a point.
    if (profile.shape().singular() && (desc.form == PEL_FORM_RING || desc.form == PEL_FORM_HALF_RING))
        terms = {{float(1e-8 / std::max(1.0, curvatureMax)), 1, 1, 1}};

    const uint32_t lanes = device->info().mathWidth;
    const size_t group = launchPolicy(*device).group, columnsPerItem = launchPolicy(*device).columns;
    const cl::Program program = device->programs().get(
        "lut/curvature_lut.cl", {PEL_EACH_CURVATURE_FORM(FORM_NUMBER){"PEL_FORM", int(desc.form)},
                                 {"PEL_GROUP", group},
                                 {"PEL_NODES", curvatureNodes},
                                 {"PEL_COLUMNS", columnsPerItem}});
    const cl::Memory gaussians = upload(*device, terms),
                     nodes = device->constants("nodes", [] { return meshOfNodes(curvatureNodes); }),
                     columns = device->constants(text("columns ", desc.width, " ", int(desc.axis)), [&] {
                         return curvatureColumns(desc.width, desc.axis, curvatureNodes);
                     });
    const size_t record = PEL_CURVATURE_RECORD(curvatureNodes);
    const cl::Memory rows = device->allocate(record * desc.height * sizeof(cl_float4));
    const CurvatureLutParams params = paramsOf(desc, curvatureMin, curvatureMax, terms.size());

    cl::Launch rowLaunch(program, "curvature_rows", params, gaussians, nodes, rows);
    device->launch(rowLaunch, {{(desc.height + lanes - 1) / lanes, 1, 1}, {group, 1, 1}});

    cl::Launch texelLaunch(program, "curvature_texels", desc.width, desc.height, rows, columns,
                           lut->texels());
    const size_t items = ((desc.width + 1) / 2 + columnsPerItem - 1) / columnsPerItem;
    device->launch(texelLaunch, {{items, desc.height + 1, 1}, {group, 1, 1}});
    return lut;
}

Ref<Lut> integrateShadowLut(Ref<Device> device, const PelShadowLutDesc& desc) {
    checkShadowDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SHADOW;
    info.shadow = desc;
    Ref<Lut> lut = make<Lut>(device, info);

    const Profile& profile = *lut->profile();
    const double radius = lut->diffusionRadius();
    const double reciprocalMin = rowLimit(lut->info().shadow.widthMax, radius),
                 reciprocalMax = rowLimit(lut->info().shadow.widthMin, radius);
    if (profile.terms().empty()) {
        integrateTabulatedShadow(*lut, reciprocalMin, reciprocalMax);
        return lut;
    }
    const std::vector<LutGaussian> terms = deviceTerms(profile, reciprocalMax);
    const RowAxis axis = rowAxis(desc.axis, desc.height, reciprocalMin, reciprocalMax);
    ShadowLutParams params{desc.width,          desc.height,     uint32_t(terms.size()), float(axis.min),
                           float(axis.step),    desc.sharpening, float(profileCut),      {},
                           uint32_t(desc.axis), desc.closedEnds};
    for (int channel = 0; channel < 3; ++channel) {
        double total = 0;
        for (const GaussianTerm& term : profile.terms())
            total +=
                term.weight[channel] * std::erf(profileCut * profile.radius() / std::sqrt(2 * term.variance));
        params.total[channel] = float(total);
    }

    const size_t group = launchPolicy(*device).group, columnsPerItem = launchPolicy(*device).columns;
    const cl::Program program =
        device->programs().get("lut/shadow_lut.cl", {{"PEL_GROUP", group}, {"PEL_COLUMNS", columnsPerItem}});
    const cl::Memory gaussians = upload(*device, terms);
    cl::Launch launch(program, "shadow_texels", params, gaussians, lut->texels());
    const size_t lit = desc.width - desc.width / 2, items = (lit + columnsPerItem - 1) / columnsPerItem;
    device->launch(launch, {{items, desc.height + 1, 1}, {group, 1, 1}});
    return lut;
}

Ref<Lut> tabulateSpecularLut(Ref<Device> device, const PelSpecularLutDesc& desc) {
    checkSpecularDesc(desc);
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = PEL_LUT_SPECULAR;
    info.specular = desc;
    Ref<Lut> lut = make<Lut>(device, info);
    constexpr size_t group = 64;
    cl::Launch launch(device->programs().get("lut/specular_lut.cl", {{"PEL_GROUP", group}}),
                      "specular_texels", lut->layout(), lut->texels());
    device->launch(launch, {{desc.width + size_t(1), desc.height + size_t(1), 1}, {group, 1, 1}});
    return lut;
}

// Beside kernels/lut/lut_encode.cl: texels from and to the packed layouts of PelLutEncoding.
namespace {

struct Encoding {
    const char* kernel;
    size_t texelBytes;
};

const char* bytesKernel(PelLutKind kind) {
    return kind == PEL_LUT_CURVATURE ? "encode_curvature_bytes"
           : kind == PEL_LUT_SHADOW  ? "encode_shadow_bytes"
                                     : "encode_bytes";
}

Encoding encodingOf(const Lut& lut, PelLutEncoding encoding) {
    switch (encoding) {
        case PEL_LUT_FLOAT:
            return {"encode_float", 12};
        case PEL_LUT_HALF:
            return {"encode_half", 6};
        case PEL_LUT_FACEWORKS8:
            if (lut.info().kind == PEL_LUT_EYE)
                invalidArgument(
                    "an eye's table has values above 1, which PEL_LUT_FACEWORKS8 cannot hold: PEL_LUT_HALF "
                    "would be right");
            return {bytesKernel(lut.info().kind), 4};
    }
    invalidArgument("LUT encoding ", int(encoding),
                    " is unknown; PEL_LUT_FLOAT (0), PEL_LUT_HALF (1) or PEL_LUT_FACEWORKS8 (2) is needed");
}

// Nothing is computed for this encoding: copying here spares a program, which takes a CPU longer to compile
// than a table to make.
void readFloats(const Lut& lut, float* destination) {
    const size_t rowTexels = lut.layout().rowTexels, width = lut.width(), height = lut.height();
    std::vector<cl_float4> texels(rowTexels * height);
    lut.device().read(lut.texels().get(), 0, texels.size() * sizeof(cl_float4), texels.data(), true);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x)
            for (size_t c = 0; c < 3; ++c) *destination++ = texels[y * rowTexels + x].s[c];
}

}  // namespace

Ref<Lut> uploadLut(Ref<Device> device, const PelLutInfo& info, const float* texels, size_t bytes) {
    if (!texels) invalidArgument("texels are needed, not NULL");
    Ref<Lut> lut = make<Lut>(device, info);
    const size_t width = lut->width(), height = lut->height();
    if (bytes != width * height * 12)
        invalidArgument("a LUT of ", width, "x", height, " texels takes ", width * height * 12,
                        " bytes of RGB float32, not ", bytes);
    for (size_t i = 0; i < width * height * 3; ++i)
        if (!std::isfinite(texels[i]))
            invalidArgument("channel ", i % 3, " of texel (", i / 3 % width, ", ", i / 3 / width,
                            ") is not finite");
    const size_t rowTexels = lut->layout().rowTexels;
    std::vector<cl_float4> padded(rowTexels * (height + 1));
    for (size_t y = 0; y <= height; ++y)
        for (size_t x = 0; x <= width; ++x) {
            const float* from = texels + (std::min(y, height - 1) * width + std::min(x, width - 1)) * 3;
            padded[y * rowTexels + x] = {{from[0], from[1], from[2], 0}};
        }
    device->writeAside(lut->texels().get(), padded.size() * sizeof(cl_float4), padded.data());
    return lut;
}

size_t packedBytes(const Lut& lut, PelLutEncoding encoding) {
    return size_t(lut.width()) * lut.height() * encodingOf(lut, encoding).texelBytes;
}

void readLut(const Lut& lut, PelLutEncoding encoding, void* destination, bool blocking) {
    Device& device = lut.device();
    const Encoding how = encodingOf(lut, encoding);
    const size_t bytes = packedBytes(lut, encoding);
    if (encoding == PEL_LUT_FLOAT && blocking) return readFloats(lut, static_cast<float*>(destination));
    const cl::Memory packed = device.allocate(bytes);
    constexpr size_t group = 64;
    cl::Launch launch(device.programs().get("lut/lut_encode.cl", {{"PEL_GROUP", group}}), how.kernel,
                      lut.layout(), lut.texels(), packed);
    device.launch(launch, {{lut.width(), lut.height(), 1}, {group, 1, 1}});
    device.read(packed.get(), 0, bytes, destination, blocking);
}

uint64_t countClipped(const Lut& lut) {
    if (lut.info().kind != PEL_LUT_CURVATURE) return 0;
    Device& device = lut.device();
    cl_uint count = 0;
    const cl::Memory counter = device.allocate(sizeof count, &count);
    constexpr size_t group = 64;
    cl::Launch launch(device.programs().get("lut/lut_encode.cl", {{"PEL_GROUP", group}}), "count_clipped",
                      lut.layout(), lut.texels(), counter);
    device.launch(launch, {{lut.height(), 1, 1}, {group, 1, 1}});
    device.read(counter.get(), 0, sizeof count, &count, true);
    return count;
}

}  // namespace pel
