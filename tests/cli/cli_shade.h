// A small G-buffer and its scene file for tests of `pellucid shade`, and small meshes.
#pragma once
#include "cli_run.h"
#include "io/image/image_file.h"
#include "io/scene/scene_file.h"

namespace shade_files {

inline constexpr int width = 12, height = 5;
using Names = std::vector<std::string>;
inline const Names normalNames = {"View.N.X", "View.N.Y", "View.N.Z"};
inline const Names albedoNames = {"View.Col.R", "View.Col.G", "View.Col.B"};
inline const Names positionNames = {"P.X", "P.Y", "P.Z"}, colorNames = {"R", "G", "B"};

// Channels whose values follow from column, row and number of the channel.
template <class Value>
void addChannels(pellucid::io::Image& image, const Names& names, const Value& value) {
    std::vector<float> values;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (size_t c = 0; c < names.size(); ++c) values.push_back(float(value(x, y, c)));
    image.addInterleaved(names, values);
}

template <class Value>
pellucid::io::Image imageOf(int across, int down, const Names& names, const Value& value) {
    pellucid::io::Image image;
    image.width = across, image.height = down;
    addChannels(image, names, value);
    return image;
}

class Shade : public CommandTest {
  protected:
    // Normals that turn from left to right, a background of two columns, one light from +z.
    void SetUp() override {
        CommandTest::SetUp();
        gbuffer_.width = width;
        gbuffer_.height = height;
        addChannels(gbuffer_, normalNames, [](int x, int, size_t c) {
            return c == 1 ? 0.0f : c ? std::cos(0.2f * float(x)) : std::sin(0.2f * float(x));
        });
        std::vector<float> albedos;
        for (int i = 0; i < width * height; ++i) albedos.insert(albedos.end(), {0.5f, 0.25f, 0.125f});
        gbuffer_.addInterleaved(albedoNames, albedos, pellucid::io::ChannelType::Half);
        addChannels(gbuffer_, {"View.Id.X"}, [](int x, int, size_t) { return x >= 2; });
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
    // What `pellucid shade` makes of the scene and the G-buffer as they are now.
    std::vector<float> shaded(const std::string& more = "") {
        pellucid::io::writeExr(path("g.exr"), gbuffer_);
        pellucid::io::writeScene(path("s.toml"), scene_);
        said_ = done(shade_ + " --json " + more);
        return pellucid::io::readImage(path("o.exr")).interleaved(colorNames);
    }
    // Expects an error for them.
    void refuses(const std::string& message, const std::string& more = "") {
        std::filesystem::remove(path("o.exr"));
        pellucid::io::writeExr(path("g.exr"), gbuffer_);
        pellucid::io::writeScene(path("s.toml"), scene_);
        refused(shade_ + " " + more, 3, message);
    }
    std::vector<float> channel(const std::string& file, const std::string& name) const {
        return pellucid::io::readImage(path(file)).channel(name).pixels;
    }

    const std::string shade_ = "shade @g.exr --scene @s.toml -o @o.exr";
    pellucid::io::Image gbuffer_;
    pellucid::io::SceneFile scene_;
    Result said_{};
};

// A regular octahedron of radius 2, faces outwards: its vertex normals are radial by symmetry.
inline std::string octahedron(const std::string& moreVertices = "", const std::string& moreFaces = "",
                              const std::string& counts = "6 8") {
    return "OFF\n" + counts + " 0\n2 0 0\n-2 0 0\n0 2 0\n0 -2 0\n0 0 2\n0 0 -2\n" + moreVertices +
           "3 0 2 4\n3 2 1 4\n3 1 3 4\n3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n" + moreFaces;
}

}  // namespace shade_files
