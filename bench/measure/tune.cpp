// Launch sizes by measurement: tables and frames are made with one size after another, in turns.

#include "diffusion/lit_scenes.h"
#include "measure.h"
#include "temporary_folder.h"
#include "timing.h"

namespace pellucid::bench {
namespace {

using namespace lit_scenes;
using Json = nlohmann::ordered_json;
using pel::LaunchPolicy;

constexpr double minGain = 0.05, standardErrors = 4;

struct Work {
    std::function<void()> run;
    int repeats = 1;              // runs per sample, so that a sample is long against the clock
    std::vector<double> ms = {};  // of the device, per run
};

// A device with sizes of its own, and what runs there.
struct Candidate {
    LaunchPolicy policy;
    Device device;
    std::vector<Work> work = {};

    void sample(Work& w) const {
        const double before = device.stats().kernelMilliseconds, start = milliseconds();
        for (int i = 0; i < w.repeats; ++i) w.run();
        const double wall = milliseconds() - start, own = device.stats().kernelMilliseconds - before;
        w.ms.push_back((own > 0 ? own : wall) / w.repeats);
    }
};

struct Size {
    const char* name;
    size_t LaunchPolicy::*of;
    bool tables, frames;  // that it matters for
};
constexpr Size launchSizes[] = {{"group", &LaunchPolicy::group, true, true},
                                {"columns", &LaunchPolicy::columns, true, false},
                                {"table_columns", &LaunchPolicy::tableColumns, true, false},
                                {"texels", &LaunchPolicy::texels, false, true}};

// Of the mean of logarithms of times, over those of `before`: the mean and its standard error.
struct Ratio {
    double log = 0, error = 0, worst = -INFINITY;
};
Ratio ratioOf(const Candidate& after, const Candidate& before) {
    Ratio r;
    const auto relative = [](const std::vector<double>& v) {
        return 1.2533 * 1.4826 * medianDeviation(v) / median(v) / std::sqrt(double(v.size()));
    };
    const auto n = double(after.work.size());
    for (size_t i = 0; i < after.work.size(); ++i) {
        const std::vector<double>&a = after.work[i].ms, &b = before.work[i].ms;
        const double log = std::log(median(a) / median(b));
        r.log += log / n, r.worst = std::max(r.worst, log);
        r.error = std::hypot(r.error, relative(a) / n, relative(b) / n);
    }
    return r;
}

class Tuner {
  public:
    Tuner(const Device& device, const std::string& selector, bool quick, const TuneProgress& progress)
        : info_(device.info()), selector_(selector), quick_(quick), progress_(progress) {
        SceneRequest request;
        request.size = quick ? 96 : 512, request.mapSize = quick ? 128 : 1024;
        scene_ = Stage(device, ball(10, quick ? 60 : 200), 1).look(request, profile_);
    }

    Tuned tune() {
        Tuned result;
        const LaunchPolicy builtIn = pel::builtInPolicy(info_.mathWidth);
        LaunchPolicy best = builtIn;
        for (const Size& size : launchSizes) {
            std::vector<Candidate> all;
            for (const double by :
                 quick_ ? std::vector<double>{1, 2} : std::vector<double>{1, 0.25, 0.5, 2, 4}) {
                LaunchPolicy policy = best;
                policy.*size.of = size_t(double(best.*size.of) * by);
                if (pel::allowedPolicy(policy, info_) != policy) continue;
                add(all, policy, size.tables, size.frames);
            }
            measure(all);
            size_t taken = 0;
            for (size_t i = 0; i < all.size(); ++i) {
                const Ratio r = ratioOf(all[i], all[0]);
                result.measured.push_back({{"size", size.name},
                                           {"value", all[i].policy.*size.of},
                                           {"time_ratio", std::exp(r.log)},
                                           {"noise", std::expm1(standardErrors * r.error)}});
                if (isFaster(r) && r.log < ratioOf(all[taken], all[0]).log) taken = i;
            }
            best = all[taken].policy;
        }
        result.sizes = builtIn;
        if (best == builtIn) return result;
        // All chosen sizes together against the built-in ones: a size chosen by chance is not faster twice.
        std::vector<Candidate> both;
        add(both, builtIn, true, true);
        add(both, best, true, true);
        measure(both);
        const Ratio r = ratioOf(both[1], both[0]);
        result.measured.push_back({{"size", "all"},
                                   {"time_ratio", std::exp(r.log)},
                                   {"noise", std::expm1(standardErrors * r.error)}});
        if (isFaster(r) && r.worst < std::log1p(minGain)) result.sizes = best, result.ratio = std::exp(r.log);
        return result;
    }

