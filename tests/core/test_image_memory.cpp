// Where images lie: end to end in one buffer, on each other, and in two buffers over the same memory.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <pellucid/pellucid.hpp>

using namespace pellucid;

namespace {

constexpr uint32_t width = 37, height = 13, pixels = width * height;

const Device& device() {
    static const Device device("");
    return device;
}

PelImageDesc image(const Buffer& buffer, PelFormat format, uint64_t offset, uint64_t rowStride = 0) {
    PelImageDesc desc = imageDesc(buffer, format, width, height, offset);
    desc.rowStride = rowStride;
    return desc;
}

// Ambient light alone: radiance = albedo * constant, so that each pixel says where it was read and written.
struct Pass {
    Shader shader{device()};
    std::vector<uint8_t> ids = std::vector<uint8_t>(pixels, 1);
    Buffer idBuffer{device(), ids};

    Pass() {
        PelMaterial material = pelMaterialDefaults();
        shader.setMaterial(1, material);
        PelAmbient ambient = pelAmbientDefaults();
        for (float& c : ambient.constant) c = 1;
        shader.set(ambient);
        shader.set(PEL_SLOT_MATERIAL, image(idBuffer, PEL_FORMAT_R8_UINT, 0));
    }
    PelError shade(const PelImageDesc& normals, const PelImageDesc& albedo, const PelImageDesc& radiance) {
        try {
            shader.set(PEL_SLOT_NORMAL_SHADING, normals)
                .set(PEL_SLOT_ALBEDO, albedo)
                .set(PEL_SLOT_RADIANCE, radiance);
            shader.commit().execute();
        } catch (const Error& e) {
            return e.code();
        }
        return PEL_SUCCESS;
    }
};

float albedoAt(uint32_t i, uint32_t c) {
    return 0.25f + float(i % 64) / 128 + float(c) / 8;
}

std::vector<float> inputs() {  // normals, then albedo, RGB float32 each
    std::vector<float> values(2 * 3 * pixels);
    for (uint32_t i = 0; i < pixels; ++i) {
        values[3 * i + 2] = 1;
        for (uint32_t c = 0; c < 3; ++c) values[3 * (pixels + i) + c] = albedoAt(i, c);
    }
    return values;
}

constexpr uint64_t imageBytes = 3ull * pixels * sizeof(float);

}  // namespace

TEST(ImageMemory, EndToEndInOneBuffer) {
    for (const int order : {0, 1}) {  // the output behind the inputs, and before them
        std::vector<float> all(3 * 3 * pixels, -1);
        const std::vector<float> in = inputs();
        const uint64_t first = order == 0 ? 0 : imageBytes, target = order == 0 ? 2 * imageBytes : 0;
        std::memcpy(all.data() + first / 4, in.data(), in.size() * sizeof(float));
        const Buffer buffer(device(), all);
        Pass pass;
        ASSERT_EQ(pass.shade(image(buffer, PEL_FORMAT_RGB32F, first),
                             image(buffer, PEL_FORMAT_RGB32F, first + imageBytes),
                             image(buffer, PEL_FORMAT_RGB32F, target)),
                  PEL_SUCCESS)
            << pelGetErrorMessage();
        const std::vector<float> out = buffer.readAll<float>();
        EXPECT_EQ(std::memcmp(out.data() + first / 4, in.data(), in.size() * sizeof(float)), 0)
            << "an input was written";
        for (uint32_t i = 0; i < pixels; ++i)
            for (uint32_t c = 0; c < 3; ++c)
                ASSERT_NEAR(out[target / 4 + 3 * i + c], albedoAt(i, c), 1e-6) << i;
        // One row too early or late, and they do overlap.
        const uint64_t row = width * 12ull;
        EXPECT_EQ(pass.shade(image(buffer, PEL_FORMAT_RGB32F, first),
                             image(buffer, PEL_FORMAT_RGB32F, first + imageBytes),
                             image(buffer, PEL_FORMAT_RGB32F, order == 0 ? target - row : target + row)),
                  PEL_ERROR_INVALID_ARGUMENT);
    }
}

