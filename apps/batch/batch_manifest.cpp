#include "batch/batch_manifest.h"

#include <algorithm>
#include <filesystem>

#include "io/content_hash.h"
#include "io/lut/lut_describe.h"
#include "io/lut/lut_preset.h"
#include "io/lut/profile_file.h"
#include "io/shortest.h"
#include "io/toml_reader.h"

namespace pellucid::io {
namespace {

// In memory an entry takes about a kilobyte.
constexpr size_t mostEntries = 1'000'000, mostProfileBytes = size_t{64} << 20;
constexpr uint32_t mostStacked = 4096;  // tables of a file

constexpr std::string_view encodingNames[] = {"float", "half"};  // PelLutEncoding

struct Size {
    uint32_t width, height;  // texels
    std::string text() const { return width == height ? std::to_string(width) : concat(width, "x", height); }
};

// What a [[lut]] or [[grid]] table contains; a grid has several values in some lists.
struct Request {
    std::string name;  // of the file; in a grid with {key} in it, such as "{profile}-{size}"
    PelLutKind kind = PEL_LUT_CURVATURE;
    std::vector<std::string> profiles{"skin"}, forms, axes, encodings{"half"};
    std::vector<float> radii{0};           // diffusion radii, mm; 0: the profile's own
    std::map<std::string, PelSkin> skins;  // of those profiles that are computed
    std::vector<Size> sizes;
    uint32_t stack = 1;  // tables of a file
    PelCurvatureLutDesc curvature;
    PelShadowLutDesc shadow;
};

template <size_t N>
uint32_t indexOf(const TomlReader& reader, const char* key, const std::string& value,
                 const std::string_view (&names)[N]) {
    const auto found = std::ranges::find(names, value);
    if (found != std::end(names)) return uint32_t(found - names);
    std::string known;
    for (const std::string_view name : names) known.append(known.empty() ? "" : ", ").append(name);
    reader.fail(key, "holds '" + value + "'; one of " + known + " would be right");
}

// Every combination of the skin's fields, as a profile each: "skin-0.05-0.02-0.75".
void readSkins(TomlReader& reader, Request& r) {
    const PelSkin skin = pelSkinDefaults();
    std::vector<float> melanin{skin.melanin}, blood{skin.blood}, oxygenation{skin.oxygenation};
    const char* const keys[] = {"melanin", "blood", "oxygenation"};
    const auto given = std::ranges::find_if(keys, [&](const char* key) { return reader.has(key); });
    reader.list("melanin", melanin, range::skin::melanin);
    reader.list("blood", blood, range::skin::blood);
    reader.list("oxygenation", oxygenation, range::skin::oxygenation);
    if (given == std::end(keys)) return;
    if (reader.has("profile")) reader.fail("profile", std::string("cannot stand beside '") + *given + "'");
    const double count = double(melanin.size()) * double(blood.size()) * double(oxygenation.size());
    if (count > double(mostEntries))
        reader.fail(*given, "asks for more skins than a manifest may have tables");
    r.profiles.clear();
    for (const float m : melanin)
        for (const float b : blood)
            for (const float o : oxygenation) {
                PelSkin& made = r.skins["skin-" + shortest(m) + "-" + shortest(b) + "-" + shortest(o)] = skin;
                made.melanin = m;
                made.blood = b;
                made.oxygenation = o;
            }
    for (const auto& [name, unused] : r.skins) r.profiles.push_back(name);
}

Request readRequest(TomlReader& reader, LutPreset preset) {
    Request r;
    reader.choice("kind", r.kind, lutKinds);
    // Version 1 ignored the axis of shadow tables.
    const bool ownAxis = r.kind == PEL_LUT_SHADOW && preset == LutPreset::faceworks && !reader.has("preset");
    reader.choice("preset", preset, lutPresets);
    r.curvature = presetCurvature(preset);
    r.shadow = presetShadow(preset);
    const bool isShadow = r.kind == PEL_LUT_SHADOW;
    r.forms = {std::string(curvatureForms[r.curvature.form])};
    r.axes = {std::string(lutAxes[isShadow ? r.shadow.axis : r.curvature.axis])};
    if (r.kind == PEL_LUT_EYE)
        reader.fail("kind", "is 'eye', which batches cannot make; use `pellucid lut eye`");
    reader.text("name", r.name);
    if (r.name.empty() && reader.has("name"))
        reader.fail("name", "is empty; leave it out for a name by content");
    reader.list("profile", r.profiles);
    readSkins(reader, r);
    reader.list("form", r.forms);
    if (isShadow) r.forms = {""};
    std::vector<std::string> axes = r.axes;
    reader.list("axis", axes);
    if (!ownAxis) r.axes = axes;
    reader.list("encoding", r.encodings);
    reader.list("diffusion_radius", r.radii, range::positive);
    if (r.kind == PEL_LUT_SPECULAR) {  // which depends on none of these
        r.profiles = r.forms = r.axes = {""};
        r.radii = {0};
    }
    std::vector<float> sides;
    reader.list("size", sides, range::atLeastOne);
    for (float side : sides) {
        if (side > 16384 || side != float(uint32_t(side)))
            reader.fail("size", "holds a side that is not a whole number from 1 to 16384");
        r.sizes.push_back({uint32_t(side), uint32_t(side)});
    }
    const PelSpecularLutDesc specular = pelSpecularLutDescDefaults();
    if (!reader.has("size"))
        r.sizes = {isShadow                      ? Size{r.shadow.width, r.shadow.height}
                   : r.kind == PEL_LUT_CURVATURE ? Size{r.curvature.width, r.curvature.height}
                                                 : Size{specular.width, specular.height}};
    reader.integer("stack", r.stack, {1, mostStacked});
    if (r.stack > 1 && r.kind == PEL_LUT_SPECULAR)
        reader.fail("stack", "is for tables that differ, but specular tables of one size are all the same");
    if (r.stack > 1 && !r.name.empty())
        reader.fail("name", "cannot stand beside 'stack', whose files are named by their content");
    reader.number("radius_min", r.curvature.radiusMin, range::curvatureLut::radiusMin);
    reader.number("radius_max", r.curvature.radiusMax, range::curvatureLut::radiusMax);
    reader.number("width_min", r.shadow.widthMin, range::shadowLut::widthMin);
    reader.number("width_max", r.shadow.widthMax, range::shadowLut::widthMax);
    reader.number("sharpening", r.shadow.sharpening, range::atLeastOne);
    reader.integer("closed_ends", r.shadow.closedEnds, range::shadowLut::closedEnds);
    const auto reversed = [](float least, float most) { return most != 0 && least > most; };
    if (r.kind == PEL_LUT_CURVATURE && reversed(r.curvature.radiusMin, r.curvature.radiusMax))
        reader.fail("radius_min", "is greater than radius_max");
    if (isShadow && reversed(r.shadow.widthMin, r.shadow.widthMax))
        reader.fail("width_min", "is greater than width_max");
    return r;
}

// Floats by their bits, so that equal keys mean equal requests.
struct Key {
    std::ostringstream out;
    Key() {
        out.imbue(std::locale::classic());
        out << std::hexfloat;
    }
    template <class T>
    Key& operator()(const char* name, const T& value) {
        out << name << '=' << value << ';';
        return *this;
    }
};

class Expansion {
  public:
    // `folder`: where profile files are; if empty, the manifest has them already.
    Expansion(BatchManifest& manifest, std::optional<std::filesystem::path> folder)
        : manifest_(manifest), folder_(std::move(folder)) {}

