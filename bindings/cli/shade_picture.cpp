#include "shade_picture.h"

#include <algorithm>

#include "io/image/picture.h"
#include "io/scene/scene_keys.h"

namespace pellucid::cli {
namespace {

constexpr float longest = 30;  // mm of thickness; hardly anything comes through more of skin

}  // namespace

std::vector<std::string> showableParts() {
    std::vector<std::string> parts{"final"};
    for (const io::OutputKey& output : io::outputKeys) parts.emplace_back(output.key);
    return parts;
}

PelImageSlot slotOfPart(const std::string& part) {
    for (const io::OutputKey& output : io::outputKeys)
        if (part == output.key) return output.slot;
    return PEL_SLOT_RADIANCE;
}

void writeShadePicture(const std::string& path, const io::Image& gbuffer, const io::SceneFrame& frame,
                       const std::vector<std::string>& parts, const io::ToneMap& tone) {
    std::vector<io::Tile> tiles;
    for (const std::string& part : parts) {
        const PelImageSlot slot = slotOfPart(part);
        if (slot == PEL_SLOT_OUT_THICKNESS) {
            const std::vector<float> lengths = frame.output(slot);
            const io::Picture map = io::colored(gbuffer.width, gbuffer.height, lengths, 0, longest, lengths);
            tiles.push_back({part, io::withColorBar(map, 0, longest, "length", 1)});
        } else {
            tiles.push_back({part, io::Picture(gbuffer.width, gbuffer.height,
                                               io::toSrgb8(slot == PEL_SLOT_RADIANCE ? frame.radiance()
                                                                                     : frame.output(slot),
                                                           tone))});
        }
    }
    const io::Picture whole =
        tiles.size() == 1 ? tiles[0].picture : io::contactSheet(tiles, int(tiles.size()));
    io::writeImage8(path, whole.width, whole.height, 3, whole.rgb);
}

void addToneOptions(Command& command, io::ToneMap& tone) {
    command.addOption("--exposure", tone.exposure, "of pictures: multiplies radiance")
        ->check(isPositive())
        ->showDefault();
    command
        .addOptionOf(
            "--tonemap",
            [&tone](const std::string& curve) { tone.curve = chosen<io::ToneCurve>(io::toneCurves, curve); },
            "of pictures: soft (true to radiance up to 0.8, then a shoulder), none (cut at 1), "
            "filmic or agx-like "
            "(default: soft)")
        ->check(isOneOf(io::toneCurves));
}

}  // namespace pellucid::cli
