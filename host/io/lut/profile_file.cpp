#include "io/lut/profile_file.h"

#include "io/choice_keys.h"
#include "io/input_file.h"
#include "io/toml_reader.h"
#include "io/toml_writer.h"

namespace pellucid::io {
namespace {

constexpr std::string_view units[] = {"mm", "cm", "m", "um"};
constexpr float millimetres[] = {1, 10, 1000, 0.001f};
// PelBurleyFit
constexpr std::string_view fits[] = {"searchlight", "diffuse-transmission", "diffuse-mean-free-path"};

void need(const TomlReader& reader, const char* key, std::string_view kind) {
    if (!reader.has(key))
        reader.fail(key, "is missing; a profile of kind " + std::string(kind) + " needs it");
}

void threeNumbers(TomlReader& reader, const char* key, float (&values)[3], Range range, std::string_view kind,
                  float unit) {
    need(reader, key, kind);
    reader.numbers(key, values, 3, range);
    for (float& value : values) value *= unit;
}

Profile gaussians(TomlReader& reader, float unit) {
    std::vector<PelGaussian> all;
    need(reader, "gaussian", "gaussians");
    reader.tables("gaussian", [&](TomlReader& r) {
        PelGaussian g{};
        need(r, "variance", "gaussians");
        need(r, "weight", "gaussians");
        r.number("variance", g.variance, range::positive);
        r.numbers("weight", g.weight, 3, range::notNegative);
        g.variance *= unit * unit;
        all.push_back(g);
    });
    return Profile::gaussians(all);
}

Profile burley(TomlReader& reader, float unit) {
    if (reader.has("distance")) {
        for (const char* key : {"mean_free_path", "albedo", "fit"})
            if (reader.has(key))
                reader.fail(key,
                            "cannot stand beside 'distance', which is what it would give; leave one out");
        float distance[3];
        threeNumbers(reader, "distance", distance, range::positive, "burley", unit);
        return Profile::burleyDistance(distance);
    }
    float path[3], albedo[3];
    threeNumbers(reader, "mean_free_path", path, range::positive, "burley", unit);
    threeNumbers(reader, "albedo", albedo, range::zeroToOne, "burley", 1);
    PelBurleyFit fit = PEL_BURLEY_DIFFUSE_TRANSMISSION;
    reader.choice("fit", fit, fits);
    return Profile::burley(path, albedo, fit);
}

Profile dipole(TomlReader& reader, float unit) {
    float absorption[3], scattering[3], eta = 1.3f;
    threeNumbers(reader, "absorption", absorption, range::positive, "dipole", 1 / unit);
    threeNumbers(reader, "reduced_scattering", scattering, range::positive, "dipole", 1 / unit);
    need(reader, "eta", "dipole");
    reader.number("eta", eta, range::atLeastOne);
    return Profile::dipole(absorption, scattering, eta);
}

Profile table(TomlReader& reader, float unit) {
    std::vector<float> distances, values;
    need(reader, "sample", "table");
    reader.tables("sample", [&](TomlReader& r) {
        float distance = 0, value[3];
        need(r, "distance", "table");
        need(r, "value", "table");
        r.number("distance", distance, range::notNegative);
        r.numbers("value", value, 3, range::notNegative);
        distances.push_back(distance * unit);
        values.insert(values.end(), value, value + 3);
    });
    return Profile::table(distances, values);
}

#define KEY(type, name, value, min, max, special, unit, key, ...) key,
constexpr const char* skinKeys[] = {PEL_EACH_SKIN_FIELD(KEY)};
#undef KEY

PelSkin skinLayers(TomlReader& reader) {
    PelSkin skin = pelSkinDefaults();
#define READ(type, name, value, min, max, special, unit, key, ...) \
    reader.number(key, skin.name, {float(min), float(max), float(special)});
    PEL_EACH_SKIN_FIELD(READ)
#undef READ
    return skin;
}

Profile shapeOf(TomlReader& reader, PelProfileKind kind, float unit, std::optional<PelSkin>& skin) {
    switch (kind) {
        case PEL_PROFILE_SKIN:
            return Profile::skin();
        case PEL_PROFILE_SKIN_LAYERS:
            return Profile::skinLayers(skin.emplace(skinLayers(reader)));
        case PEL_PROFILE_GAUSSIANS:
            return gaussians(reader, unit);
        case PEL_PROFILE_BURLEY:
            return burley(reader, unit);
        case PEL_PROFILE_DIPOLE:
            return dipole(reader, unit);
        case PEL_PROFILE_TABLE:
            return table(reader, unit);
    }
    reader.fail("kind", "is not known");
}

}  // namespace

ProfileFile parseProfile(const std::string& file, const std::string& text) {
    const auto root = parseToml(file, text);
    TomlReader reader(file, *root, "the profile");
    ProfileFile result;
    reader.version();
    for (const char* key : {"name", "kind", "source"})
        if (!reader.has(key)) reader.fail(key, "is missing; every profile has a name, a kind and a source");
    reader.text("name", result.name);
    reader.text("source", result.source);
    PelProfileKind kind = PEL_PROFILE_SKIN;
    reader.choice("kind", kind, profileKinds);
    // Skin with keys of its composition is computed.
    if (kind == PEL_PROFILE_SKIN &&
        std::ranges::any_of(skinKeys, [&](const char* key) { return reader.has(key); }))
        kind = PEL_PROFILE_SKIN_LAYERS;
    result.kind = profileKinds[kind];
    uint32_t unit = 0;
    if (kind != PEL_PROFILE_SKIN && kind != PEL_PROFILE_SKIN_LAYERS) need(reader, "unit", result.kind);
    reader.choice("unit", unit, units);
    try {
        result.profile = shapeOf(reader, kind, millimetres[unit], result.skin);
        result.profile.setName(result.name);
    } catch (const Error& e) {
        throw FileError(file, e.what(), reader.line());
    }
    reader.finish();
    return result;
}

std::string profileText(const pel::ProfileRecipe& recipe) {
    std::string out;
    TomlWriter writer(out);
    writer.text("name", recipe.name);
    writer.choice("kind", recipe.kind, profileKinds);
    writer.text("source", "captured");
    if (recipe.kind != PEL_PROFILE_SKIN && recipe.kind != PEL_PROFILE_SKIN_LAYERS) writer.text("unit", "mm");
    const auto three = [&](const char* key, const float* values) {
        writer.numbers(key, values, 3, range::any);
    };
    switch (recipe.kind) {
        case PEL_PROFILE_SKIN:
            break;
        case PEL_PROFILE_SKIN_LAYERS:
#define WRITE(type, name, value, min, max, special, unit, key, ...) \
    writer.number(key, recipe.skin.name, range::any);
            PEL_EACH_SKIN_FIELD(WRITE)
#undef WRITE
            break;
        case PEL_PROFILE_BURLEY:
            three(recipe.byDistance ? "distance" : "mean_free_path", recipe.first);
            if (recipe.byDistance) break;
            three("albedo", recipe.second);
            writer.choice("fit", recipe.fit, fits);
            break;
        case PEL_PROFILE_DIPOLE:
            three("absorption", recipe.first);
            three("reduced_scattering", recipe.second);
            writer.number("eta", recipe.eta, range::any);
            break;
        case PEL_PROFILE_GAUSSIANS:
        case PEL_PROFILE_TABLE: {
            const bool sums = recipe.kind == PEL_PROFILE_GAUSSIANS;
            for (const std::array<float, 4>& row : recipe.rows) {
                out += sums ? "[[gaussian]]\n" : "[[sample]]\n";
                writer.number(sums ? "variance" : "distance", row[0], range::any);
                three(sums ? "weight" : "value", &row[1]);
            }
        }
    }
    return out;
}

ProfileFile findProfile(const std::string& nameOrPath) {
    if (extensionOf(nameOrPath) == "toml")
        return parseProfile(nameOrPath, readWholeFile(nameOrPath, textLimit));
    const std::vector<std::string> known = Profile::libraryNames();
    if (std::ranges::find(known, nameOrPath) == known.end())
        throw FileError(nameOrPath,
                        "is neither a material of the library (" + joined(known) + ") nor a .toml file");
    const Profile profile = Profile::named(nameOrPath);
    const PelProfileInfo info = profile.info();
    return {nameOrPath, std::string(profileKinds[info.kind]), info.source, profile, {}};
}

}  // namespace pellucid::io
