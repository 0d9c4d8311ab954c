// Beside kernels/lut/lut_encode.cl: texels from and to the packed layouts of PelLutEncoding.
#include <algorithm>
#include <cmath>

#include "lut/luts.h"

namespace pel {
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
    cl::Launch launch(device.programs().get("lut/lut_encode.cl", {{"PEL_GROUP", std::to_string(group)}}),
                      how.kernel);
    launch.arg(lut.layout()).arg(lut.texels()).arg(packed);
    device.launch(launch, {{lut.width(), lut.height(), 1}, {group, 1, 1}});
    device.read(packed.get(), 0, bytes, destination, blocking);
}

uint64_t countClipped(const Lut& lut) {
    if (lut.info().kind != PEL_LUT_CURVATURE) return 0;
    Device& device = lut.device();
    cl_uint count = 0;
    const cl::Memory counter = device.allocate(sizeof count, &count);
    constexpr size_t group = 64;
    cl::Launch launch(device.programs().get("lut/lut_encode.cl", {{"PEL_GROUP", std::to_string(group)}}),
                      "count_clipped");
    launch.arg(lut.layout()).arg(lut.texels()).arg(counter);
    device.launch(launch, {{lut.height(), 1, 1}, {group, 1, 1}});
    device.read(counter.get(), 0, sizeof count, &count, true);
    return count;
}

}  // namespace pel
