#include "diffusion/gather_scatter.h"

#include <bit>

#include "core/launch_policy.h"
#include "diffusion/gather_taps.h"
#include "shading/launch_ranges.h"

namespace pel {
namespace {

// Looks up a table as the device does.
Rgb densityAt(const ProfileNodes& nodes, float distance2) {
    const int32_t last = int32_t((nodes.table.nodes - 1) << PEL_PROFILE_NODE_BITS) - 1;
    const int32_t bits =
        std::clamp(std::bit_cast<int32_t>(distance2) - int32_t(nodes.table.firstBits), 0, last);
    const size_t at = 4 * size_t(bits >> PEL_PROFILE_NODE_BITS);
    const double f = double(bits & ((1 << PEL_PROFILE_NODE_BITS) - 1)) / (1 << PEL_PROFILE_NODE_BITS);
    const Rgb low = threeAt(&nodes.values[at]), high = threeAt(&nodes.values[at + 4]);
    return low + f * (high - low);
}

// Replaces R by the line spread.
void takeLineSpread(ProfileNodes& nodes, const ProfileShape& shape, double scale) {
    for (uint32_t k = 0; k + 1 < nodes.table.nodes; ++k) {
        const uint32_t bits = nodes.table.firstBits + (k << PEL_PROFILE_NODE_BITS);
        const Rgb p = shape.lineSpread(std::sqrt(double(std::bit_cast<float>(bits))) / scale);
        for (int c = 0; c < 3; ++c) nodes.values[4 * k + c] = float(p[c] / scale);
    }
}

enum Program { SURFACE, GATHER, HISTORY };

}  // namespace

void GatherScatter::sendMaterials(const std::map<uint32_t, Material>& materials) {
    const std::vector<Material> distinct = distinctOf(materials, frame_.materialOf);
    if (materials == materials_ && described_) return;
    described_ = cl::Memory();  // until all are sent
    std::vector<PelGatherMaterial> described;
    std::vector<PelGatherTap> taps;
    std::vector<float> values;
    for (const Material& material : distinct) {
        const ProfileShape& shape = material.profile->shape();
        ProfileNodes nodes = profileNodes(shape, material.scale);
        const double reach = nodes.table.reach;
        if (form_ == Form::lines) takeLineSpread(nodes, shape, material.scale);
        PelGatherMaterial m{};
        m.table = nodes.table;
        m.table.offset = uint32_t(values.size() / 4);
        values.insert(values.end(), nodes.values.begin(), nodes.values.end());
        m.firstTap = uint32_t(taps.size()), m.taps = material.taps;
        std::vector<PelGatherTap> placed = form_ == Form::disk
                                               ? diskTaps(shape, material.scale, reach, material.taps)
                                               : lineTaps(shape, material.scale, reach, material.taps);
        for (PelGatherTap& tap : placed) {
            const Rgb density = densityAt(nodes, tap.place2);
            for (int c = 0; c < 3; ++c)
                tap.perDensity[c] = density[c] > 0 ? float(tap.share[c] / density[c]) : 0.0f;
            m.farthest = std::max(m.farthest, std::sqrt(tap.place2));
        }
        taps.insert(taps.end(), placed.begin(), placed.end());
        std::copy_n(material.border.begin(), 3, m.border);
        m.anyBorder = std::ranges::any_of(material.border, [](float b) { return b > 0; });
        described.push_back(m);
    }
    if (described.empty()) described.emplace_back(), taps.emplace_back(), values.resize(8);
    taps_ = device_->upload(taps);
    nodes_ = device_->upload(values);
    described_ = device_->upload(described);
    tableBytes_ =
        described.size() * sizeof described[0] + taps.size() * sizeof taps[0] + values.size() * sizeof(float);
    materials_ = materials;
}

void GatherScatter::prepare(const std::map<uint32_t, Material>& materials, const Ids& sources,
                            const GatherImages& images, const ScatterView& view, uint32_t frameIndex) {
    const ScatterImages& of = images.of;
    const Sight sight = sightOf(view);
    describePicture(of, view, sight, frame_);
    frame_.view = sight.view;
    const GatherImages::History& history = images.history;
    if (history.weight > 0 && frame_.view == PEL_VIEW_UNKNOWN)
        invalidArgument("PelShaderOptions.historyWeight is ", history.weight,
                        ": a valid PelCamera.inverseViewProjection is needed, but the one that is set has "
                        "neither an eye point nor a view direction");
    frame_.frameIndex = frameIndex;
    frame_.everywhere = view.everywhere;
    frame_.weight = describeImage(images.weight);
    frame_.historyWeight = history.weight;
    frame_.motion = describeImage(history.motion);
    frame_.blended = describeImage(history.out);
    std::fill(std::begin(frame_.sources), std::end(frame_.sources), 0u);
    for (uint32_t id = 0; id < PEL_DIFFUSION_IDS; ++id)
        if (sources[id] || materials.contains(id)) frame_.sources[id / 32] |= 1u << id % 32;
    sendMaterials(materials);
    const size_t pixels = size_t(frame_.width) * frame_.height;
    points_.resize(*device_, pixels * PEL_GATHER_FLOATS * sizeof(float));
    if (form_ == Form::lines) rows_.resize(*device_, pixels * 4 * sizeof(float));
    const size_t samples = images.half ? size_t((frame_.width + 1) / 2) * ((frame_.height + 1) / 2) : 0;
    samples_.resize(*device_, samples * 4 * sizeof(float));
    for (SizedMemory& one : history_)
        if (one.resize(*device_, history.weight > 0 ? pixels * 4 * sizeof(float) : 0)) sequence_.reset();
    tiles_.resize(*device_, size_t(frame_.tilesX) * frame_.tilesY * sizeof(cl_uint));
    if (!counters_) counters_ = device_->allocate(PEL_DIFFUSION_COUNTERS * sizeof(cl_uint));
    constants_.update(*device_, frame_);
}

std::vector<cl::ProgramKey> GatherScatter::programs(const GatherImages& images) const {
    const ScatterImages& of = images.of;
    std::vector<cl::ProgramKey> keys{
        {{"diffusion/gather_surface.cl"},
         {{"PEL_WIDTH", 1},
          {"PEL_FORMAT_IRRADIANCE", formatCode(of.irradiance, 1)},
          {"PEL_FORMAT_POSITION", formatCode(of.positions, 1)},
          {"PEL_FORMAT_DEPTH", of.positions ? 0 : formatCode(of.depth, 1)},
          {"PEL_FORMAT_MATERIAL", formatCode(of.ids, 1)},
          {"PEL_FORMAT_SCATTER_WEIGHT", formatCode(images.weight, 1)},
          {"PEL_FORMAT_RADIUS", formatCode(of.radii, 1)},
          {"PEL_RADIUS_COMPONENT", of.radiusComponent}}},
        {{form_ == Form::disk ? "diffusion/scatter_disk.cl" : "diffusion/scatter_separable.cl"},
         {{"PEL_WIDTH", 1},
          {"PEL_HALF", int(images.half)},
          {"PEL_HISTORY", int(images.history.weight > 0)},
          {"PEL_FORMAT_IRRADIANCE", formatCode(of.irradiance, 1)},
          {"PEL_FORMAT_OUT", formatCode(of.out, 1)}}}};
    const GatherImages::History& history = images.history;
    if (history.weight > 0)
        keys.push_back({{"diffusion/blend_history.cl"},
                        {{"PEL_WIDTH", 1},
                         {"PEL_HALF", int(images.half)},
                         {"PEL_FORMAT_MOTION", formatCode(history.motion, 1)},
                         {"PEL_MOTION_COMPONENTS",
                          int(history.motion ? std::min(history.motion.info().components, 3u) : 0)},
                         {"PEL_FORMAT_OUT", formatCode(history.out, 1)}}});
    return keys;
}

void GatherScatter::blendHistory(const GatherImages& images, const cl::Program& program,
                                 std::vector<cl::Event>& events) {
    const Sequence sequence{frame_.width, frame_.height, frame_.view, images.history.cut};
    lastView_.s[3] = sequence_ == sequence;
    std::swap(history_[0], history_[1]);
    const size_t tiles = size_t(frame_.tilesX) * frame_.tilesY;
    device_->launch(events, program, "blend_history", groupRange(*device_, groupsFor(*device_, tiles)),
                    constants_, points_, described_, nodes_, images.of.out, images.history.motion,
                    history_[0], lastView_, history_[1], images.history.out, counters_);
    sequence_ = sequence;
    std::copy_n(frame_.view == PEL_VIEW_POINT ? frame_.origin : frame_.direction, 3, lastView_.s);
}

void GatherScatter::enqueue(const GatherImages& images, std::vector<cl::Event>& events) {
    std::vector<cl::Program> programs;
    for (const cl::ProgramKey& key : this->programs(images)) programs.push_back(device_->programs().get(key));
    const ScatterImages& of = images.of;
    device_->fill(counters_.get(), 0, PEL_DIFFUSION_COUNTERS * sizeof(cl_uint), 0);
    device_->launch(events, programs[SURFACE], "gather_points",
                    itemRange(*device_, size_t(frame_.width) * frame_.height), constants_, of.irradiance,
                    of.positions ? of.positions : of.depth, of.ids, images.weight, of.radii, points_,
                    counters_);
    const size_t tiles = size_t(frame_.tilesX) * frame_.tilesY;
    device_->launch(events, programs[SURFACE], "gather_areas", groupRange(*device_, tiles), constants_,
                    points_, described_, tiles_, counters_);
    const auto gather = [&](const char* kernel, const auto&... arguments) {
        device_->launch(events, programs[GATHER], kernel, groupRange(*device_, groupsFor(*device_, tiles)),
                        constants_, points_, described_, taps_, nodes_, tiles_, arguments..., counters_);
    };
    if (form_ == Form::disk) {
        if (images.half) gather("sample_disk", samples_);
        gather("scatter_disk", samples_, of.irradiance, of.out);
    } else {
        gather("filter_rows", rows_);
        if (images.half) gather("sample_columns", rows_, samples_);
        gather("filter_columns", rows_, samples_, of.irradiance, of.out);
    }
    if (images.history.weight > 0) blendHistory(images, programs[HISTORY], events);
}

ScatterCounts GatherScatter::counts() {
    ScatterCounts counts{};
    if (counters_) device_->read(counters_.get(), 0, sizeof counts, &counts, true);
    return counts;
}

}  // namespace pel
