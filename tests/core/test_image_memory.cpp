// Where images lie: end to end in one buffer, on each other, and in two buffers over the same memory.
#include "test.h"

using namespace pellucid;

namespace {

constexpr uint32_t width = 37, height = 13, pixels = width * height;
constexpr uint64_t imageBytes = 3ull * pixels * sizeof(float), row = width * 12ull;

PelImageDesc rgb(const Buffer& buffer, uint64_t offset) {
    return imageDesc(buffer, PEL_FORMAT_RGB32F, width, height, offset);
}

// Ambient light alone: radiance = albedo * constant, so that each pixel says where it was read and written.
struct Pass {
    Shader shader{device()};
    Buffer ids{device(), std::vector<uint8_t>(pixels, 1)};

    Pass() {
        shader.setMaterial(1, pelMaterialDefaults());
        PelAmbient ambient = pelAmbientDefaults();
        std::fill_n(ambient.constant, 3, 1.0f);
        shader.set(ambient).set(PEL_SLOT_MATERIAL, imageDesc(ids, PEL_FORMAT_R8_UINT, width, height));
    }
    void shade(const PelImageDesc& normals, const PelImageDesc& albedo, const PelImageDesc& radiance) {
        shader.set(PEL_SLOT_NORMAL_SHADING, normals)
            .set(PEL_SLOT_ALBEDO, albedo)
            .set(PEL_SLOT_RADIANCE, radiance);
        shader.commit().execute();
    }
    void refuse(const PelImageDesc& normals, const PelImageDesc& albedo, const PelImageDesc& radiance,
                const char* word = "overlap") {
        expectRefused(word, [&] { shade(normals, albedo, radiance); });
    }
};

float albedoAt(uint32_t i, uint32_t c) {
    return 0.25f + float(i % 64) / 128 + float(c) / 8;
}

// Normals, then albedo, then room for a third image, RGB float32 each, from `first` on.
std::vector<float> inputs(uint64_t first = 0) {
    std::vector<float> values(3 * 3 * pixels, -1);
    std::fill_n(values.begin() + long(first / 4), 3 * pixels, 0.0f);
    for (uint32_t i = 0; i < pixels; ++i) {
        values[first / 4 + 3 * i + 2] = 1;
        for (uint32_t c = 0; c < 3; ++c) values[first / 4 + 3 * (pixels + i) + c] = albedoAt(i, c);
    }
    return values;
}

}  // namespace

TEST(ImageMemory, EndToEndInOneBuffer) {
    for (const bool behind : {true, false}) {  // the output behind the inputs, and before them
        const uint64_t first = behind ? 0 : imageBytes, target = behind ? 2 * imageBytes : 0;
        std::vector<float> expected = inputs(first);
        const Buffer buffer(device(), expected);
        Pass pass;
        pass.shade(rgb(buffer, first), rgb(buffer, first + imageBytes), rgb(buffer, target));
        for (uint32_t i = 0; i < 3 * pixels; ++i) expected[target / 4 + i] = albedoAt(i / 3, i % 3);
        const std::vector<float> out = buffer.readAll<float>();
        for (size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], expected[i], 1e-6) << i;
        // One row too early or late, and they do overlap.
        pass.refuse(rgb(buffer, first), rgb(buffer, first + imageBytes),
                    rgb(buffer, behind ? target - row : target + row));
    }
}

TEST(ImageMemory, TwoBuffersOverTheSameHostMemory) {
    std::vector<float> memory = inputs();
    const Buffer whole = Buffer::fromHost(device(), memory.data(), 3 * imageBytes);
    const Buffer same = Buffer::fromHost(device(), memory.data(), 3 * imageBytes);
    const Buffer tail = Buffer::fromHost(device(), memory.data() + 2 * imageBytes / 4, imageBytes);
    const Buffer albedoTail = Buffer::fromHost(device(), memory.data() + imageBytes / 4, imageBytes);
    Pass pass;
    // The output lies beside the inputs, whichever buffer it is seen through.
    for (const PelImageDesc& target : {rgb(whole, 2 * imageBytes), rgb(same, 2 * imageBytes), rgb(tail, 0)})
        pass.shade(rgb(whole, 0), rgb(whole, imageBytes), target);
    // On an input, through another buffer: partly, wholly, and with its last row alone.
    for (const PelImageDesc& target : {rgb(same, imageBytes), rgb(same, imageBytes + row),
                                       rgb(same, 2 * imageBytes - row), rgb(albedoTail, 0)})
        pass.refuse(rgb(whole, 0), rgb(whole, imageBytes), target);
    // Any number of inputs may share memory.
    pass.shade(rgb(same, 0), rgb(albedoTail, 0), rgb(whole, 2 * imageBytes));
}

TEST(ImageMemory, TheCallersClMemInTwoBuffers) {
    const Buffer first(device(), inputs());
    void* memory = nullptr;
    check(pelBufferGetCl(first.get(), &memory));
    const Buffer second = Buffer::fromCl(device(), memory);
    Pass pass;
    pass.shade(rgb(first, 0), rgb(first, imageBytes), rgb(second, 2 * imageBytes));
    pass.refuse(rgb(first, 0), rgb(first, imageBytes), rgb(second, 2 * imageBytes - 12));
}

// planeStride 0 is height * rowStride, padding included.
TEST(ImageMemory, PlanesOfPaddedRows) {
    const uint64_t rowStride = (width + 5) * sizeof(float), plane = rowStride * height;
    const auto planar = [&](const Buffer& buffer) {
        PelImageDesc desc = imageDesc(buffer, PEL_FORMAT_PLANAR_RGB32F, width, height);
        desc.rowStride = rowStride;
        return desc;
    };
    std::vector<float> planes(3 * plane / sizeof(float), -3);
    for (uint32_t i = 0; i < pixels; ++i)
        for (uint32_t c = 0; c < 3; ++c)
            planes[(c * plane + i / width * rowStride) / sizeof(float) + i % width] = albedoAt(i, c);
    const Buffer normals(device(), inputs()), albedo(device(), planes),
        radiance(device(), std::vector<float>(planes.size(), -3));
    Pass pass;
    pass.shade(rgb(normals, 0), planar(albedo), planar(radiance));
    const std::vector<float> out = radiance.readAll<float>();
    for (size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], planes[i], 1e-6) << i;
    // One byte less is too small: the last plane ends with the last pixel of its last row.
    const uint64_t needed = 2 * plane + (height - 1) * rowStride + width * sizeof(float);
    const Buffer enough(device(), needed), less(device(), needed - 4);
    pass.shade(rgb(normals, 0), planar(albedo), planar(enough));
    pass.refuse(rgb(normals, 0), planar(albedo), planar(less), "ends at byte");
}
