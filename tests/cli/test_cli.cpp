// The command line's contract: names, flags, exit codes, JSON on stdout and nothing else, no partial files,
// messages about wrong values. (The commands and options of the pages: docs/test_tree.py.)
#include "cli_shade.h"

using namespace pellucid;
using nlohmann::json;

namespace {

class Cli : public shade_files::Shade {
  protected:
    // Calls with every subcommand, by its words with a blank behind each, and what `describe` says of it.
    using Visit = std::function<void(const std::string&, const json&)>;
    void eachCommand(const Visit& visit) const { walk(done("describe").json(), "", visit); }

  private:
    static void walk(const json& app, const std::string& name, const Visit& visit) {
        visit(name, app);
        for (const json& sub : app.at("subcommands"))
            walk(sub, name + sub.at("name").get<std::string>() + " ", visit);
    }
};

struct Refusal {
    std::string line;
    int exitCode;
    const char *message, *environment = "";
};

const std::string unread = "shade a.exr --scene a.toml -o @a.exr ";  // wrong values are seen before files

const Refusal refusals[] = {
    {"", 2, "subcommand"},
    {"lut curvatur", 2,
     "no subcommand 'lut curvatur'; did you mean curvature? there are curvature, shadow, specular"},
    {"curvatur", 2, "curvatur"},
    {"shde", 2, "no subcommand 'shde'; did you mean shade?"},
    {"shade --exposre 2", 2, "pellucid shade has no '--exposre'; did you mean --exposure?"},
    {"devices --device 'no such device'", 4, "no such device"},
    {"devices", 4, "abacus", "PELLUCID_DEVICE=abacus"},
    {"lut curvature -o @l.npy", 4, "pocl-opencl-icd", "OCL_ICD_VENDORS=@folder"},  // no drivers at all
    {"view", 2, "cannot be started", "PELLUCID_PYTHON=@none"},
    {"lut curvature", 2, "--output"},
    {"lut curvature -o @l.npy --sise 8x8", 2, "pellucid lut curvature has no '--sise'; did you mean --size?"},
    {"lut curvature -o @l.png --encoding float", 2, "faceworks8"},
    {"lut curvature -o @l.npy --radius-min -1", 2, "radius"},
    {"lut curvature -o @l.npy --radius-min 9 --radius-max 3", 2, "radius"},
    {"lut curvature -o @l.npy --profile granite", 3, "granite"},
    {"lut shadow -o @l.npy --sharpening 0.5", 2, "sharpening"},
    {"lut shadow -o @l.npy --diffusion-radius -1", 2, "--diffusion-radius"},
    {"lut shadow -o @no/l.exr", 2, "no folder"},
    {"lut shadow -o @d.npy", 2, "is a folder"},
    {"lut eye -o @x.exr --size 64x64", 2, "64x64x32"},
    {"lut eye -o @x.exr --limbus-radius 12", 2, "limbusRadius"},
    {"curvature @m.off -o @c.obj", 2, ".npy, .ply"},
    {"curvature @m.off -o @no/such/c.npy", 2, "no folder"},
    {"curvature @m.off -o @c.npy --smooth -1", 2, "--smooth"},
    {"curvature @m.off -o @c.npy --estimator edge --quantity mean", 2, "tensor or quadric"},
    {"curvature @m.off -o @c.npy --weld -1", 2, "tolerance above 0"},
    {"curvature @m.off -o @c.npy --smooth-radius -1", 2, "--smooth-radius"},
    {"curvature @m.off -o @c.npy --smooth-crease 180.5", 2, "is not a number from 0 to 180"},
    {"curvature @m.off -o @c.npy --smooth-crease 30", 2, "--smooth-crease requires --smooth-radius"},
    {"curvature @m.off -o @c.npy --smooth-weights area", 2, "--smooth-weights requires --smooth-radius"},
    {"curvature @m.off -o @c.npy --weld 1e39", 2, "--weld 1e39"},
    {"curvature @m.off -o @c.npy --range 0 1", 2, "only --picture and a .ply have colours"},
    {"curvature @m.off -o @c.npy --scale nan", 2, "scale"},
    {"curvature @m.off -o @c.npy --picture @c.jpg", 2, ".png"},
    {"curvature @m.off -o @c.ply --range 2 1", 2, "lower one first"},
    {"curvature @m.off -o @c.ply --range 2", 2, "--range"},
    {"curvature -- @m.off -o @c.npy", 2, "pellucid curvature does not expect '-o'"},
    {"curvature @m.off -o @" + std::string(260, 'n') + ".npy", 2,
     "has a name of 264 bytes; its file system allows at most 255"},
    {"curvature @nan.off -o @c.npy", 3, "nan.off:4: "},
    {"compare @g.exr @g.exr --exposure nan", 2, "--exposure"},
    {"compare @g.exr @g.exr --exposure 2", 2, "--exposure requires --picture"},
    {"compare @g.exr @g.exr --light 1", 2, "--light requires --gbuffer"},
    {"compare @g.exr @g.exr --unit-mm 10", 2, "--unit-mm requires --gbuffer"},
    {"compare @g.exr @g.exr --scale-a inf", 2, "--scale-a"},
    {"compare @g.exr @g.exr --scale-b 0", 2, "--scale-b"},
    {"compare @g.exr @g.exr --scale-b 1e-50", 2, "--scale-b"},
    {"compare @g.exr @g.exr --max-rmse 1e39", 2, "--max-rmse"},
    {"curvature @none.off -o @c.npy", 3, "No such file"},
    {"profile show granite", 3, "granite"},
    {"profile fit skin --gaussians 13", 2, "'13' is not a whole number from 1 to 12"},
    {"shade @g.exr -o @o.exr", 2, "--scene"},
    {"shade @g.exr --scene @s.toml -o @no/o.exr", 2, "no folder"},
    {"shade @g.exr --scene @s.toml -o @./g.exr", 2, "would be lost"},
    {"shade @g.exr --scene @in.toml -o @in.exr", 2, "in.exr is one of the files that are read"},
    {"curvature @in.ply -o @in.ply", 2, "would be lost"},
    {"reference @m.off --scene @s.toml --gbuffer @g.exr -o @g.exr", 2, "would be lost"},
    {"compare @g.exr @in.png --picture @in.png", 2, "would be lost"},
    {"compare @g.exr @g.exr --second-half @in.png --picture @in.png", 2, "would be lost"},
    {"profile fit @in.toml -o @in.toml", 2, "would be lost"},
    {"shade @g.exr --scene @s.toml -o @o.exr --show diffuse", 2, "--picture"},
    {"shade @g.exr --scene @s.toml -o @o.exr --picture @p.exr", 2, ".png"},
    {"shade @g.exr --scene @s.toml -o @o.exr --picture @p.png --show final,nothing", 2, "show"},
    {"shade @g.exr --scene @s.toml -o @o.png --picture @p.png", 2, "-o is a picture already"},
    {"shade @none.exr --scene @s.toml -o @o.exr", 3, "none.exr: cannot be read"},
    {"shade @text.exr --scene @s.toml -o @o.exr", 3, "text.exr"},
    {"shade @cut.exr --scene @s.toml -o @o.exr", 3, "cut.exr"},
    {"shade @g.exr --scene @none.toml -o @o.exr", 3, "none.toml: cannot be read"},
    {"shade @g.exr --scene @bad.toml -o @o.exr", 3, "bad.toml:2: 'version' in the scene is a string"},
    {"warm-up @none.toml", 3, "none.toml"},
    {"warm-up --luts", 2, "PELLUCID_CACHE is \"perhaps\"; it must be on, off or auto",
     "PELLUCID_CACHE=perhaps"},
    {"warm-up --luts", 2, "PELLUCID_CACHE_MB is \"much\"",
     "PELLUCID_CACHE=on PELLUCID_CACHE_DIR=@folder PELLUCID_CACHE_MB=much"},
    {"demo @none.off -o @unmade", 3, "No such file"},
    {"demo @flat.OBJ -o @unmade", 3, "is flat along the axis"},
    {"demo @m.off -o @m.off", 2, "m.off"},
    {"demo @m.off -o @folder --size 0x0", 2, "--size"},
    {"bench --quick", 2, "-o is needed"},
    {"bench -o /proc/nowhere", 2, "/proc/nowhere"},
    {"bench compare @none.json @none.json", 3, "none.json: cannot be read"},
    {"bench compare @none.json @none.json -o @x.jpg", 2, ".html"},
    {"bench compare @a.json @a.json", 3, "not a report"},
    {"bench compare @b.json @b.json", 3, "incomplete report"},
};

}  // namespace

