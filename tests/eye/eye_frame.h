// A frame with an eye: a wall of material 1 in which a ball of material 2 sits, seen along -z.
#pragma once
#include "test.h"

namespace eye_test {

class EyeFrame {
  public:
    static constexpr float ballRadius = 12, rimRadius = 11;  // mm; of the ball, and of its circle in the wall

    // `pixel`: its side in mm. The axis of the ball passes through (centerX, centerY).
    explicit EyeFrame(uint32_t frameWidth = 512, uint32_t frameHeight = 256, float pixel = 0.25f,
                      float centerX = 400, float centerY = 128, const pellucid::Device& on = sharedDevice())
        : width(frameWidth),
          height(frameHeight),
          device(on),
          pixel_(pixel),
          centerX_(centerX),
          centerY_(centerY) {
        std::vector<float> position, normal;
        std::vector<uint8_t> id;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const float px = pixel * (float(x) - centerX), py = pixel * (centerY - float(y));
                const bool ball = isEye(size_t(y) * width + x);
                const float pz = ball ? std::sqrt(ballRadius * ballRadius - px * px - py * py) : 4.8f,
                            length = ball ? ballRadius : 1;
                for (const float c : {px, py, pz}) position.push_back(c);
                for (const float c : {ball ? px : 0.0f, ball ? py : 0.0f, ball ? pz : 1.0f})
                    normal.push_back(c / length);
                id.push_back(ball ? 2 : 1);
            }
        positions_ = pellucid::Buffer(device, position), normals_ = pellucid::Buffer(device, normal),
        ids_ = pellucid::Buffer(device, id);
        out_ = pellucid::Buffer(device, std::vector<float>(3 * pixels()));
    }

    // Materials, camera, images and one light.
    void prepare(pellucid::Shader& shader, PelTileLists lists = PEL_TILES_ONE_LIST) const {
        PelMaterial wall = pelMaterialDefaults(), sclera = pelMaterialDefaults();
        wall.specular = 1;
        wall.scattering = sclera.scattering = PEL_SCATTERING_NONE;
        PelShaderOptions options = pelShaderOptionsDefaults();
        options.tileLists = lists;
        options.countPixels = 1;
        PelCamera camera = pelCameraDefaults();
        camera.position[2] = 300;
        PelLight light = pelLightDefaults();
        light.toLight[0] = 0.6f, light.toLight[2] = 0.8f;
        shader.set(options).set(camera).set(std::vector{light}).setMaterial(1, wall).setMaterial(2, sclera);
        shader.set(PEL_SLOT_RADIANCE, image(out_));
        shader.set(PEL_SLOT_POSITION, image(positions_));
        shader.set(PEL_SLOT_NORMAL_SHADING, image(normals_));
        shader.set(PEL_SLOT_MATERIAL, pellucid::imageDesc(ids_, PEL_FORMAT_R8_UINT, width, height));
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
        const float px = pixel_ * (float(at % width) - centerX_);
        const float py = pixel_ * (centerY_ - float(at / width));
        return px * px + py * py < rimRadius * rimRadius;
    }
    size_t pixels() const { return size_t(width) * height; }

    const uint32_t width, height;
    const pellucid::Device device;
    PelShaderStats stats{};

  private:
    static const pellucid::Device& sharedDevice() {
        static const pellucid::Device device("");
        return device;
    }
    const float pixel_, centerX_, centerY_;
    pellucid::Buffer positions_, normals_, ids_, out_;
};

}  // namespace eye_test
