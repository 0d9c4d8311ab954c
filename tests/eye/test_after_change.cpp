// The cost of a commit after lights and camera moved: no buffer is made and no image drawn again.
#include "cl/cl_spy.h"
#include "eye/eye_frame.h"

using namespace pellucid;

namespace {

struct Asked {
    uint64_t buffers, launches, fills, transfers, waits;
};

class AfterAChange : public testing::Test {
  protected:
    AfterAChange() {
        frame_.prepare(shader_);
        PelMaterial skin = pelMaterialDefaults();
        skin.profile = profile_.get();
        shader_.setMaterial(1, skin).setEye(2, pelEyeDefaults());
        const Buffer map(frame_.device, std::vector<float>(64 * 64, 0.5f));
        for (PelLight& l : lights_) {
            l.toLight[0] = &l == &lights_[0] ? 0.6f : -0.6f, l.toLight[2] = 0.8f;
            const float rows[16] = {0.01f, 0, 0, 0.5f, 0, 0.01f, 0, 0.5f, 0, 0, -0.005f, 0.5f, 0, 0, 0, 1};
            std::copy_n(rows, 16, l.worldToShadow);
            l.shadowDepthRange = 200;
        }
        shader_.set(lights_);
        for (uint32_t i = 0; i < lights_.size(); ++i)
            shader_.set(i, PEL_LIGHT_SHADOW_MAP, imageDesc(map, PEL_FORMAT_R32F, 64, 64));
        shader_.commit();
        for (int i = 0; i < 3; ++i) frame();
    }
    void frame() {
        const PelSubmit submit{nullptr, 0, nullptr};
        shader_.execute(&submit);
    }
    // Of `work` and the frame after it.
    template <class Work>
    Asked asked(const Work& work) {
        check(pelDeviceFinish(frame_.device.get()));
        const spy::Counts before = spy::counts();
        work();
        frame();
        const spy::Counts now = spy::counts();
        return {now.buffersMade - before.buffersMade, now.launches - before.launches,
                now.fills - before.fills, now.transfers - before.transfers, now.waits - before.waits};
    }

    eye_test::EyeFrame frame_;
    Profile profile_ = Profile::skin();
    std::vector<PelLight> lights_{2, pelLightDefaults()};
    Shader shader_{frame_.device};
};

}  // namespace

// If only numbers of a frame change, or the location of images, only constants are sent.
TEST_F(AfterAChange, TheNextFrameCostsWhatASteadyOneDoes) {
    const Asked steady = asked([] {});
    EXPECT_EQ(steady.transfers, 0u);
    const auto expectSteady = [&](const char* what, const std::function<void()>& change) {
        const Asked now = asked([&] {
            change();
            shader_.commit();
        });
        EXPECT_EQ(now.launches, steady.launches) << what;
        EXPECT_EQ(now.fills, steady.fills) << what;
        EXPECT_EQ(now.buffers, 0u) << what;
        EXPECT_EQ(now.waits, 0u) << what;
        EXPECT_LE(now.transfers, 6u) << what;  // blocks of constants; `all` changes each
    };
    PelCamera camera = pelCameraDefaults();
    PelEye eye = pelEyeDefaults();
    PelMaterial skin = pelMaterialDefaults();
    skin.profile = profile_.get();
    const auto turnLight = [&] {
        lights_[0].toLight[0] *= -1;
        lights_[0].color[1] += 1;
        lights_[0].worldToShadow[3] += 0.01f;
        shader_.set(lights_);
    };
    const auto moveCamera = [&] {
        camera.position[0] += 7, camera.position[2] = 200;
        shader_.set(camera);
    };
    const auto turnEye = [&] {
        eye.gaze[0] += 0.2f;
        shader_.setEye(2, eye);
    };
    expectSteady("nothing", [] {});
    expectSteady("light", turnLight);
    expectSteady("camera", moveCamera);
    expectSteady("eye", turnEye);
    expectSteady("material", [&] {
        skin.specular = 0.3f;
        shader_.setMaterial(1, skin);
    });
    expectSteady("ambient", [&] {
        PelAmbient ambient = pelAmbientDefaults();
        ambient.constant[0] = 0.3f;
        shader_.set(ambient);
    });
    const Buffer other(frame_.device, 12 * frame_.pixels());
    expectSteady("target", [&] { shader_.set(PEL_SLOT_RADIANCE, frame_.image(other)); });
    expectSteady("all", [&] {
        turnLight();
        moveCamera();
        turnEye();
    });
}