  private:
    static bool isFaster(const Ratio& r) {
        return r.log < -std::max(std::log1p(minGain), standardErrors * r.error);
    }

    // A size that the device refuses is left out, except the first.
    void add(std::vector<Candidate>& all, const LaunchPolicy& policy, bool tables, bool frames) {
        progress_(done_, "tables and frames with other launch sizes");
        try {
            const Temporary file(pel::launchText(info_, policy));
            Candidate c{policy, Device(selector_)};
            if (tables) addTables(c);
            if (frames) addFrames(c);
            for (Work& w : c.work) {
                w.run();
                c.sample(w);
                w.repeats = int(std::clamp((quick_ ? 1 : 5) / std::max(w.ms[0], 1e-3), 1.0, 100.0));
                w.ms.clear();
            }
            all.push_back(std::move(c));
        } catch (const Error&) {
            if (all.empty()) throw;
        }
    }
    void addTables(Candidate& c) const {
        const uint32_t side = quick_ ? 32 : 256;
        for (const Profile* profile : {&profile_, &tabulated_}) {
            PelCurvatureLutDesc curvature = pelCurvatureLutDescDefaults();
            PelShadowLutDesc shadow = pelShadowLutDescDefaults();
            curvature.profile = shadow.profile = profile->get();
            curvature.width = curvature.height = shadow.width = shadow.height = side;
            c.work.push_back({[=, device = c.device] { Lut(device, curvature); }});
            c.work.push_back({[=, device = c.device] { Lut(device, shadow); }});
        }
    }
    void addFrames(Candidate& c) const {
        for (const PelScattering method : {PEL_SCATTERING_AUTO, PEL_SCATTERING_PREINTEGRATED}) {
            ShadeRequest request;
            request.scattering = method, request.count = false;
            const auto shot = std::make_shared<Shot>(shoot(c.device, scene_, profile_, 1, request));
            c.work.push_back({[shot] { shot->shader.execute(); }});
        }
    }

    void measure(std::vector<Candidate>& all) {
        const int rounds = quick_ ? 3 : 11;
        std::mt19937 random(1);
        std::vector<size_t> order(all.size());
        for (size_t i = 0; i < order.size(); ++i) order[i] = i;
        for (int round = 0; round < rounds; ++round) {
            progress_(done_, "tables and frames with other launch sizes");
            std::ranges::shuffle(order, random);
            for (const size_t i : order)
                for (Work& w : all[i].work) all[i].sample(w);
        }
        done_ += 0.2;
    }

    // While one lives, devices that are opened take these sizes.
    class Temporary {
      public:
        explicit Temporary(const std::string& text) {
            if (const char* const named = std::getenv(variable)) before_ = named;
            const std::string file = folder_.path() + "/tuning.txt";
            if (!(std::ofstream(file, std::ios::binary) << text))
                throw std::runtime_error(file + " cannot be written");
            pel::system::setVariable(variable, file.c_str());
        }
        ~Temporary() { pel::system::setVariable(variable, before_ ? before_->c_str() : nullptr); }
        Temporary(const Temporary&) = delete;

      private:
        static constexpr const char* variable = "PELLUCID_TUNING";
        TemporaryFolder folder_{"pellucid-tune-"};
        std::optional<std::string> before_;
    };

    PelDeviceInfo info_;
    std::string selector_;
    bool quick_;
    TuneProgress progress_;
    double done_ = 0;
    Profile profile_ = Profile::skin(), tabulated_ = Profile::named("jade");
    LitScene scene_;
};

}  // namespace

Tuned tuneLaunches(const Device& device, const std::string& selector, bool quick,
                   const TuneProgress& progress) {
    return Tuner(device, selector, quick, progress).tune();
}

}  // namespace pellucid::bench
