// A plugin of Oclgrind (oclgrind --plugins) that counts what 32 neighbouring work-items would do together on
// a GPU, as a line of JSON per launch at the end of the file PELLUCID_WARPS:
//   lanes     of 32, on average, that take part in an instruction, if lanes that part meet again at once
//   sectors   of 32 bytes that a warp's loads and stores of global memory touch; least: as few as hold the
//             bytes that it asks for
//   moved     bytes of all sectors that the launch touches, each counted once: what a perfect cache moves
//   replays   of accesses to local memory, over their number: lanes that want other words of one bank wait
#include <cstdio>
#include <cstdlib>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "Context.h"
#include "Kernel.h"
#include "KernelInvocation.h"
#include "Plugin.h"
#include "WorkGroup.h"
#include "WorkItem.h"

using namespace oclgrind;

namespace {

constexpr size_t lanes = 32, sector = 32, banks = 32;

struct Access {
    size_t address, size;
};

// What the lanes of a warp did at one instruction.
struct Site {
    uint32_t executed[lanes] = {};
    uint32_t accessed[lanes] = {};
    bool local = false;
    std::vector<std::vector<Access>> accesses;  // of the first time that a lane came here, the second, ...
};
using Warp = std::unordered_map<const llvm::Instruction*, Site>;

struct Counts {
    size_t groups = 0, items = 0, instructions = 0, slots = 0, loads = 0, sectors = 0, least = 0, local = 0,
           replays = 0;
    std::unordered_set<size_t> touched;
};

class Warps : public Plugin {
  public:
    using Plugin::Plugin;
    bool isThreadSafe() const override { return false; }  // one group at a time

    void kernelBegin(const KernelInvocation*) override { counts_ = {}; }
    void workGroupBegin(const WorkGroup* group) override {
        const Size3 size = group->getGroupSize();
        size_ = size;
        warps_.assign((size.x * size.y * size.z + lanes - 1) / lanes, {});
        counts_.items += size.x * size.y * size.z;
        ++counts_.groups;
    }
    void instructionExecuted(const WorkItem* item, const llvm::Instruction* instruction,
                             const TypedValue&) override {
        ++site(item, instruction).executed[lane_];
    }
    void memoryLoad(const Memory* memory, const WorkItem* item, size_t address, size_t size) override {
        access(memory, item, address, size);
    }
    void memoryStore(const Memory* memory, const WorkItem* item, size_t address, size_t size,
                     const uint8_t*) override {
        access(memory, item, address, size);
    }
    void workGroupComplete(const WorkGroup*) override {
        for (const Warp& warp : warps_)
            for (const auto& [instruction, site] : warp) {
                size_t most = 0;
                for (const uint32_t n : site.executed)
                    most = std::max<size_t>(most, n), counts_.instructions += n;
                counts_.slots += most * lanes;
                for (const std::vector<Access>& together : site.accesses)
                    site.local ? addLocal(together) : addGlobal(together);
            }
    }
    void kernelEnd(const KernelInvocation* invocation) override {
        const char* path = getenv("PELLUCID_WARPS");
        FILE* file = path ? fopen(path, "a") : nullptr;
        if (!file) return;
        const Counts& c = counts_;
        fprintf(
            file,
            "{\"kernel\": \"%s\", \"groups\": %zu, \"items\": %zu, \"instructions\": %zu, \"slots\": %zu, "
            "\"loads\": %zu, \"sectors\": %zu, \"least\": %zu, \"moved\": %zu, \"local\": %zu, "
            "\"replays\": %zu}\n",
            invocation->getKernel()->getName().c_str(), c.groups, c.items, c.instructions, c.slots, c.loads,
            c.sectors, c.least, c.touched.size() * sector, c.local, c.replays);
        fclose(file);
    }

  private:
    Site& site(const WorkItem* item, const llvm::Instruction* instruction) {
        if (item != item_ || item->getWorkGroup() != group_) {
            item_ = item, group_ = item->getWorkGroup();
            const Size3 at = item->getLocalID();
            const size_t index = at.x + size_.x * (at.y + size_.y * at.z);
            lane_ = index % lanes, warp_ = index / lanes;
        }
        return warps_[warp_][instruction];
    }
    void access(const Memory* memory, const WorkItem* item, size_t address, size_t size) {
        const bool global = memory == (const Memory*)m_context->getGlobalMemory();
        if (!global && memory == item->getPrivateMemory()) return;
        Site& s = site(item, item->getCurrentInstruction());
        s.local = !global;
        const size_t time = s.accessed[lane_]++;
        if (time >= s.accesses.size()) s.accesses.resize(time + 1);
        s.accesses[time].push_back({address, size});
    }
    void addGlobal(const std::vector<Access>& together) {
        std::set<size_t> sectors, bytes;
        for (const Access& a : together)
            for (size_t i = a.address; i < a.address + a.size; ++i)
                sectors.insert(i / sector), bytes.insert(i);
        ++counts_.loads;
        counts_.sectors += sectors.size();
        counts_.least += (bytes.size() + sector - 1) / sector;
        counts_.touched.insert(sectors.begin(), sectors.end());
    }
    void addLocal(const std::vector<Access>& together) {
        std::set<size_t> words;
        for (const Access& a : together)
            for (size_t i = a.address / 4; i < (a.address + a.size + 3) / 4; ++i) words.insert(i);
        size_t in[banks] = {}, most = 1;
        for (const size_t word : words) most = std::max(most, ++in[word % banks]);
        const size_t least = (words.size() + banks - 1) / banks;
        ++counts_.local;
        counts_.replays += most - std::min(most, least);
    }

    Counts counts_;
    std::vector<Warp> warps_;
    Size3 size_;
    const WorkItem* item_ = nullptr;
    const WorkGroup* group_ = nullptr;
    size_t lane_ = 0, warp_ = 0;
};

}  // namespace

extern "C" void initializePlugins(Context* context) {
    context->registerPlugin(new Warps(context));
}
extern "C" void releasePlugins(Context*) {}