    void add(TomlReader& reader, LutPreset preset) {
        Request r = readRequest(reader, preset);
        stack_ = {};  // of an entry that failed
        skins_.insert(r.skins.begin(), r.skins.end());
        reader.finish();  // an unknown key makes the entry an error before any table is taken from it
        refuseTooMany(reader, r);
        if (r.kind != PEL_LUT_SPECULAR && r.stack <= 1) leaveOutProfiles(reader, r);
        for (const std::string& encoding : r.encodings)
            for (const Size& size : r.sizes) {
                for (const std::string& profile : r.profiles)
                    for (float radius : r.radii)
                        for (const std::string& form : r.forms)
                            for (const std::string& axis : r.axes)
                                addOne(reader, r, encoding, size, profile, form, axis, radius);
                finishStack(reader, r);
            }
    }

  private:
    // A profile and its part of the key: its numbers or its file's content, not only its name, since a
    // changed file is another request.
    struct Known {
        std::shared_future<Profile> profile;
        std::string key;
    };

    // Reports the profiles that are wrong, so that those beside them still get their tables.
    void leaveOutProfiles(const TomlReader& reader, Request& r) {
        const size_t each =
            r.encodings.size() * r.sizes.size() * r.radii.size() * r.forms.size() * r.axes.size();
        std::erase_if(r.profiles, [&](const std::string& name) {
            try {
                profile(reader, name);
                return false;
            } catch (const FileError& e) {
                manifest_.errors.push_back({e.line(), e.what(), each});
                return true;
            }
        });
    }

    // Checked before expansion: the product of five short lists can exceed the memory.
    void refuseTooMany(const TomlReader& reader, const Request& r) {
        const double asked = double(r.encodings.size()) * double(r.sizes.size()) * double(r.profiles.size()) *
                             double(r.radii.size()) * double(r.forms.size()) * double(r.axes.size());
        if (asked_ + asked > double(mostEntries))
            reader.fail("size",
                        concat("asks for ", printed("%.0f", asked),
                               " tables; a manifest may ask for at most ", mostEntries, " in all; split it"));
        asked_ += asked;
    }

