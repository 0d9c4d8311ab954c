// Look-up tables against adaptive quadrature in double precision, at texels drawn once.

#include "measure.h"
#include "reference/lut.h"
#include "tools.h"

namespace pellucid::bench {
namespace {

// `texelOf`: makes the true texels of a table.
template <class Desc, class TexelOf>
Case tableCase(const Device& device, Desc desc, uint32_t side, int samples, const TexelOf& texelOf,
               const std::string& what) {
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
        const auto texel = texelOf(lut->info());
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
Case lookUpCase(const Device& device, PelCurvatureForm form, reference::Form truth, PelLutEncoding encoding,
                uint32_t side, int samples) {
    PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
    desc.form = form;
    const auto texelOf = [](const PelLutInfo&) { return [](int, int) { return reference::Rgb{}; }; };
    Case c = tableCase(device, desc, side, 0, texelOf, "");
    desc.width = desc.height = side;
    constexpr const char* names[] = {"float", "half", "8 bits"};
    c.what += std::string(", ") + names[encoding] + ", " +
              std::to_string(side * side *
                             (encoding == PEL_LUT_HALF ? 8
                              : encoding               ? 4
                                                       : 16) /
                             1024) +
              " KiB";
    c.error = [=] {
        const Lut lut(device, desc);
        const PelCurvatureLutDesc made = lut.info().curvature;
        constexpr int finer = 8;
        const int fine = finer * int(side);
        const reference::CurvatureLutSpec spec{truth, fine, fine, made.radiusMin, made.radiusMax};
        const reference::ProfilePtr profile =
            reference::profileForRadius(reference::skinProfile(), made.diffusionRadius);
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
            const reference::Rgb exact = reference::curvatureTexel(spec, *profile, x, y);
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

constexpr float burleyMeanFreePath[3] = {1.0f, 0.4f, 0.2f}, burleyAlbedo[3] = {0.8f, 0.6f, 0.5f};

}  // namespace

std::vector<Factory> tableCases(const Device& device, bool quick) {
    const uint32_t side = quick ? 128 : 512;
    const int samples = quick ? 60 : 300;
    using Texel = std::function<reference::Rgb(int, int)>;
    const auto rgb = [](const float(&v)[3]) { return reference::Rgb{v[0], v[1], v[2]}; };
    const auto curvature = [=](PelCurvatureForm form, reference::Form truth, bool burley) {
        return [=] {
            PelCurvatureLutDesc desc = pelCurvatureLutDescFaceWorks();
            desc.form = form;
            const Profile profile =
                burley ? Profile::burley(burleyMeanFreePath, burleyAlbedo) : Profile::skin();
            if (burley) desc.profile = profile.get(), desc.diffusionRadius = 0;  // its own
            const auto texel = [=](const PelLutInfo& info) -> Texel {
                (void)profile;  // lives as long as the case
                const PelCurvatureLutDesc& made = info.curvature;
                const reference::CurvatureLutSpec spec{truth, int(side), int(side), made.radiusMin,
                                                       made.radiusMax};
                const reference::ProfilePtr p =
                    burley ? reference::burleyProfile(rgb(burleyMeanFreePath), rgb(burleyAlbedo))
                           : reference::profileForRadius(reference::skinProfile(), made.diffusionRadius);
                return [=](int x, int y) { return reference::curvatureTexel(spec, *p, x, y); };
            };
            return tableCase(device, desc, side, burley ? samples / 3 : samples, texel,
                             burley ? ", Christensen-Burley profile" : ", skin");
        };
    };
    const auto shadow = [=] {
        const auto texel = [=](const PelLutInfo& info) -> Texel {
            const PelShadowLutDesc& made = info.shadow;
            const reference::ShadowLutSpec spec{
                int(side), int(side), made.widthMin, made.widthMax, made.diffusionRadius, made.sharpening};
            const reference::ProfilePtr skin = reference::skinProfile();
            return [=](int x, int y) { return reference::shadowTexel(spec, *skin, x, y); };
        };
        return tableCase(device, pelShadowLutDescFaceWorks(), side, samples, texel, ", skin");
    };
    const auto specular = [=] {
        const auto texel = [=](const PelLutInfo&) -> Texel {
            return [=](int x, int y) {
                const double v = reference::beckmannEncoded((x + 0.5) / side, (y + 0.5) / side);
                return reference::Rgb{v, v, v};
            };
        };
        return tableCase(device, pelSpecularLutDescDefaults(), side, samples, texel, "");
    };
    std::vector<Factory> all{
        {"table-arc", "tables", curvature(PEL_FORM_ARC, reference::Form::arc, false)},
        {"table-ring", "tables", curvature(PEL_FORM_RING, reference::Form::ring, false)},
        {"table-half-ring", "tables", curvature(PEL_FORM_HALF_RING, reference::Form::halfRing, false)},
        {"table-sphere", "tables", curvature(PEL_FORM_SPHERE, reference::Form::sphere, false)},
        {"table-sphere-burley", "tables", curvature(PEL_FORM_SPHERE, reference::Form::sphere, true)},
        {"table-shadow", "tables", shadow},
        {"table-specular", "tables", specular},
        {"table-pairs", "tables", [=] { return pairCase(device, quick ? 128 : 512); }}};
    constexpr std::tuple<const char*, PelCurvatureForm, reference::Form> forms[] = {
        {"arc", PEL_FORM_ARC, reference::Form::arc},
        {"ring", PEL_FORM_RING, reference::Form::ring},
        {"half-ring", PEL_FORM_HALF_RING, reference::Form::halfRing},
        {"sphere", PEL_FORM_SPHERE, reference::Form::sphere}};
    for (const auto& [name, form, truth] : forms)
        for (const uint32_t of : {16u, 64u, 256u})
            for (const PelLutEncoding encoding : {PEL_LUT_FLOAT, PEL_LUT_HALF, PEL_LUT_FACEWORKS8}) {
                if (quick && (of != 64 || form != PEL_FORM_SPHERE)) continue;
                constexpr const char* encodings[] = {"float", "half", "bytes"};
                all.push_back(
                    {"lookup-" + std::string(name) + "-" + std::to_string(of) + "-" + encodings[encoding],
                     "tables", [=, f = form, t = truth] {
                         return lookUpCase(device, f, t, encoding, of, 2 * samples);
                     }});
            }
    return all;
}

}  // namespace pellucid::bench
