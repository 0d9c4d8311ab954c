// Look-up tables against adaptive quadrature in double precision, at texels drawn once.

#include "io/choice_keys.h"
#include "measure.h"
#include "true_texels.h"

namespace pellucid::bench {
namespace {

// The part of a table's description with all its lengths.
template <class Desc>
Desc describedBy(const PelLutInfo& info) {
    if constexpr (std::is_same_v<Desc, PelCurvatureLutDesc>) return info.curvature;
    if constexpr (std::is_same_v<Desc, PelShadowLutDesc>) return info.shadow;
    if constexpr (std::is_same_v<Desc, PelSpecularLutDesc>) return info.specular;
}

// `profile`: the oracle's.
template <class Desc>
Case tableCase(const Device& device, Desc desc, uint32_t side, int samples,
               const reference::ProfilePtr& profile, const std::string& what) {
    desc.width = desc.height = side;
    const auto lut = std::make_shared<Lut>();
    Case c;
    c.what = std::to_string(side) + "x" + std::to_string(side) + what;
    c.items = double(side) * side;
    c.unit = "texels";
    c.bytes = 16 * c.items;  // float4, written
    c.run = [=] { *lut = Lut(device, desc); };
    c.error = [=] {
        const std::vector<float> values = lut->read<float>(PEL_LUT_FLOAT);
        const TexelAt texel = trueTexels(describedBy<Desc>(lut->info()), profile);
        std::mt19937 random(1);
        ErrorSum sum;
        for (int i = 0; i < samples; ++i) {
            const auto x = uint32_t(random() % side), y = uint32_t(random() % side);
            const reference::Rgb truth = texel(int(x), int(y));
            for (int c = 0; c < 3; ++c) sum.add(values[3 * (size_t(y) * side + x) + size_t(c)] - truth[c]);
        }
        return sum.result();
    };
    c.truth = "adaptive quadrature in double precision at drawn texels; absolute";
    return c;
}

// RGB of any encoding.
std::vector<float> decoded(const Lut& lut, PelLutEncoding encoding, uint32_t side) {
    if (encoding == PEL_LUT_FLOAT) return lut.read<float>(encoding);
    std::vector<float> values;
    if (encoding == PEL_LUT_HALF) {
        for (const uint16_t h : lut.read<uint16_t>(encoding)) values.push_back(fromHalf(h));
        return values;
    }
    const std::vector<uint8_t> bytes = lut.read<uint8_t>(encoding);
    for (size_t i = 0; i < bytes.size(); ++i)
        if (i % 4 < 3) {
            const float u = 2 * (float(i / 4 % side) + 0.5f) / float(side) - 1;
            values.push_back(std::max(u, 0.0f) + 0.5f * (float(bytes[i]) / 255 - 0.5f));
        }
    return values;
}

// The error of a table's look-ups between its texels.
Case lookUpCase(const Device& device, PelCurvatureForm form, PelLutEncoding encoding, uint32_t side,
                int samples) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.form = form;
    Case c = tableCase(device, desc, side, 0, {}, "");
    desc.width = desc.height = side;
    constexpr const char* names[] = {"float", "half", "8 bits"};
    constexpr uint32_t bytes[] = {16, 8, 4};
    c.what += std::string(", ") + names[encoding] + ", " +
              std::to_string(side * side * bytes[encoding] / 1024) + " KiB";
    c.error = [=] {
        const Lut lut(device, desc);
        PelCurvatureLutDesc made = lut.info().curvature;
        constexpr int finer = 8;
        const int fine = finer * int(side);
        made.width = made.height = uint32_t(fine);
        const TexelAt texel = trueTexels(made, reference::skinProfile());
        const std::vector<float> values = decoded(lut, encoding, side);
        const auto at = [&](double x, double y, int channel) {
            const auto clamped = [&](double v) { return size_t(std::clamp(v, 0.0, side - 1.0)); };
            return double(values[3 * (clamped(y) * side + clamped(x)) + size_t(channel)]);
        };
        std::mt19937 random(1);
        ErrorSum sum;
        for (int i = 0; i < samples; ++i) {
            const int x = int(random() % uint32_t(fine)), y = int(random() % uint32_t(fine));
            const double tx = (x + 0.5) / finer - 0.5, ty = (y + 0.5) / finer - 0.5, fx = tx - std::floor(tx),
                         fy = ty - std::floor(ty), x0 = std::floor(tx), y0 = std::floor(ty);
            const reference::Rgb exact = texel(x, y);
            for (int k = 0; k < 3; ++k)
                sum.add((1 - fy) * ((1 - fx) * at(x0, y0, k) + fx * at(x0 + 1, y0, k)) +
                        fy * ((1 - fx) * at(x0, y0 + 1, k) + fx * at(x0 + 1, y0 + 1, k)) - exact[k]);
        }
        return sum.result();
    };
    c.truth = "adaptive quadrature in double precision, at drawn places between texels; absolute";
    return c;
}

// A batch as pipelines make it by the thousand: a profile of each skin, its two tables, halves on the host.
Case pairCase(const Device& device, uint32_t count) {
    constexpr uint32_t side = 32, texels = 3 * side * side;
    // The tables of one kind of the first skins, of which every `step`th; the profiles live as long.
    const auto tablesOf = [=](PelLutKind kind, uint32_t step, std::vector<Profile>& profiles) {
        std::vector<PelLutInfo> tables;
        for (uint32_t i = 0; i < count; i += step) {
            if (tables.size() == profiles.size()) {
                PelSkin skin = pelSkinDefaults();
                skin.melanin = 0.005f + 0.3f * float(i) / float(count);
                profiles.push_back(Profile::skinLayers(skin));
            }
            PelLutInfo info = pelLutInfoDefaults();
            info.kind = kind;
            info.curvature = pelCurvatureLutDescDefaults();
            info.shadow = pelShadowLutDescDefaults();
            info.curvature.width = info.curvature.height = info.shadow.width = info.shadow.height = side;
            info.curvature.profile = info.shadow.profile = profiles[tables.size()].get();
            tables.push_back(info);
        }
        return tables;
    };
    using Halves = std::vector<uint16_t>;
    const auto made = std::make_shared<std::array<Halves, 2>>();
    constexpr PelLutKind kinds[] = {PEL_LUT_CURVATURE, PEL_LUT_SHADOW};
    Case c;
    c.what = std::to_string(count) + " skins, two tables of 32x32 each, as halves";
    c.items = count;
    c.unit = "pairs";
    c.bytes = 2 * 2.0 * texels * count;
    c.run = [=] {
        std::vector<Profile> profiles;
        for (size_t k = 0; k < 2; ++k) {
            Halves& halves = (*made)[k];
            halves.resize(size_t(texels) * count);
            Lut::readStack(device, tablesOf(kinds[k], 1, profiles), PEL_LUT_HALF, halves.data(),
                           2 * halves.size());
        }
    };
    c.error = [=] {
        constexpr uint32_t step = 16;
        ErrorSum sum;
        std::vector<Profile> profiles;
        for (size_t k = 0; k < 2; ++k) {
            const std::vector<PelLutInfo> some = tablesOf(kinds[k], step, profiles);
            for (size_t i = 0; i < some.size(); ++i) {
                const Lut alone = k ? Lut(device, some[i].shadow) : Lut(device, some[i].curvature);
                const std::vector<float> truth = alone.read<float>(PEL_LUT_FLOAT);
                for (size_t t = 0; t < texels; ++t)
                    sum.add(fromHalf((*made)[k][step * i * texels + t]) - truth[t]);
            }
        }
        return sum.result();
    };
    c.truth = "the same tables made alone, as floats; absolute";
    return c;
}

}  // namespace

