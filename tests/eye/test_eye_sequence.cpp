// One shader through a sequence of eyes and frames: each picture equals that of a new shader to the bit.
#include "eye/eye_frame.h"

using namespace pellucid;
using eye_test::EyeFrame;

namespace {

void unchanged(PelEye&) {}

// What a shader is set to; `apply` leaves nothing of an earlier state.
struct State {
    std::string name;
    std::function<void(PelEye&)> change = unchanged;
    size_t frame = 0;
    uint32_t texture = 0;                    // texels on a side; 0: none
    const Lut* caustics = nullptr;           // of the caller
    std::function<void(PelEye&)> wall = {};  // a second eye, of material 1
};

class Sequence {
  public:
    Sequence() {
        for (const auto& [width, height, pixel] :
             {std::tuple{96u, 64u, 0.5f}, {64u, 96u, 0.5f}, {40u, 24u, 1.2f}, {192u, 32u, 1.0f}})
            frames.push_back(
                std::make_unique<EyeFrame>(width, height, pixel, 0.5f * float(width), 0.5f * float(height)));
        for (const uint32_t side : {16u, 64u}) {
            std::vector<float> texels;
            for (uint32_t i = 0; i < side * side * 3; ++i) texels.push_back(float(i * 7919 % 97) / 97);
            textures.emplace_back(frames[0]->device, texels);
        }
    }
    std::vector<float> shade(const State& state, Shader& shader) {
        EyeFrame& frame = *frames[state.frame];
        frame.prepare(shader);
        PelEye eye = pelEyeDefaults();
        state.change(eye);
        shader.setEye(2, eye, state.caustics ? *state.caustics : Lut());
        if (state.texture)
            shader.setIrisTexture(
                2, imageDesc(textures[state.texture == 64], PEL_FORMAT_RGB32F, state.texture, state.texture));
        else
            shader.clearIrisTexture(2);
        if (state.wall) {
            PelEye second = pelEyeDefaults();
            state.wall(second);
            shader.setEye(1, second);
        } else {
            shader.clearEye(1);
        }
        return frame.execute(shader);
    }

    std::vector<std::unique_ptr<EyeFrame>> frames;
    std::vector<Buffer> textures;
};

}  // namespace

TEST(EyeSequence, TablesOfOtherEyesAreNamed) {
    Sequence sequence;
    const Device& device = sequence.frames[0]->device;
    const Profile skin = Profile::skin(), marble = Profile::named("marble");
    const auto warningsWith = [&](const PelEye& eye, const PelEyeLutDesc& table) {
        Shader shader(device);
        sequence.frames[0]->prepare(shader);
        shader.setEye(2, eye, Lut(device, table)).commit();
        return shader.warnings();
    };
    PelEye eye = pelEyeDefaults();
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    desc.width = 16, desc.height = 8, desc.depth = 12;
    EXPECT_EQ(warningsWith(eye, desc), "");
    desc.scleraRadius *= 10, desc.corneaRadius *= 10, desc.limbusRadius *= 10, desc.chamberDepth *= 10;
    EXPECT_EQ(warningsWith(eye, desc), "") << "lengths of another unit";
    eye.corneaRadius = 8.5f;
    EXPECT_EQ(warningsWith(eye, desc),
              "material 2 has the caustic table of another eye: corneaRadius is 7.8 in "
              "the table and 8.5 in the eye");
    desc.corneaRadius = 85;
    eye.irisConcavity = 0.3f;
    EXPECT_NE(warningsWith(eye, desc).find("irisConcavity is 0 in the table and 0.3"), std::string::npos);
    eye.irisConcavity = 0;
    eye.irisProfile = skin.get();
    EXPECT_EQ(warningsWith(eye, desc),
              "material 2 has an irisProfile without effect: its caustic table was made "
              "with \"none\" instead of \"skin\"");
    desc.profile = marble.get();
    EXPECT_NE(warningsWith(eye, desc).find("was made with \"marble\""), std::string::npos);
    desc.profile = skin.get();
    EXPECT_EQ(warningsWith(eye, desc), "");
}

