// Unchanged shadow maps (PelLight.shadowMapVersion): data computed only from the maps are made once for all
// frames and shaders, and no bit changes.
#include "scattering_frame.h"
#include "test.h"

using namespace shade_test;

namespace {

// Tables with a wide shadow that is filtered from the map, and thickness from cells of taps.
Frame viewFrame() {
    Frame f = scatteringFrame(PEL_SCATTERING_PREINTEGRATED, 192, 96);
    f.options.everyPixel = 0;
    for (auto& [id, m] : f.materials) {
        std::fill_n(m.deepScatterColor, 3, 0.5f);
        m.thicknessFilterRadius = 0.2f;  // so few nodes that the frame has cells
    }
    return f;
}

class KeptMaps : public testing::Test {
  protected:
    Frame frame_ = viewFrame();
    Buffer map_{device(), frame_.lights[0].map.values};
    PelImageDesc image_ = imageDesc(map_, PEL_FORMAT_R32F, 64, 64);

    // One view of the scene, and what its frames take.
    struct View {
        Shader shader{device()};
        Buffer target;
        std::vector<float> picture() const { return target.readAll<float>(); }
        uint64_t launches() {
            const uint64_t before = device().stats().launches;
            shader.execute();
            return device().stats().launches - before;
        }
        PelPassMemory memory(const char* pass) const {
            for (const PelPassMemory& m : shader.memory())
                if (std::string_view(m.name) == pass) return m;
            return pelPassMemoryDefaults();
        }
    };
    // side: of the camera.
    void set(View& view, uint32_t version, float side) {
        Frame f = frame_;
        f.camera.position[0] = side;
        f.lights[0].params.shadowMapVersion = version;
        setFrame(device(), view.shader, f, tables());
        view.target = setTarget(device(), view.shader, f);
        image_.buffer = map_.get();
        view.shader.set(0, PEL_LIGHT_SHADOW_MAP, image_);
        view.shader.commit();
    }
    std::vector<float> alone(float side) {
        View view;
        set(view, 0, side);
        view.shader.execute();
        return view.picture();
    }
};

TEST_F(KeptMaps, AreMadeOnceForTwoViews) {
    View moving, left, right;
    set(moving, 0, -5);
    set(left, 1, -5);
    set(right, 1, 5);
    warmUpPrograms(device(), 0, {left.shader});
    const uint64_t all = moving.launches();
    EXPECT_EQ(left.launches(), all);
    EXPECT_EQ(right.launches(), all - 3) << "neither bounds nor samples nor cells of taps";
    EXPECT_EQ(left.launches(), all - 3);
    EXPECT_EQ(moving.launches(), all);
    for (const char* pass : {"shadow_bounds", "tap_cells"}) {
        const PelPassMemory first = left.memory(pass), second = right.memory(pass);
        EXPECT_GT(first.held, 0u) << pass;
        EXPECT_EQ(first.needed, first.held) << pass;
        EXPECT_EQ(second.held, 0u) << pass;
        EXPECT_EQ(second.needed, first.needed) << pass;
    }
    expectSameBits(device(), left.picture(), alone(-5));
    expectSameBits(device(), right.picture(), alone(5));
    // The first shader's data outlive it, and another version is computed anew.
    left.shader = Shader(device());
    EXPECT_EQ(right.launches(), all - 3);
    set(right, 2, 5);
    EXPECT_EQ(right.launches(), all);
    EXPECT_GT(right.memory("tap_cells").held, 0u);
    set(moving, 3, -5);
    set(right, 3, 5);
    EXPECT_EQ(right.memory("tap_cells").held, 0u);
}

TEST_F(KeptMaps, RestTogetherOrNotAtAll) {
    frame_.lights.push_back(frame_.lights[0]);
    frame_.lights[1].params.shadowMapVersion = 1;
    View view;
    set(view, 0, -5);
    const uint64_t all = view.launches();
    EXPECT_EQ(view.launches(), all);
    set(view, 1, -5);
    view.shader.execute();
    EXPECT_LT(view.launches(), all);
}

TEST_F(KeptMaps, OfAViewOfNothingAreThoseOfAll) {
    const Frame whole = frame_;
    frame_.slots[PEL_SLOT_MATERIAL].components = 1;
    frame_.slots[PEL_SLOT_MATERIAL].values.assign(frame_.pixels(), 0);
    View nothing, second;
    set(nothing, 1, -5);
    nothing.shader.execute();
    frame_ = whole;
    set(second, 1, -5);
    second.shader.execute();
    expectSameBits(device(), second.picture(), alone(-5));
}

TEST_F(KeptMaps, CellsOfTapsBelongToAFilter) {
    View first, second;
    set(first, 1, -5);
    const uint64_t all = first.launches();
    for (auto& [id, m] : frame_.materials) m.thicknessFilterRadius = 0.4f;
    set(second, 1, -5);
    EXPECT_EQ(second.launches(), all - 1) << "bounds";
    expectSameBits(device(), second.picture(), alone(-5));
}

// Another map, the same map read in another way under the same number, or other content under another number,
// one after the other.
TEST_F(KeptMaps, OfOtherMapsAreOthers) {
    PelLight& light = frame_.lights[0].params;
    uint32_t version = 1;
    const std::function<void()> changes[] = {
        [] {},
        [&] {
            std::vector<float>& depths = frame_.lights[0].map.values;
            for (float& z : depths) z = z < 0.3f ? 0.5f : z;
            map_ = Buffer(device(), depths);
        },
        [&] {
            std::vector<float>& depths = frame_.lights[0].map.values;
            for (size_t i = 0; i < depths.size(); ++i)
                if (i % 64 < 20) depths[i] = 0.2f;
            map_.write(depths.data(), depths.size() * sizeof(float));
            version = 2;
        },
        [&] { light.shadowDepthRange = 90; },
        [&] { light.worldToShadow[3] += 0.1f; },
        [&] { image_.byteOffset = 8 * image_.rowStride, image_.height -= 8; },
        [&] { light.shadowContent = PEL_SHADOW_CONTENT_EXPONENTIAL, light.shadowExponent = 20; },
        [&] { light.shadowExponent = 30; },
        [&] { light.shadowContent = PEL_SHADOW_CONTENT_DEPTH; },
        [&] { image_.format = PEL_FORMAT_R16_UNORM; },
        [&] {
            light.shadowProjection = PEL_SHADOW_PERSPECTIVE, light.shadowDepthA = -0.01f;
            std::copy_n(light.worldToShadow + 8, 4, light.worldToShadow + 12);
            light.worldToShadow[15] += 1;
        },
        [&] { light.shadowDepthA = -0.02f; },
        [&] { light.shadowDepthB = 0.05f; },
    };
    std::vector<View> views(std::size(changes));
    for (size_t i = 0; i < views.size(); ++i) {
        SCOPED_TRACE(i);
        changes[i]();
        View fresh;
        set(fresh, 0, -5);
        set(views[i], version, -5);
        EXPECT_EQ(views[i].launches(), fresh.launches()) << "made anew";
        expectSameBits(device(), views[i].picture(), fresh.picture());
    }
}

}  // namespace