std::vector<Factory> tableCases(const Device& device, bool quick) {
    const uint32_t side = quick ? 128 : 512;
    const int samples = quick ? 60 : 300;
    const reference::ProfilePtr skin = reference::skinProfile();
    const auto curvature = [=](PelCurvatureForm form) {
        return [=] {
            PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
            desc.form = form;
            return tableCase(device, desc, side, samples, skin, ", skin");
        };
    };
    const auto burley = [=] {
        constexpr float path[3] = {1.0f, 0.4f, 0.2f}, albedo[3] = {0.8f, 0.6f, 0.5f};
        const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
        PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
        desc.form = PEL_FORM_SPHERE;
        desc.diffusionRadius = 0;  // the profile's own
        const Profile profile = Profile::burley(path, albedo);
        desc.profile = profile.get();
        Case c = tableCase(device, desc, side, samples / 3, reference::burleyProfile(rgb(path), rgb(albedo)),
                           ", Christensen-Burley profile");
        c.run = [run = c.run, profile] { run(); };  // the profile lives as long
        return c;
    };
    const auto shadow = [=] {
        return tableCase(device, pelShadowLutDescFaceWorks(), side, samples, skin, ", skin");
    };
    const auto specular = [=] {
        return tableCase(device, pelSpecularLutDescDefaults(), side, samples, {}, "");
    };
    constexpr PelCurvatureForm forms[] = {PEL_FORM_ARC, PEL_FORM_RING, PEL_FORM_HALF_RING, PEL_FORM_SPHERE};
    const auto nameOf = [](const char* what, PelCurvatureForm form) {
        return what + std::string(io::curvatureForms[form]);
    };
    std::vector<Factory> all;
    for (const auto form : forms) all.push_back({nameOf("table-", form), "tables", curvature(form)});
    all.insert(all.end(), {{"table-sphere-burley", "tables", burley},
                           {"table-shadow", "tables", shadow},
                           {"table-specular", "tables", specular},
                           {"table-pairs", "tables", [=] { return pairCase(device, quick ? 128 : 512); }}});
    for (const auto form : forms)
        for (const uint32_t of : {16u, 64u, 256u})
            for (const PelLutEncoding encoding : {PEL_LUT_FLOAT, PEL_LUT_HALF, PEL_LUT_FACEWORKS8}) {
                if (quick && (of != 64 || form != PEL_FORM_SPHERE)) continue;
                constexpr const char* encodings[] = {"float", "half", "bytes"};
                all.push_back({nameOf("lookup-", form) + "-" + std::to_string(of) + "-" + encodings[encoding],
                               "tables",
                               [=] { return lookUpCase(device, form, encoding, of, 2 * samples); }});
            }
    return all;
}

}  // namespace pellucid::bench