    const Known& profile(const TomlReader& reader, const std::string& name) {
        auto [at, fresh] = known_.try_emplace(name);
        const auto skin = skins_.find(name);
        if (fresh && skin != skins_.end()) {
            // Made when a table needs it, by the thread that makes the table.
            at->second.profile = std::async(std::launch::deferred, [name, pigments = skin->second] {
                Profile made = Profile::skinLayers(pigments);
                made.setName(name);
                return made;
            });
            Key key;
#define ADD(type, field, ...) key(#field, pigments.field);
            const PelSkin& pigments = skin->second;
            PEL_EACH_SKIN_FIELD(ADD)
#undef ADD
            at->second.key = key.out.str();
        } else if (fresh)
            try {
                std::promise<Profile> loaded;
                at->second.profile = loaded.get_future();
                loaded.set_value(load(name));
                const Profile& p = at->second.profile.get();
                const PelProfileInfo info = p.info();
                Key key;
                key("profile", info.name)("radius", info.radius);
                if (const auto text = manifest_.profiles.find(name); text != manifest_.profiles.end()) {
                    key("file", hexDigits(contentHash(text->second)));
                } else {
                    std::vector<double> distances;
                    for (double f : {0.01, 0.03, 0.1, 0.3, 0.7, 1.0, 1.5, 2.0, 3.0})
                        distances.push_back(f * info.radius);
                    for (double value : p.radial(distances)) key("R", float(value));
                }
                at->second.key = key.out.str();
            } catch (const FileError& e) {
                known_.erase(at);
                reader.fail("profile", std::string("is refused: ") + e.what());
            }
        return at->second;
    }

    Profile load(const std::string& name) {
        if (extensionOf(name) != "toml") return findProfile(name).profile;
        if (folder_) {
            std::string text = readWholeFile((*folder_ / name).string(), textLimit);
            profileBytes_ += text.size();
            if (profileBytes_ > mostProfileBytes)
                throw FileError(name, concat("makes the profile files of this manifest more than ",
                                             mostProfileBytes, " bytes; split the manifest"));
            manifest_.profiles[name] = std::move(text);
        }
        const auto at = manifest_.profiles.find(name);
        if (at == manifest_.profiles.end()) throw FileError(name, "was not sent along with the manifest");
        return parseProfile(name, at->second).profile;
    }

    void addOne(const TomlReader& reader, const Request& r, const std::string& encoding, const Size& size,
                const std::string& profileName, const std::string& form, const std::string& axis,
                float radius) {
        BatchEntry entry{{{pelLutInfoDefaults(), {}}}, {}, {}, {}, {}, reader.line()};
        BatchTable& table = entry.tables.front();
        table.info.kind = r.kind;
        entry.encoding = PelLutEncoding(indexOf(reader, "encoding", encoding, encodingNames));
        Key key;
        key("kind", lutKinds[r.kind])("version", pelVersion())("encoding", encoding)("size", size.text());
        if (r.kind != PEL_LUT_SPECULAR) {
            const Known& known = profile(reader, profileName);
            table.profile = known.profile;
            key.out << known.key;
            key("diffusion_radius", radius);
        }
        const auto fill = [&](auto& desc, const auto& given) {
            desc = given;
            desc.width = size.width, desc.height = size.height;
            desc.axis = PelLutAxis(indexOf(reader, "axis", axis, lutAxes));
            desc.diffusionRadius = radius;
        };
        if (r.kind == PEL_LUT_CURVATURE) {
            PelCurvatureLutDesc& desc = table.info.curvature;
            fill(desc, r.curvature);
            desc.form = PelCurvatureForm(indexOf(reader, "form", form, curvatureForms));
            key("form", form)("axis", axis)("radius_min", desc.radiusMin)("radius_max", desc.radiusMax);
        } else if (r.kind == PEL_LUT_SHADOW) {
            PelShadowLutDesc& desc = table.info.shadow;
            fill(desc, r.shadow);
            key("width_min", desc.widthMin)("width_max", desc.widthMax)("sharpening", desc.sharpening);
            // Left out of the key at their values of version 1, so that older files keep their names.
            if (desc.axis != PEL_AXIS_LINEAR) key("axis", axis);
            if (desc.closedEnds) key("closed_ends", 1);
        } else {
            table.info.specular.width = size.width, table.info.specular.height = size.height;
        }
        entry.key = key.out.str();
        if (r.stack > 1) {
            if (stack_.tables.empty()) {
                stack_ = std::move(entry);
            } else {
                stack_.tables.push_back(std::move(table));
                stack_.key += entry.key;
            }
            if (stack_.tables.size() == r.stack) finishStack(reader, r);
            return;
        }
        if (!r.name.empty()) {
            entry.name = namedBy(reader, r,
                                 {{"kind", std::string(lutKinds[r.kind])},
                                  {"profile", extensionOf(profileName) == "toml"
                                                  ? std::filesystem::path(profileName).stem().string()
                                                  : profileName},
                                  {"form", form},
                                  {"axis", axis},
                                  {"size", size.text()},
                                  {"encoding", encoding},
                                  {"diffusion_radius", radius > 0 ? shortest(radius) : "own"}});
            entry.file = entry.name + ".exr";
        }
        addFile(reader, r, std::move(entry));
    }

