#include "lut/luts.h"

#include <cstring>

#include "core/launch_policy.h"
#include "lut/lut_terms.h"
#include "shared/choices.h"

namespace pel {
namespace {

// Nodes of a row: with two Gauss points between neighbours the error is about 1e-7.
constexpr int curvatureNodes = 64;

// The kernel's names of the forms.
#define FORM_NUMBER(name, number, key) {"PEL_FORM_" #name, #number},

// Tables of sums of Gaussians that one launch makes: they differ only in their profiles and ranges of rows.
struct Stack {
    std::vector<StackedLut> tables;
    std::vector<LutGaussian> gaussians;

    StackedLut& add(const Lut& lut, const std::vector<LutGaussian>& terms) {
        const RowAxis rows = rowsOf(lut);
        StackedLut table{};
        table.first = uint32_t(gaussians.size());
        table.gaussians = uint32_t(terms.size());
        table.rowMin = float(rows.min);
        table.rowStep = float(rows.step);
        gaussians.insert(gaussians.end(), terms.begin(), terms.end());
        tables.push_back(table);
        return tables.back();
    }
    // The tables, and their Gaussians behind them.
    cl::Memory upload(Device& device) const {
        static_assert(sizeof(StackedLut) % sizeof(LutGaussian) == 0);
        const size_t head = tables.size() * sizeof(StackedLut), tail = gaussians.size() * sizeof(LutGaussian);
        std::vector<unsigned char> bytes(head + tail);
        std::memcpy(bytes.data(), tables.data(), head);
        std::memcpy(bytes.data() + head, gaussians.data(), tail);
        return device.upload(bytes);
    }
};

using Luts = std::span<const Ref<Lut>>;

bool isTabulated(const Lut& lut) {
    return lut.profile()->terms().empty();
}

// `luts` have one description but for profiles and lengths, and no tabulated profile.
void integrateCurvature(Luts luts, const cl::Memory& texels) {
    Device& device = luts[0]->device();
    const PelCurvatureLutDesc& all = luts[0]->info().curvature;
    Stack stack;
    for (const Ref<Lut>& lut : luts) {
        const double most = rowRange(*lut).most;
        std::vector<LutGaussian> terms = deviceTerms(*lut->profile(), most);
        // 1/d has no finite integral along a ring. The limit of the ratio is a point.
        if (lut->profile()->shape().singular() &&
            (all.form == PEL_FORM_RING || all.form == PEL_FORM_HALF_RING))
            terms = {{float(1e-8 / std::max(1.0, most)), 1, 1, 1}};
        stack.add(*lut, terms);
    }

    const uint32_t lanes = device.info().mathWidth;
    const size_t group = launchPolicy(device).group, columnsPerItem = launchPolicy(device).columns;
    const cl::Program program = device.programs().get(
        "lut/curvature_lut.cl", {PEL_EACH_CURVATURE_FORM(FORM_NUMBER){"PEL_FORM", int(all.form)},
                                 {"PEL_GROUP", group},
                                 {"PEL_NODES", curvatureNodes},
                                 {"PEL_COLUMNS", columnsPerItem}});
    const cl::Memory tables = stack.upload(device),
                     nodes = device.constants("nodes", [] { return meshOfNodes(curvatureNodes); }),
                     columns = device.constants(text("columns ", all.width, " ", int(all.axis)), [&] {
                         return curvatureColumns(all.width, all.axis, curvatureNodes);
                     });
    const size_t record = PEL_CURVATURE_RECORD(curvatureNodes);
    const cl::Memory rows = device.allocate(record * all.height * luts.size() * sizeof(cl_float4));
    const StackParams params{all.width, all.height, uint32_t(all.axis), 0, float(profileCut)};
    cl::Launch rowLaunch(program, "curvature_rows", params, tables, nodes, rows);
    device.launch(rowLaunch, {{(all.height + lanes - 1) / lanes, 1, luts.size()}, {group, 1, 1}});

    cl::Launch texelLaunch(program, "curvature_texels", all.width, all.height, rows, columns, texels);
    const size_t items = ((all.width + 1) / 2 + columnsPerItem - 1) / columnsPerItem;
    device.launch(texelLaunch, {{items, all.height + 1, luts.size()}, {group, 1, 1}});
}

void integrateShadow(Luts luts, const cl::Memory& texels) {
    Device& device = luts[0]->device();
    const PelShadowLutDesc& all = luts[0]->info().shadow;
    Stack stack;
    for (const Ref<Lut>& lut : luts) {
        const Profile& profile = *lut->profile();
        StackedLut& table = stack.add(*lut, deviceTerms(profile, rowRange(*lut).most));
        table.sharpening = lut->info().shadow.sharpening;
        for (int channel = 0; channel < 3; ++channel) {
            double total = 0;
            for (const GaussianTerm& term : profile.terms())
                total += term.weight[channel] *
                         std::erf(profileCut * profile.radius() / std::sqrt(2 * term.variance));
            table.total[channel] = float(total);
        }
    }

    const size_t group = launchPolicy(device).group, columnsPerItem = launchPolicy(device).columns;
    const cl::Program program =
        device.programs().get("lut/shadow_lut.cl", {{"PEL_GROUP", group}, {"PEL_COLUMNS", columnsPerItem}});
    const StackParams params{all.width, all.height, uint32_t(all.axis), all.closedEnds, float(profileCut)};
    const cl::Memory tables = stack.upload(device);
    cl::Launch launch(program, "shadow_texels", params, tables, texels);
    const size_t lit = all.width - all.width / 2, items = (lit + columnsPerItem - 1) / columnsPerItem;
    device.launch(launch, {{items, all.height + 1, luts.size()}, {group, 1, 1}});
}

void integrate(Luts luts, const cl::Memory& texels) {
    (luts[0]->info().kind == PEL_LUT_CURVATURE ? integrateCurvature : integrateShadow)(luts, texels);
}

template <class Desc>
PelLutInfo infoOf(PelLutKind kind, Desc PelLutInfo::*member, const Desc& desc) {
    PelLutInfo info = pelLutInfoDefaults();
    info.kind = kind;
    info.*member = desc;
    return info;
}

// A curvature or shadow table whose description is valid.
Ref<Lut> integrated(Ref<Device> device, const PelLutInfo& info) {
    Ref<Lut> lut = make<Lut>(std::move(device), info);
    if (!isTabulated(*lut))
        integrate({&lut, 1}, lut->texels());
    else if (info.kind == PEL_LUT_CURVATURE)
        integrateTabulatedCurvature(*lut);
    else
        integrateTabulatedShadow(*lut);
    return lut;
}

// Texels to the packed layouts of PelLutEncoding, by kernels/lut/lut_encode.cl.
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

// This encoding needs no computation, so the host copies: compiling a program takes a CPU longer than making
// a table.
void readFloats(const Lut& lut, float* destination) {
    const size_t rowTexels = lut.layout().rowTexels, width = lut.width(), height = lut.height();
    std::vector<cl_float4> texels(rowTexels * height);
    lut.device().read(lut.texels().get(), 0, texels.size() * sizeof(cl_float4), texels.data(), true);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x)
            for (size_t c = 0; c < 3; ++c) *destination++ = texels[y * rowTexels + x].s[c];
}

// Encodes and reads `tables` tables like `lut`, stored one after another.
void encodeAndRead(const Lut& lut, const cl::Memory& texels, size_t tables, PelLutEncoding encoding,
                   void* destination, bool blocking) {
    Device& device = lut.device();
    const size_t bytes = tables * packedBytes(lut, encoding);
    const cl::Memory packed = device.allocate(bytes);
    constexpr size_t group = 64;
    cl::Launch launch(device.programs().get("lut/lut_encode.cl", {{"PEL_GROUP", group}}),
                      encodingOf(lut, encoding).kernel, lut.layout(), texels, packed);
    device.launch(launch, {{lut.width(), lut.height(), tables}, {group, 1, 1}});
    device.read(packed.get(), 0, bytes, destination, blocking);
}

void checkAlike(std::span<const PelLutInfo> tables) {
    const auto different = [&](size_t i, const char* field) {
        invalidArgument("table ", i, " of the stack differs from the first in ", field,
                        "; make a stack for each of them");
    };
    const bool curvature = tables[0].kind == PEL_LUT_CURVATURE;
    if (!curvature && tables[0].kind != PEL_LUT_SHADOW)
        invalidArgument("a stack holds tables of PEL_LUT_CURVATURE (0) or PEL_LUT_SHADOW (1), not of kind ",
                        int(tables[0].kind));
    const auto check = [&](size_t i, const auto& first, const auto& other) {
        if (other.width != first.width) different(i, "width");
        if (other.height != first.height) different(i, "height");
        if (other.axis != first.axis) different(i, "axis");
    };
    for (size_t i = 1; i < tables.size(); ++i) {
        const PelLutInfo &first = tables[0], &other = tables[i];
        if (other.kind != first.kind) different(i, "kind");
        if (curvature) {
            check(i, first.curvature, other.curvature);
            if (other.curvature.form != first.curvature.form) different(i, "form");
        } else {
            check(i, first.shadow, other.shadow);
            if (other.shadow.closedEnds != first.shadow.closedEnds) different(i, "closedEnds");
        }
    }
}

}  // namespace

