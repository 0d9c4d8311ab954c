// A frame with an eye: a wall of material 1 in which a ball of material 2 sits, seen along -z.
#pragma once
#include "shading/shade_scene.h"
#include "test.h"

namespace eye_test {

class EyeFrame {
  public:
    static constexpr float ballRadius = 12, rimRadius = 11;  // mm; of the ball, and of its circle in the wall

    // `pixel`: its side in mm. The axis of the ball passes through (centerX, centerY).
    explicit EyeFrame(uint32_t frameWidth = 512, uint32_t frameHeight = 256, float pixel = 0.25f,
                      float centerX = 400, float centerY = 128, const pellucid::Device& on = ::device())
        : width(frameWidth),
          height(frameHeight),
          device(on),
          pixel_(pixel),
          centerX_(centerX),
          centerY_(centerY) {
        frame_.width = width, frame_.height = height;
        auto& position = frame_.slots[PEL_SLOT_POSITION] = {3, {}};
        auto& normal = frame_.slots[PEL_SLOT_NORMAL_SHADING] = {3, {}};
        auto& id = frame_.slots[PEL_SLOT_MATERIAL] = {1, {}};
        for (size_t i = 0; i < pixels(); ++i) {
            const reference::Vec3 p = place(i);
            const bool ball = isEye(i);
            position.push(ball ? p : reference::Vec3{p.x, p.y, 4.8});
            normal.push(ball ? normalized(p) : reference::Vec3{0, 0, 1});
            id.values.push_back(ball ? 2 : 1);
        }
        frame_.options = pelShaderOptionsDefaults();
        frame_.options.countPixels = 1;
        frame_.camera = pellucid::cameraAt({0, 0, 300});
        frame_.lights.push_back({pellucid::directionalLight({0.6f, 0, 0.8f}, {1, 1, 1})});
        for (const uint32_t material : {1, 2}) {
            frame_.materials[material] = pelMaterialDefaults();
            frame_.materials[material].scattering = PEL_SCATTERING_NONE;
        }
        frame_.materials[1].specular = 1;
        frame_.curvatureLut = frame_.shadowLut = false;
        out_ = pellucid::Buffer(device, std::vector<float>(3 * pixels()));
    }

    // Materials, camera, images and one light.
    void prepare(pellucid::Shader& shader, PelTileLists lists = PEL_TILES_ONE_LIST) {
        frame_.options.tileLists = lists;
        setFrame(device, shader, frame_, {});
        shader.set(PEL_SLOT_RADIANCE, image(out_));
    }
    PelImageDesc image(const pellucid::Buffer& rgb) const {
        return pellucid::imageDesc(rgb, PEL_FORMAT_RGB32F, width, height);
    }
    std::vector<float> execute(pellucid::Shader& shader) {
        shader.commit().execute();
        stats = shader.stats();
        return out_.readAll<float>();
    }
    // Shades with a new shader, which `change` may modify before the commit.
    std::vector<float> shade(const std::function<void(pellucid::Shader&)>& change = {},
                             PelTileLists lists = PEL_TILES_ONE_LIST) {
        pellucid::Shader shader(device);
        prepare(shader, lists);
        if (change) change(shader);
        return execute(shader);
    }
    bool isEye(size_t at) const {
        const reference::Vec3 p = place(at);
        return p.x * p.x + p.y * p.y < rimRadius * rimRadius;
    }
    size_t pixels() const { return size_t(width) * height; }

    const uint32_t width, height;
    const pellucid::Device device;
    PelShaderStats stats{};

  private:
    // On the ball; NaN along z beside it.
    reference::Vec3 place(size_t at) const {
        const double x = pixel_ * (float(at % width) - centerX_), y = pixel_ * (centerY_ - float(at / width));
        return {x, y, std::sqrt(ballRadius * ballRadius - x * x - y * y)};
    }
    const float pixel_, centerX_, centerY_;
    shade_test::Frame frame_;
    pellucid::Buffer out_;
};

}  // namespace eye_test
