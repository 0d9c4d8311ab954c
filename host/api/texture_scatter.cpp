#include "diffusion/texture_scatter.h"

#include "api/entry.h"
#include "core/submission.h"

using namespace pel;

namespace {

ImageView viewOf(const PelImageDesc* desc, const TextureScatter& object, const char* name) {
    if (!desc) invalidArgument("`", name, "` is needed, not NULL");
    return makeImageView(desc, object.device(), name);
}

}  // namespace

PelError pelTextureScatterCreate(PelDevice device, const PelTextureScatterDesc* desc,
                                 PelTextureScatter* scatter) {
    return entry([&] {
        handOut(scatter, "scatter", [&] {
            return TextureScatter::create(
                fromHandle<Device>(device),
                readStruct(desc, pelTextureScatterDescDefaults(), "PelTextureScatterDesc"));
        });
    });
}

void pelTextureScatterRetain(PelTextureScatter scatter) {
    retainEntry<TextureScatter>(scatter);
}
void pelTextureScatterRelease(PelTextureScatter scatter) {
    releaseEntry<TextureScatter>(scatter);
}

PelError pelTextureScatterSetPositions(PelTextureScatter scatter, const PelVertexView* positions,
                                       const PelSubmit* submit) {
    return entry([&] {
        const Ref<TextureScatter> object = fromHandle<TextureScatter>(scatter);
        const VertexView view = checkedView(positions, "positions", object->device(), object->vertices(), 3,
                                            "the texture's mesh");
        Submission submission(object->device(), submit);
        object->setPositions(view);
        submission.finish();
    });
}

PelError pelTextureScatterDraw(PelTextureScatter scatter, const PelVertexView* values, uint32_t unit,
                               const PelImageDesc* out, const PelSubmit* submit) {
    return entry([&] {
        const Ref<TextureScatter> object = fromHandle<TextureScatter>(scatter);
        const VertexView view =
            checkedView(values, "values", object->device(), object->vertices(), 3, "the texture's mesh");
        const ImageView image = viewOf(out, *object, "out");
        Submission submission(object->device(), submit);
        object->draw(view, unit != 0, image);
        submission.finish();
    });
}

PelError pelTextureScatterExecute(PelTextureScatter scatter, const PelTextureScatterParams* params,
                                  const PelImageDesc* irradiance, const PelImageDesc* albedo,
                                  const PelImageDesc* out, const PelSubmit* submit) {
    return entry([&] {
        const Ref<TextureScatter> object = fromHandle<TextureScatter>(scatter);
        const auto defaults = pelTextureScatterParamsDefaults();
        const auto full = params ? readStruct(params, defaults, "PelTextureScatterParams") : defaults;
        const Ref<Profile> profile = full.profile ? fromHandle<Profile>(full.profile) : Profile::skin();
        const ImageView from = viewOf(irradiance, *object, "irradiance"),
                        colors = albedo ? viewOf(albedo, *object, "albedo") : ImageView(),
                        to = viewOf(out, *object, "out");
        Submission submission(object->device(), submit);
        object->execute(full, profile, from, colors, to);
        submission.finish();
    });
}

PelError pelTextureScatterGetStats(PelTextureScatter scatter, PelTextureScatterStats* stats) {
    return entry(
        [&] { writeStruct(stats, fromHandle<TextureScatter>(scatter)->stats(), "PelTextureScatterStats"); });
}
