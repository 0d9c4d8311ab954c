// The additions of pellucid.hpp to the C interface: objects that it keeps alive, code that it does not
// compile, short forms, and messages that name the image.
#include "shading/shader_ready.h"

using namespace pellucid;
using shade_test::Ready;

namespace {

// A structure that refers to a temporary's handle must not come out of it.
static_assert(std::is_same_v<decltype(imageDesc(std::declval<Buffer>(), PEL_FORMAT_R32F, 1, 1)), OwnedImage>);
static_assert(
    std::is_same_v<decltype(imageDesc(std::declval<Buffer&>(), PEL_FORMAT_R32F, 1, 1)), PelImageDesc>);
static_assert(std::is_same_v<decltype(vertexView(std::declval<Buffer>(), 1)), OwnedVertices>);
static_assert(std::is_same_v<decltype(material(std::declval<Profile>(), {})), OwnedMaterial>);
static_assert(!std::is_constructible_v<PelImageDesc, OwnedImage> &&
              !std::is_assignable_v<PelImageDesc&, OwnedImage>);
static_assert(!std::is_assignable_v<PelVertexView&, OwnedVertices> &&
              !std::is_assignable_v<PelMaterial&, OwnedMaterial>);
template <class T>
concept LendsHandle = requires(T t) {
    std::forward<T>(t).get();
};
static_assert(LendsHandle<Profile&> && LendsHandle<const Lut&> && !LendsHandle<Profile> &&
              !LendsHandle<const Lut>);
template <class T>
concept LendsStruct = requires(T t) {
    *std::forward<T>(t);
};
static_assert(LendsStruct<const OwnedImage&> && !LendsStruct<OwnedImage>);

TEST(CppInterface, AnImageOfATemporaryKeepsItsBuffer) {
    const Device device;
    std::vector<float> memory(16, 0.5f);
    OwnedImage image = imageDesc(Buffer::fromHost(device, memory.data(), 64), PEL_FORMAT_R32F, 4, 4);
    const OwnedVertices vertices = vertexView(Buffer(device, memory), 5);
    size_t bytes = 0;
    ASSERT_EQ(pelBufferGetSize(image->buffer, &bytes), PEL_SUCCESS) << pelGetErrorMessage();
    EXPECT_EQ(bytes, 64u);
    EXPECT_EQ(pelBufferGetSize(vertices->buffer, &bytes), PEL_SUCCESS) << pelGetErrorMessage();
    const OwnedImage copy = image;
    image = imageDesc(Buffer(device, 4), PEL_FORMAT_R32F, 1, 1);
    EXPECT_EQ(pelBufferGetSize(copy->buffer, &bytes), PEL_SUCCESS) << pelGetErrorMessage();
    image->width = 2;
    expectRefused({"curvature", "ends at byte 8"}, [&] { Shader(device).set(PEL_SLOT_CURVATURE, image); });
    Shader(device).set(PEL_SLOT_CURVATURE, copy).set(PEL_SLOT_CURVATURE, &copy);
}

TEST(CppInterface, TheStandardDeviceAndNone) {
    const Device device, none(nullptr);
    EXPECT_TRUE(device);
    EXPECT_STREQ(device.info().name, Device("").info().name);
    EXPECT_FALSE(none);
    expectRefused({"PelDevice", "NULL"}, [&] { none.finish(); });
}

TEST(CppInterface, ShortFormsGiveTheSameBits) {
    std::vector<float> pictures[2];
    for (std::vector<float>& picture : pictures) {
        Ready r;
        const bool isShort = &picture == pictures;
        if (isShort) {
            r.shader.setMaterial(1, material(Profile::named("jade"), {0.2f, 0.5f, 0.3f}))
                .set(directionalLight({0, 3, 4}, {1, 2, 3}))
                .set(cameraAt({0, 0, 300}));
        } else {
            const Profile jade = Profile::named("jade");
            PelMaterial m = pelMaterialDefaults();
            m.profile = jade.get();
            m.albedo[0] = 0.2f, m.albedo[1] = 0.5f, m.albedo[2] = 0.3f;
            PelLight light = pelLightDefaults();
            light.toLight[0] = 0, light.toLight[1] = 0.6f, light.toLight[2] = 0.8f;
            light.color[0] = 1, light.color[1] = 2, light.color[2] = 3;
            PelCamera camera = pelCameraDefaults();
            camera.position[0] = camera.position[1] = 0, camera.position[2] = 300;
            r.shader.setMaterial(1, m).set(std::vector{light}).set(camera);
        }
        r.shader.commit().execute();
        picture = r.target.readAll<float>();
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    const PelLight lamp = pointLight({1, 2, 3}, {4, 5, 6});
    EXPECT_EQ(lamp.type, PEL_LIGHT_POINT);
    EXPECT_EQ(lamp.position[2], 3);
    EXPECT_EQ(lamp.color[0], 4);
    const PelLight bulb = sphereLight({1, 2, 3}, 7, {4, 5, 6});
    EXPECT_EQ(bulb.type, PEL_LIGHT_SPHERE);
    EXPECT_EQ(bulb.radius, 7);
    EXPECT_EQ(bulb.position[0], 1);
    const PelLight box = rectangleLight({1, 2, 3}, {7, 0, 0}, {0, 8, 0}, {4, 5, 6});
    EXPECT_EQ(box.type, PEL_LIGHT_RECTANGLE);
    EXPECT_EQ(box.halfWidth[0], 7);
    EXPECT_EQ(box.halfHeight[1], 8);
    EXPECT_EQ(box.color[2], 6);
}

TEST(CppInterface, EveryMessageNamesItsImage) {
    Ready r;
    r.shader.set(std::vector<PelLight>(3, directionalLight({0, 0, 1}, {1, 1, 1})));
    const Buffer buffer(device(), 64);
    const PelImageDesc good = imageDesc(buffer, PEL_FORMAT_R32F, 4, 4);
    PelImageDesc unset = good, unsized = good, small = good;
    unset.buffer = nullptr;
    unsized.structSize = 0;
    small.width = 5;
    const std::pair<PelImageDesc, const char*> faults[] = {
        {unset, "PelBuffer"}, {unsized, "structSize"}, {small, "ends at byte"}};
    for (const auto& fault : faults) {
        const PelImageDesc& desc = fault.first;
        const char* word = fault.second;
        expectRefused({word, "ambient occlusion"}, [&] { r.shader.set(PEL_SLOT_AMBIENT_OCCLUSION, desc); });
        expectRefused({word, "shadow map", "light 2"}, [&] { r.shader.set(2, PEL_LIGHT_SHADOW_MAP, desc); });
        expectRefused({word, "ambient cube"}, [&] { r.shader.setAmbientCube(desc); });
        expectRefused({word, "reflection cube"}, [&] { r.shader.setReflectionCube(desc); });
        expectRefused({word, "normal map 0"}, [&] { r.shader.setNormalMap(1, {desc}); });
        expectRefused({word, "scattered texture"}, [&] { r.shader.setScatteredTexture(1, desc); });
        r.shader.setEye(1, pelEyeDefaults());
        expectRefused({word, "iris texture"}, [&] { r.shader.setIrisTexture(1, desc); });
        expectRefused({word, "depth"}, [&] {
            screenCurvature(device(), pelScreenCurvatureParamsDefaults(), good, nullptr, desc, nullptr, good);
        });
        Scatter scatter(device());
        expectRefused({word, "scatter weight"}, [&] { scatter.set(PEL_SLOT_SCATTER_WEIGHT, desc); });
        expectRefused({word, "ids"},
                      [&] { scatter.execute(pelScatterParamsDefaults(), good, good, nullptr, desc, good); });
    }
    const uint32_t triangle[] = {0, 1, 2};
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    mesh.numVertices = 3, mesh.indices = triangle, mesh.numIndices = 3;
    const MeshTopology topology(device(), mesh);
    expectRefused({"positions", "PelBuffer"}, [&] {
        topology.curvature(pelCurvatureParamsDefaults(), PelVertexView{nullptr, 0, 0, 3},
                           vertexView(buffer, 3));
    });
}

}  // namespace
