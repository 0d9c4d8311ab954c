// A shader on which everything is set. Tests take something away or set it wrongly, and expect an error.
#pragma once
#include "shade_scene.h"
#include "test.h"

namespace shade_test {

struct Ready {
    Frame frame = randomFrame(1, 32, 16, 1);
    Shader shader{device()};
    Buffer target{device(), 32 * 16 * 12};
    Ready() {
        setFrame(device(), shader, frame, tables());
        shader.set(PEL_SLOT_RADIANCE, imageDesc(target, PEL_FORMAT_RGB32F, 32, 16));
    }
};

}  // namespace shade_test