Ref<Lut> integrateCurvatureLut(Ref<Device> device, const PelCurvatureLutDesc& desc) {
    checkCurvatureDesc(desc);
    return integrated(std::move(device), infoOf(PEL_LUT_CURVATURE, &PelLutInfo::curvature, desc));
}

Ref<Lut> integrateShadowLut(Ref<Device> device, const PelShadowLutDesc& desc) {
    checkShadowDesc(desc);
    return integrated(std::move(device), infoOf(PEL_LUT_SHADOW, &PelLutInfo::shadow, desc));
}

Ref<Lut> tabulateSpecularLut(Ref<Device> device, const PelSpecularLutDesc& desc) {
    checkSpecularDesc(desc);
    Ref<Lut> lut = make<Lut>(device, infoOf(PEL_LUT_SPECULAR, &PelLutInfo::specular, desc));
    constexpr size_t group = 64;
    cl::Launch launch(device->programs().get("lut/specular_lut.cl", {{"PEL_GROUP", group}}),
                      "specular_texels", lut->layout(), lut->texels());
    device->launch(launch, {{desc.width + size_t(1), desc.height + size_t(1), 1}, {group, 1, 1}});
    return lut;
}

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
    if (encoding == PEL_LUT_FLOAT && blocking) return readFloats(lut, static_cast<float*>(destination));
    encodeAndRead(lut, lut.texels(), 1, encoding, destination, blocking);
}