TEST(EyeSequence, EqualsNewShaders) {
    Sequence sequence;
    const Device& device = sequence.frames[0]->device;
    const Profile skin = Profile::skin(), marble = Profile::named("marble");
    PelEyeLutDesc desc = pelEyeLutDescDefaults();
    desc.width = 16, desc.height = 8, desc.depth = 12;
    const Lut small(device, desc);
    desc.aqueousIndex = 1.2f, desc.width = 8, desc.height = 16;  // as many texels
    const Lut other(device, desc);

    std::vector<State> states;
    const auto add = [&](const State& state) { states.push_back(state); };
    // Every length and index from which the caustics follow, with the default eye between two changes.
    for (const auto& [name, field, value] : {std::tuple{"scleraRadius", &PelEye::scleraRadius, 11.0f},
                                             {"corneaRadius", &PelEye::corneaRadius, 7.5f},
                                             {"corneaConic", &PelEye::corneaConic, -0.6f},
                                             {"limbusRadius", &PelEye::limbusRadius, 5.6f},
                                             {"chamberDepth", &PelEye::chamberDepth, 3.4f},
                                             {"corneaIndex", &PelEye::corneaIndex, 1.5f},
                                             {"aqueousIndex", &PelEye::aqueousIndex, 1.2f},
                                             {"irisRadius", &PelEye::irisRadius, 5.4f},
                                             {"irisConcavity", &PelEye::irisConcavity, 0.6f}}) {
        states.push_back({name, [field = field, value = value](PelEye& e) { e.*field = value; }});
        add({"defaults"});
    }
    add({"moved", [](PelEye& e) { e.center[0] = 2, e.gaze[0] = 0.3f, e.gaze[2] = 0.9f; }});
    add({"pupil", [](PelEye& e) { e.pupilRadius = 3; }});
    add({"profile", [&](PelEye& e) { e.irisProfile = skin.get(); }});
    add({"other profile", [&](PelEye& e) { e.irisProfile = marble.get(); }});
    add({"no profile"});
    add({"table of the caller", unchanged, 0, 0, &small});
    add({"other table of the caller", unchanged, 0, 0, &other});
    add({"own table", unchanged, 1});
    add({"seed", [](PelEye& e) { e.irisSeed = 7; }, 1});
    add({"texture of 64", unchanged, 1, 64});
    add({"texture of 16", unchanged, 2, 16});
    add({"no texture", unchanged, 3});
    const auto skinned = [&](PelEye& e) { e.irisProfile = skin.get(); };
    add({"two eyes alike", unchanged, 0, 16, nullptr, unchanged});
    add({"two profiles", unchanged, 0, 0, nullptr, skinned});
    add({"profiles exchanged", skinned, 1, 0, nullptr, unchanged});
    add({"two shapes", [](PelEye& e) { e.corneaIndex = 1.5f; }, 2, 64, nullptr, unchanged});
    add({"one eye", unchanged, 0});

    Shader shader(device);
    std::vector<std::vector<float>> pictures;
    for (const State& state : states) {
        SCOPED_TRACE(state.name);
        Shader fresh(device);
        const std::vector<float> wanted = sequence.shade(state, fresh);
        const std::vector<float> picture = sequence.shade(state, shader);
        EXPECT_GT(sequence.frames[state.frame]->stats.pixelsCaustic, 0u);
        EXPECT_TRUE(picture == wanted) << "the picture depends on what was shaded before";
        if (!pictures.empty()) {
            EXPECT_TRUE(picture != pictures.back()) << "a state like the one before tests nothing";
        }
        pictures.push_back(picture);
    }
}

// With a region, memory that is too long is kept, and the next irises lie elsewhere in it.
TEST(EyeSequence, IrisesInKeptMemory) {
    Sequence sequence;
    EyeFrame& frame = *sequence.frames[0];
    Shader shader(frame.device);
    frame.prepare(shader);
    PelShaderOptions options = pelShaderOptionsDefaults();
    options.regionWidth = frame.width, options.regionHeight = frame.height;
    shader.set(options).setEye(2, pelEyeDefaults());
    const auto withWall = [&] {
        shader.setEye(1, pelEyeDefaults())
            .setIrisTexture(1, imageDesc(sequence.textures[0], PEL_FORMAT_RGB32F, 16, 16));
        return frame.execute(shader);
    };
    const std::vector<float> both = withWall();
    shader.clearEye(1);
    frame.execute(shader);
    EXPECT_TRUE(withWall() == both);
}

// Tables one after another on one device equal the same tables in the reverse order.
TEST(EyeSequence, TablesInAnyOrder) {
    const Profile skin = Profile::skin();
    std::vector<PelEyeLutDesc> descs;
    for (int i = 0; i < 6; ++i) {
        PelEyeLutDesc desc = pelEyeLutDescDefaults();
        desc.width = i % 2 ? 16 : 24, desc.height = i % 2 ? 24 : 16, desc.depth = 6;
        desc.irisRadius = i < 3 ? 6.0f : 5.0f;
        desc.profile = i % 3 == 2 ? skin.get() : nullptr;
        descs.push_back(desc);
    }
    const Device device("");
    std::vector<std::vector<float>> forwards;
    for (const PelEyeLutDesc& desc : descs) forwards.push_back(Lut(device, desc).read<float>(PEL_LUT_FLOAT));
    for (size_t i = descs.size(); i-- > 0;)
        EXPECT_EQ(Lut(device, descs[i]).read<float>(PEL_LUT_FLOAT), forwards[i]) << i;
}