    // Long keys are replaced by their hash.
    void finishStack(const TomlReader& reader, const Request& r) {
        if (stack_.tables.empty()) return;
        stack_.key =
            concat("stack=", stack_.tables.size(), ";keys=", hexDigits(contentHash(stack_.key)), ";");
        addFile(reader, r, std::exchange(stack_, {}));
    }

    void addFile(const TomlReader& reader, const Request& r, BatchEntry entry) {
        if (entry.name.empty())
            entry.file = std::string(lutKinds[r.kind]) + "-" + hexDigits(contentHash(entry.key)) + ".exr";
        const auto [other, fresh] = files_.try_emplace(entry.file, manifest_.entries.size());
        if (fresh) {
            manifest_.entries.push_back(std::move(entry));
            return;
        }
        const BatchEntry& first = manifest_.entries[other->second];
        if (first.key != entry.key)
            reader.fail("name",
                        "gives two tables the file " + entry.file +
                            (first.line == entry.line ? "; put what differs into it, such as {size}"
                                                      : concat("; the one of line ", first.line, " has it")));
        ++manifest_.duplicates;
    }

    // r.name with each {key} replaced by its value.
    static std::string namedBy(const TomlReader& reader, const Request& r,
                               const std::map<std::string, std::string>& values) {
        std::string name = r.name;
        for (size_t open = 0; (open = name.find('{', open)) != std::string::npos;) {
            const size_t close = name.find('}', open), length = std::min(close, name.size()) - open;
            const auto value =
                close == std::string::npos ? values.end() : values.find(name.substr(open + 1, length - 1));
            if (value == values.end()) {
                std::string known;
                for (const auto& [key, unused] : values) known += (known.empty() ? "{" : ", {") + key + "}";
                reader.fail("name", "holds '" + name.substr(open, length + 1) + "'; one of " + known +
                                        " would be right");
            }
            name.replace(open, length + 1, value->second);
            open += value->second.size();
        }
        constexpr std::string_view allowed =
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.+";
        const size_t wrong = name.find_first_not_of(allowed);
        if (wrong != std::string::npos || name.empty() || name[0] == '.' || name[0] == '-' ||
            name.size() > 200)
            reader.fail("name", "is '" + name +
                                    "'; up to 200 letters of A to Z, digits and - _ . +, not "
                                    "beginning with . or -, are possible");
        return name;
    }

    BatchManifest& manifest_;
    std::optional<std::filesystem::path> folder_;
    std::map<std::string, Known> known_;
    std::map<std::string, PelSkin> skins_;
    std::map<std::string, size_t> files_;  // to the entry
    BatchEntry stack_{};                   // not yet full
    double asked_ = 0;                     // tables, including repeated ones
    size_t profileBytes_ = 0;
};

BatchManifest expanded(const std::string& path, BatchManifest manifest,
                       std::optional<std::filesystem::path> folder) {
    const auto root = parseToml(path, manifest.text);
    Expansion expansion(manifest, std::move(folder));
    TomlReader reader(path, *root, "the manifest");
    const LutPreset preset = presetOfVersion(reader.version(lutPresetVersions));
    for (const char* name : {"lut", "grid"})
        reader.tablesApart(
            name, [&](TomlReader& entry) { expansion.add(entry, preset); },
            [&](const FileError& e) {
                manifest.errors.push_back({e.line(), e.what()});
            });
    reader.finish();
    if (manifest.entries.empty() && manifest.errors.empty())
        throw FileError(path, "lists no tables; [[lut]] and [[grid]] would be right");
    return manifest;
}

}  // namespace

BatchManifest readManifest(const std::string& path) {
    BatchManifest manifest;
    manifest.text = readWholeFile(path, textLimit);
    return expanded(path, std::move(manifest), std::filesystem::path(path).parent_path());
}

BatchManifest parseManifest(const std::string& path, const std::string& text,
                            const std::map<std::string, std::string>& profiles) {
    BatchManifest manifest;
    manifest.text = text;
    manifest.profiles = profiles;
    return expanded(path, std::move(manifest), {});
}

}  // namespace pellucid::io