void readLutStack(const Ref<Device>& device, std::span<const PelLutInfo> tables, PelLutEncoding encoding,
                  void* destination, size_t bytes) {
    if (tables.empty()) return;
    checkAlike(tables);
    const Ref<Lut> like = make<Lut>(device, tables[0], true);
    const size_t each = packedBytes(*like, encoding);
    if (bytes / tables.size() < each)
        invalidArgument("the stack takes ", tables.size(), " x ", each,
                        " bytes in this encoding; destination has ", bytes);
    // Limit for the texels of one launch, so that they and the records of rows stay in a processor's cache.
    constexpr size_t bytesTogether = 1 << 19;
    const size_t most = std::max<size_t>(1, bytesTogether / like->texelBytes());
    std::vector<Ref<Lut>> luts;
    auto* to = static_cast<char*>(destination);
    for (size_t i = 0; i < tables.size(); i += luts.size()) {
        luts.clear();
        for (size_t k = i; k < tables.size() && luts.size() < most; ++k) {
            Ref<Lut> lut = make<Lut>(device, tables[k], true);
            if (isTabulated(*lut)) break;
            luts.push_back(std::move(lut));
        }
        if (luts.empty()) {  // a tabulated profile
            luts.push_back(integrated(device, tables[i]));
            readLut(*luts[0], encoding, to, true);
        } else {
            const cl::Memory texels = device->allocate(luts.size() * like->texelBytes());
            integrate(luts, texels);
            encodeAndRead(*like, texels, luts.size(), encoding, to, true);
        }
        to += luts.size() * each;
    }
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
