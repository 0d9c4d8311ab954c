// The head of the demo: one of the two that come with the project, or a mesh of the user.
#pragma once
#include "io/mesh/mesh_file.h"
#include "io/scene/scene_file.h"
#include "sample/camera.h"
#include "sample/look.h"

namespace pellucid::demo {

// Material ids of the demo.
enum DemoMaterial : uint32_t {
    DEMO_SKIN = 1,
    DEMO_EYES = 2,
    DEMO_TEETH = 3,
    DEMO_TONGUE = 4,
    DEMO_CUT = 5,
    DEMO_RIGHT_EYE = 6,
    DEMO_LASHES = 7  // before an eye, in G-buffers alone
};

// A hair: points from root to tip, mm, and the radius at the root, from which it tapers.
struct Strand {
    std::vector<sample::Vec3> points;
    double radius;
    sample::Vec3 normal{0, 0, 1};  // unit, of the skin at the root
};

// Where hair grows.
struct Scalp {
    sample::Vec3 betweenEyes;
    double eyeDistance = 0;
    sample::Bounds skin;

    // How far `p` is from the hairline, over the distance between the eyes; negative on face, neck and ears.
    double above(sample::Vec3 p) const;
    // How dense and long hair is there: 0 to 1.
    double cover(sample::Vec3 p) const;
};

struct DemoHead {
    io::MeshData mesh;                    // mm
    std::vector<float> cornerUvs;         // u, v per corner of the triangles, which io::splitAtSeams takes
    std::vector<uint32_t> materials;      // DemoMaterial per triangle; empty: all skin
    std::vector<sample::Look> looks;      // of the ids 1, 2, ...
    std::vector<sample::SkinZone> zones;  // lips, cheeks, ears, nose
    std::vector<Strand> strands;          // by strandsOf in demo_hair.h
    std::vector<sample::EyeLook> eyes;    // their whites
    std::vector<io::SceneEye> eyeModels;  // the same as PelEye, around DEMO_EYES and DEMO_RIGHT_EYE
    Scalp scalp;                          // of a head with two eyes
    sample::HeadPose pose;
    bool bust = false;     // of one smooth material, eyes too
    sample::Bounds frame;  // what the picture shows: a neck that was cut off is left out
};

// The head without eyes, hair and colours.
DemoHead bustOf(DemoHead head);

// `levels`: Catmull-Clark.
DemoHead loadDemoHead(const std::string& path, int levels);
// True if `path` is an OBJ file with a part "skin".
bool hasHeadParts(const std::string& path);

}  // namespace pellucid::demo