TEST(ImageMemory, TwoBuffersOverTheSameHostMemory) {
    std::vector<float> memory(3 * 3 * pixels + 1024);
    const std::vector<float> in = inputs();
    std::memcpy(memory.data(), in.data(), in.size() * sizeof(float));
    const Buffer whole = Buffer::fromHost(device(), memory.data(), 3 * imageBytes);
    const Buffer same = Buffer::fromHost(device(), memory.data(), 3 * imageBytes);
    const Buffer tail = Buffer::fromHost(device(), memory.data() + 2 * imageBytes / 4, imageBytes);
    const Buffer albedoTail = Buffer::fromHost(device(), memory.data() + imageBytes / 4, imageBytes);
    const auto rgb = [](const Buffer& b, uint64_t offset) { return image(b, PEL_FORMAT_RGB32F, offset); };
    Pass pass;
    // The output lies beside the inputs, whichever buffer it is seen through.
    for (const PelImageDesc& target : {rgb(whole, 2 * imageBytes), rgb(same, 2 * imageBytes), rgb(tail, 0)})
        EXPECT_EQ(pass.shade(rgb(whole, 0), rgb(whole, imageBytes), target), PEL_SUCCESS)
            << pelGetErrorMessage();
    // On an input, through another buffer: partly, wholly, and with its last row alone.
    const uint64_t row = width * 12ull;
    for (const PelImageDesc& target : {rgb(same, imageBytes), rgb(same, imageBytes + row),
                                       rgb(same, 2 * imageBytes - row), rgb(albedoTail, 0)}) {
        EXPECT_EQ(pass.shade(rgb(whole, 0), rgb(whole, imageBytes), target), PEL_ERROR_INVALID_ARGUMENT);
        EXPECT_NE(std::strstr(pelGetErrorMessage(), "overlap"), nullptr) << pelGetErrorMessage();
    }
    // Any number of inputs may share memory.
    EXPECT_EQ(pass.shade(rgb(same, 0), rgb(albedoTail, 0), rgb(whole, 2 * imageBytes)), PEL_SUCCESS)
        << pelGetErrorMessage();
}

TEST(ImageMemory, TheCallersClMemInTwoBuffers) {
    const std::vector<float> in = inputs();
    std::vector<float> all(3 * 3 * pixels);
    std::memcpy(all.data(), in.data(), in.size() * sizeof(float));
    const Buffer first(device(), all);
    void* memory = nullptr;
    check(pelBufferGetCl(first.get(), &memory));
    const Buffer second = Buffer::fromCl(device(), memory);
    Pass pass;
    const auto rgb = [](const Buffer& b, uint64_t offset) { return image(b, PEL_FORMAT_RGB32F, offset); };
    EXPECT_EQ(pass.shade(rgb(first, 0), rgb(first, imageBytes), rgb(second, 2 * imageBytes)), PEL_SUCCESS);
    EXPECT_EQ(pass.shade(rgb(first, 0), rgb(first, imageBytes), rgb(second, 2 * imageBytes - 12)),
              PEL_ERROR_INVALID_ARGUMENT);
}

// planeStride 0 is height * rowStride, padding included.
TEST(ImageMemory, PlanesOfPaddedRows) {
    const uint64_t rowStride = (width + 5) * sizeof(float), plane = rowStride * height;
    const std::vector<float> in = inputs();
    const Buffer normals(device(), std::vector<float>(in.begin(), in.begin() + 3 * pixels));
    std::vector<float> planes(3 * plane / sizeof(float), -3);
    const auto at = [&](uint32_t i, uint32_t c) {
        return (c * plane + i / width * rowStride) / sizeof(float) + i % width;
    };
    for (uint32_t i = 0; i < pixels; ++i)
        for (uint32_t c = 0; c < 3; ++c) planes[at(i, c)] = albedoAt(i, c);
    const Buffer albedo(device(), planes), radiance(device(), std::vector<float>(planes.size(), -7));
    Pass pass;
    ASSERT_EQ(pass.shade(image(normals, PEL_FORMAT_RGB32F, 0),
                         image(albedo, PEL_FORMAT_PLANAR_RGB32F, 0, rowStride),
                         image(radiance, PEL_FORMAT_PLANAR_RGB32F, 0, rowStride)),
              PEL_SUCCESS)
        << pelGetErrorMessage();
    std::vector<float> right(planes.size(), -7);
    for (uint32_t i = 0; i < pixels; ++i)
        for (uint32_t c = 0; c < 3; ++c) right[at(i, c)] = albedoAt(i, c);
    const std::vector<float> out = radiance.readAll<float>();
    for (size_t i = 0; i < out.size(); ++i) ASSERT_NEAR(out[i], right[i], 1e-6) << i;
    // One byte less is too small: the last plane ends with the last pixel of its last row.
    const uint64_t needed = 2 * plane + (height - 1) * rowStride + width * sizeof(float);
    const Buffer enough(device(), needed), less(device(), needed - 4);
    EXPECT_EQ(pass.shade(image(normals, PEL_FORMAT_RGB32F, 0),
                         image(albedo, PEL_FORMAT_PLANAR_RGB32F, 0, rowStride),
                         image(enough, PEL_FORMAT_PLANAR_RGB32F, 0, rowStride)),
              PEL_SUCCESS);
    EXPECT_EQ(pass.shade(image(normals, PEL_FORMAT_RGB32F, 0),
                         image(albedo, PEL_FORMAT_PLANAR_RGB32F, 0, rowStride),
                         image(less, PEL_FORMAT_PLANAR_RGB32F, 0, rowStride)),
              PEL_ERROR_INVALID_ARGUMENT);
}
