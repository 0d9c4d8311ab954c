// Blender for the tests: `blender`, or what PELLUCID_BLENDER names, such as blender_module with PyPI's bpy.
#pragma once
#include "test.h"

#include "io/image/image_file.h"

namespace blender {

inline std::string command() {
    const char* named = std::getenv("PELLUCID_BLENDER");
    return named && *named ? named : "blender";
}

inline bool installed() {
    return std::system(("command -v '" + command() + "' >/dev/null").c_str()) == 0;
}

// A pass of one channel. Blender 5 writes full names ("Material Index"), older ones short names ("IndexMA").
inline const std::vector<float>& pass(const pellucid::io::Image& image, const std::string& full,
                                      const std::string& older) {
    for (const auto& channel : image.channels)
        if (channel.name.find(full + ".X") != std::string::npos) return channel.pixels;
    return image.channel(older + ".X").pixels;
}

}  // namespace blender
