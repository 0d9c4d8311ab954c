// A small G-buffer and its scene file for tests of `pellucid shade`.
#pragma once
#include <algorithm>
#include <cmath>

#include "cli_run.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

namespace shade_files {

inline constexpr int width = 12, height = 5;
inline const std::vector<std::string> normalNames = {"View.N.X", "View.N.Y", "View.N.Z"};
inline const std::vector<std::string> albedoNames = {"View.Col.R", "View.Col.G", "View.Col.B"};

class Shade : public CommandTest {
  protected:
    // Normals that turn from left to right, a background of two columns, one light from +z.
    void SetUp() override {
        CommandTest::SetUp();
        gbuffer_.width = width;
        gbuffer_.height = height;
        std::vector<float> normals, albedos, ids;
        for (int i = 0; i < width * height; ++i) {
            const float angle = 0.2f * static_cast<float>(i % width);
            normals.insert(normals.end(), {std::sin(angle), 0.0f, std::cos(angle)});
            albedos.insert(albedos.end(), {0.5f, 0.25f, 0.125f});
            ids.push_back(i % width < 2 ? 0.0f : 1.0f);
        }
        gbuffer_.addInterleaved(normalNames, normals);
        gbuffer_.addInterleaved(albedoNames, albedos, pellucid::io::ChannelType::Half);
        gbuffer_.addInterleaved(std::vector<std::string>{"View.Id.X"}, ids);
        pellucid::io::writeExr(path("g.exr"), gbuffer_);

        scene_.channels[PEL_SLOT_NORMAL_SHADING] = {"N.X", "N.Y", "N.Z"};
        scene_.channels[PEL_SLOT_ALBEDO] = albedoNames;
        scene_.channels[PEL_SLOT_MATERIAL] = {"Id.X"};
        scene_.materials.resize(1);
        scene_.lights.resize(1);
        const float color[3] = {2.0f, 1.0f, 0.5f};
        std::copy(color, color + 3, scene_.lights[0].light.color);
        pellucid::io::writeScene(path("s.toml"), scene_);
    }
    std::vector<std::string> command(const std::string& scene = "s.toml",
                                     const std::string& gbuffer = "g.exr") const {
        return {"shade", path(gbuffer), "--scene", path(scene), "-o", path("o.exr")};
    }

    pellucid::io::Image gbuffer_;
    pellucid::io::SceneFile scene_;
};

}  // namespace shade_files