TEST_F(Cli, WrongUseAndBadInputAreRefused) {
    write("m.off", shade_files::octahedron());
    write("nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
    write("flat.OBJ", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    write("text.exr", "no image at all");
    const std::string whole = read(path("g.exr"));
    write("cut.exr", whole.substr(0, whole.size() - 30));
    for (const char* input : {"in.png", "in.ply", "in.exr"}) write(input, "");
    write("in.toml", "gbuffer = \"in.exr\"\n" + read(path("s.toml")));
    write("bad.toml", "# a scene\nversion = \"2\"\n");
    write("a.json", "{}");
    write("b.json", "{\"devices\":[{}]}");
    std::filesystem::create_directories(path("d.npy"));
    std::filesystem::create_directories(path("folder"));
    for (const Refusal& r : refusals) refused(r.line, r.exitCode, r.message, r.environment);
    EXPECT_FALSE(std::filesystem::exists(path("unmade")));
    for (const std::string size : {"8", "8x", "0x8", "-1x8", "8x8x8", "eight"})
        refused("lut curvature -o @l.npy --size=" + size, 2, "--size");
    refused("lut eye -o @l.npy --size 4294967304x8x4", 2, "--size");
    refused(unread + "--tonemap filmc", 2,
            "pellucid: --tonemap: there is no 'filmc'; did you mean filmic? there are soft, none, filmic, "
            "agx-like\n");
    refused(unread + "--tonemap 2", 2, "there is no '2'");
    refused(unread + "--outputs diffuse,speculr", 2, "there is no 'speculr'; did you mean specular?");
    refused(unread + "--exposure -1", 2, "--exposure: '-1' is not a number above 0\n");
    refused(unread + "--exposure 0", 2, "is not a number above 0");
    refused(unread + "--scratch-mib 1.5", 2,
            "--scratch-mib: '1.5' is not a whole number from 0 to 1073741824\n");
    // Capital letters are as good; what is missing next is the scene.
    refused(unread + "--tonemap filmic", 2, "--exposure and --tonemap: of pictures");
    refused(unread + "--exposure 2", 2, "--exposure and --tonemap: of pictures");
    refused(unread + "--picture @p.png --tonemap Filmic", 3, "a.toml: cannot be read");
    // The name of a file whose extension stands for no format is wrong use in every argument.
    write("a.foo", "");
    for (const char* line :
         {"curvature @a.foo -o @o.npy", "curvature @m.ply -o @a.foo",
          "curvature @m.ply -o @o.npy --picture @a.foo", "lut shadow -o @a.foo", "lut shadow --output=@a.foo",
          "profile plot skin -o @a.foo", "profile fit skin -o @a.foo",
          "shade @g.exr --scene @s.toml -o @a.foo", "shade @g.exr --scene @s.toml -o @o.exr --picture @a.foo",
          "demo @a.foo -o @folder", "import @a.foo -o @folder", "reference @a.foo --scene @s.toml -o @o.npy",
          "reference @m.ply --scene @s.toml -o @a.foo"})
        refused(line, 2, "a.foo: has the unknown extension '.foo'; known here: ");
}

TEST_F(Cli, DevicesAreListed) {
    const std::string text = done("devices").out;
    const json report = reportOf("devices --device 0");
    expectReport(report);
    EXPECT_EQ(report.at("default"), 0);
    const std::vector<PelDeviceInfo> devices = Device::all();
    ASSERT_EQ(report.at("devices").size(), devices.size());
    for (size_t i = 0; i < devices.size(); ++i) {
        const auto& d = report["devices"][i];
        EXPECT_EQ(d.at("name"), devices[i].name);
        EXPECT_EQ(d.at("compute_units"), devices[i].computeUnits);
        EXPECT_EQ(d.at("global_memory_bytes"), devices[i].globalMemoryBytes);
        EXPECT_TRUE(contains(text, devices[i].name));
        for (const char* key : {"version", "driver", "type", "platform", "preferred_float_width", "quirks"})
            EXPECT_TRUE(d.contains(key));
    }
}

// The viewer is part of the Python package: the command passes all arguments on.
TEST_F(Cli, ViewStartsThePython) {
    const std::string python = write("python", "#!/bin/sh\nprintf '%s\\n' \"$@\" | tail -n +7\n");
    std::filesystem::permissions(python, std::filesystem::perms::owner_all);
    for (const auto& [command, module] :
         {std::pair{"view", "pellucid.view\n"}, {"gallery", "pellucid.view.gallery\n"}}) {
        const std::string handed =
            done(std::string(command) + " --port 8351 head.obj --no-browser", "PELLUCID_PYTHON=@python").out;
        EXPECT_TRUE(contains(handed, module));
        EXPECT_TRUE(contains(handed, "--port\n8351\nhead.obj\n--no-browser\n"));
    }
}

// Every subcommand that has --device, by `describe`, opens that device.
TEST_F(Cli, EveryDeviceOptionIsHeard) {
    write("m.off", shade_files::octahedron());
    write("m.toml", "[[lut]]\nsize = 8\n");
    for (const char* folder : {"tables", "demo", "bench"}) std::filesystem::create_directories(path(folder));
    const std::map<std::string, const char*> rest = {
        {"devices ", ""},
        {"curvature ", "@m.off -o @o.npy"},
        {"lut curvature ", "-o @o.exr"},
        {"lut shadow ", "-o @o.exr"},
        {"lut specular ", "-o @o.exr"},
        {"lut eye ", "-o @o.exr"},
        {"warm-up ", ""},
        {"shade ", "--outputs diffuse @m.off --scene @m.off -o @o.exr"},
        {"reference ", "@m.off --scene @m.off -o @o.npy"},
        {"import ", "@none.glb -o @o"},
        {"batch ", "@m.toml -o @tables"},
        {"demo ", "-o @demo"},
        {"bench ", "-o @bench"},
        {"tune ", "-o @t.txt"}};
    size_t heard = 0;
    eachCommand([&](const std::string& name, const json& app) {
        for (const json& option : app.at("options")) {
            const auto names = option.at("names").get<std::vector<std::string>>();
            if (std::find(names.begin(), names.end(), "--device") == names.end()) continue;
            ASSERT_TRUE(rest.contains(name)) << name << "has --device: add it here";
            refused(name + "--device 'no such device' " + rest.at(name), 4, "no such device");
            ++heard;
        }
    });
    EXPECT_GE(heard, 8u);
}

// --help shows the words of `pellucid describe`, and nothing of CLI11's own notation.
TEST_F(Cli, HelpIsReadable) {
    for (const char* command : {"demo", "lut curvature", "bench", "shade"}) {
        const std::string help = done(std::string(command) + " --help").out;
        for (const char* notation : {"{", "INT", "FLOAT", "TEXT", "REQUIRED", "NONNEGATIVE", "]="})
            EXPECT_FALSE(contains(help, notation)) << command << ": " << notation << "\n" << help;
    }
    const std::string help = done("demo --help").out;
    for (const char* line :
         {"--smooth N (0 to 1000; default: 2)", "--device DEVICE", "--up auto|y|z (default: auto)",
          "--size SIZE (default: 1280x720)", "-o,--output PATH", "  --orient  "})
        EXPECT_TRUE(contains(help, line)) << line;
}

// Messages about wrong values, for every option of every subcommand that takes words or numbers in a range.
TEST_F(Cli, EveryOptionNamesWhatItTakes) {
    size_t options = 0;
    eachCommand([&](const std::string& command, const json& app) {
        for (const json& option : app.at("options")) {
            const auto words = option.at("completions").get<std::vector<std::string>>();
            const bool number = option.at("range") != "",
                       choice = !words.empty() && contains(option["value"], "|");
            if (option.at("names").empty() || !(number || choice)) continue;
            ++options;
            const std::string name = option["names"].back();
            SCOPED_TRACE(command + name);
            for (const char* given : {"somthing", "nan", "1e999"}) {
                const Result result = cli(command + name + " " + given);
                EXPECT_EQ(result.exitCode, 2) << result.err;
                EXPECT_TRUE(contains(result.err, "pellucid: " + name + ": "));
                EXPECT_TRUE(contains(result.err, choice ? "there is no '" : "' is not a "));
                EXPECT_LT(result.err.size(), 250u) << result.err;
                EXPECT_FALSE(contains(result.err, "->")) << result.err;
                for (const std::string& word : choice ? words : std::vector<std::string>()) {
                    EXPECT_TRUE(contains(result.err, word));
                }
            }
        }
    });
    EXPECT_GT(options, 30u);
}
