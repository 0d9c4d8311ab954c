// A plugin of Oclgrind (oclgrind --plugins) that follows, byte by byte in memory and lane by lane in
// values, what nothing has set, and reports where it decides something: a branch, an address, a lane picked
// by number, or a value stored in global memory. It also writes down which kernels ran and every report, so
// that processes started by a test count as well.
//
// Oclgrind 21.10 has --uninitialized for this, but that takes lanes 11 to 13 of a shuffle for undefined
// ones, crashes where a shuffle leaves lanes open, and mixes up buffers that reuse the place of released
// ones.
//
// PELLUCID_OCLGRIND_DIR: the folder for the files reports, kernels.
#include <mutex>
#include <unordered_set>

#include "Context.h"
#include "Kernel.h"
#include "KernelInvocation.h"
#include "Memory.h"
#include "Plugin.h"
#include "WorkItem.h"
#include "lanes.h"
#include "llvm/IR/Constants.h"
#include "llvm/IR/Instructions.h"

using namespace oclgrind;

namespace {

class Defined : public Plugin {
  public:
    using Plugin::Plugin;
    bool isThreadSafe() const override { return false; }

    void memoryAllocated(const Memory* memory, size_t address, size_t size, cl_mem_flags,
                         const uint8_t* initial) override {
        if (memory == m_context->getGlobalMemory()) endWithoutReleasing();
        std::lock_guard lock(mutex_);
        auto& buffers = memories_[memory];
        const size_t index = memory->extractBuffer(address);
        if (buffers.size() <= index) buffers.resize(index + 1);
        buffers[index].assign(size, initial ? 0 : 1);
    }
    void memoryDeallocated(const Memory* memory, size_t address) override {
        std::lock_guard lock(mutex_);
        auto& buffers = memories_[memory];
        const size_t index = memory->extractBuffer(address);
        if (index < buffers.size()) std::vector<uint8_t>().swap(buffers[index]);
    }
    void hostMemoryLoad(const Memory* memory, size_t address, size_t size) override {
        hostLoad = {memory, address, size};
    }
    // Also the copies between buffers: a load, then a store of what was loaded.
    void hostMemoryStore(const Memory* memory, size_t address, size_t size, const uint8_t* data) override {
        std::lock_guard lock(mutex_);
        uint8_t* to = bytes(memory, address, size);
        if (!to) return;
        const uint8_t* from = hostLoad.size == size && hostLoad.memory->getPointer(hostLoad.address) == data
                                  ? bytes(hostLoad.memory, hostLoad.address, size)
                                  : nullptr;
        from ? (void)memmove(to, from, size) : (void)memset(to, 0, size);
        hostLoad = {};
    }
    void memoryMap(const Memory* memory, size_t address, size_t offset, size_t size,
                   cl_map_flags flags) override {
        std::lock_guard lock(mutex_);
        if (!(flags & (CL_MAP_WRITE | CL_MAP_WRITE_INVALIDATE_REGION))) return;
        if (uint8_t* to = bytes(memory, address + offset, size)) memset(to, 0, size);
    }
    void memoryLoad(const Memory* memory, const WorkItem*, size_t address, size_t size) override {
        loads.push_back({memory, address, size});
    }
    void memoryStore(const Memory* memory, const WorkItem*, size_t address, size_t size,
                     const uint8_t*) override {
        stores.push_back({memory, address, size});
    }
    // Of a whole work-group: asynchronous copies.
    void memoryStore(const Memory* memory, const WorkGroup*, size_t address, size_t size,
                     const uint8_t*) override {
        std::lock_guard lock(mutex_);
        if (uint8_t* to = bytes(memory, address, size)) memset(to, 0, size);
    }
    void memoryAtomicLoad(const Memory* memory, const WorkItem*, AtomicOp, size_t address,
                          size_t size) override {
        loads.push_back({memory, address, size});
    }
    void memoryAtomicStore(const Memory* memory, const WorkItem*, AtomicOp, size_t address,
                           size_t size) override {
        stores.push_back({memory, address, size});
    }
    void kernelBegin(const KernelInvocation* invocation) override {
        endWithoutReleasing();
        std::lock_guard lock(mutex_);
        reported_.clear();
        const std::string name = invocation->getKernel()->getName();
        if (kernels_.insert(name).second) append("kernels", name + "\n");
    }
    void kernelEnd(const KernelInvocation*) override {
        std::lock_guard lock(mutex_);
        items_.clear();
    }
    void workItemComplete(const WorkItem* item) override {
        std::lock_guard lock(mutex_);
        items_.erase(item);
    }
    void log(MessageType type, const char* message) override {
        if (type == WARNING || type == ERROR) append("reports", std::string("\n") + message + "\n");
    }
    void instructionExecuted(const WorkItem* item, const llvm::Instruction* instruction,
                             const TypedValue&) override {
        {
            std::lock_guard lock(mutex_);
            item_ = item, values_ = &items_[item], instruction_ = instruction;
            follow();
        }
        loads.clear(), stores.clear();
        if (!message_.empty()) {
            Context::Message report(WARNING, m_context);
            report << message_ << std::endl
                   << report.INDENT << "Kernel: " << report.CURRENT_KERNEL << std::endl
                   << "Entity: " << report.CURRENT_ENTITY << std::endl
                   << report.CURRENT_LOCATION << std::endl;
            message_.clear();
            report.send();
        }
    }

  private:
    using Values = std::unordered_map<const llvm::Value*, Lanes>;  // those with lanes that nothing has set

    std::mutex mutex_;
    // 1: nothing has set this byte
    std::unordered_map<const Memory*, std::vector<std::vector<uint8_t>>> memories_;
    std::unordered_map<const WorkItem*, Values> items_;
    std::unordered_set<const llvm::Instruction*> reported_;
    std::unordered_set<std::string> kernels_;
    const WorkItem* item_;
    Values* values_;
    const llvm::Instruction* instruction_;
    std::string message_;

    // Null beyond the memory, which Oclgrind itself reports.
    uint8_t* bytes(const Memory* memory, size_t address, size_t size) {
        const auto buffers = memories_.find(memory);
        const size_t index = memory->extractBuffer(address), offset = memory->extractOffset(address);
        if (buffers == memories_.end() || index >= buffers->second.size()) return nullptr;
        std::vector<uint8_t>& buffer = buffers->second[index];
        return offset + size <= buffer.size() ? buffer.data() + offset : nullptr;
    }

    Lanes unset(const llvm::Value* value) const {
        if (llvm::isa<llvm::Instruction>(value) || llvm::isa<llvm::Argument>(value)) {
            if (values_->empty()) return 0;
            const auto found = values_->find(value);
            return found == values_->end() ? 0 : found->second;
        }
        if (llvm::isa<llvm::UndefValue>(value)) return everyLane(value);
        Lanes lanes = 0;
        if (const auto* vector = llvm::dyn_cast<llvm::ConstantVector>(value))
            for (unsigned i = 0; i < countLanes(value->getType()); ++i)
                lanes |= Lanes(llvm::isa<llvm::UndefValue>(vector->getOperand(i))) << i;
        return lanes;
    }
    Lanes unset(unsigned operand) const { return unset(instruction_->getOperand(operand)); }
    void set(const llvm::Value* value, Lanes lanes) {
        if (lanes)
            (*values_)[value] = lanes;
        else if (!values_->empty())
            values_->erase(value);
    }
    void result(Lanes lanes) { set(instruction_, lanes); }
    TypedValue operand(unsigned i) const { return item_->getOperand(instruction_->getOperand(i)); }

    void report(const std::string& message) {
        if (reported_.insert(instruction_).second) message_ = message;
    }
    void needs(Lanes lanes, const char* what) {
        if (lanes) report(std::string(what) + " depends on a value that nothing has set");
    }

    // The lanes of a result made of the bytes that were read, in order.
    Lanes loaded(unsigned lanes) {
        size_t total = 0, at = 0;
        for (const Access& a : loads) total += a.size;
        Lanes found = 0;
        for (const Access& a : loads) {
            const uint8_t* from = bytes(a.memory, a.address, a.size);
            for (size_t i = 0; i < a.size && from; ++i)
                if (from[i])
                    found |= total % lanes ? everyLane(lanes) : Lanes(1) << (at + i) / (total / lanes);
            at += a.size;
        }
        return found;
    }
    // The bytes that were written, in order, made of the lanes of a value.
    void stored(Lanes unsetLanes, unsigned lanes) {
        size_t total = 0, at = 0;
        for (const Access& a : stores) total += a.size;
        for (const Access& a : stores) {
            const bool global = a.memory->getAddressSpace() == AddrSpaceGlobal;
            if (unsetLanes && global) report("a value that nothing has set is stored in global memory");
            uint8_t* to = bytes(a.memory, a.address, a.size);
            for (size_t i = 0; i < a.size && to; ++i)
                to[i] = global || !unsetLanes ? 0
                        : total % lanes       ? 1
                                              : bit(unsetLanes, (at + i) / (total / lanes));
            at += a.size;
        }
    }

    void follow() {
        const llvm::Instruction& in = *instruction_;
        switch (in.getOpcode()) {
            case llvm::Instruction::Alloca:
                return result(0);
            case llvm::Instruction::Freeze:
                return result(0);
            case llvm::Instruction::Br:
                return needs(in.getNumOperands() > 1 ? unset(0u) : 0, "a branch");
            case llvm::Instruction::Switch:
                return needs(unset(0u), "a branch");
            case llvm::Instruction::Call:
                return followCall(llvm::cast<llvm::CallInst>(in));
            case llvm::Instruction::Ret:
                return followReturn();
            case llvm::Instruction::Load:
                needs(unset(0u), "an address that is read");
                return result(loaded(countLanes(in.getType())));
            case llvm::Instruction::Store:
                needs(unset(1), "an address that is written");
                return stored(unset(0u), countLanes(in.getOperand(0)->getType()));
            case llvm::Instruction::PHI:
                return result(
                    unset(llvm::cast<llvm::PHINode>(in).getIncomingValueForBlock(item_->getPreviousBlock())));
            default:
                break;
        }
        // Nothing open anywhere, as nearly always.
        Lanes any = 0;
        for (const llvm::Value* value : in.operands()) any |= unset(value);
        const bool shuffle = in.getOpcode() == llvm::Instruction::ShuffleVector;
        if (!any && !shuffle) return result(0);
        const unsigned lanes = countLanes(in.getType());
        switch (in.getOpcode()) {
            case llvm::Instruction::And:
                return result(unlessDecided(0));
            case llvm::Instruction::Or:
                return result(unlessDecided(-1));
            case llvm::Instruction::GetElementPtr:
                return result(any ? everyLane(lanes) : 0);
            case llvm::Instruction::BitCast: {
                const unsigned from = countLanes(in.getOperand(0)->getType());
                if (from == lanes) return result(any);
                Lanes to = 0;
                for (unsigned i = 0; i < from * lanes; ++i)
                    if (bit(any, i / lanes)) to |= Lanes(1) << i / from;
                return result(to);
            }
            case llvm::Instruction::ExtractElement:
                needs(unset(1), "the number of a lane");
                return result(bit(unset(0u), unsigned(operand(1).getUInt())));
            case llvm::Instruction::InsertElement: {
                needs(unset(2), "the number of a lane");
                const Lanes lane = Lanes(1) << operand(2).getUInt();
                return result((unset(0u) & ~lane) | (unset(1) ? lane : 0));
            }
            case llvm::Instruction::ShuffleVector: {
                const auto& mask = llvm::cast<llvm::ShuffleVectorInst>(in).getShuffleMask();
                const unsigned half = countLanes(in.getOperand(0)->getType());
                Lanes to = 0;
                for (unsigned i = 0; i < lanes; ++i)
                    if (mask[i] < 0 ||
                        (unsigned(mask[i]) < half ? bit(unset(0u), mask[i]) : bit(unset(1), mask[i] - half)))
                        to |= Lanes(1) << i;
                return result(to);
            }
            case llvm::Instruction::Select: {
                const bool each = in.getOperand(0)->getType()->isVectorTy();
                const TypedValue condition = operand(0);
                Lanes to = each ? unset(0u) : unset(0u) ? everyLane(lanes) : 0;
                for (unsigned i = 0; i < lanes; ++i)
                    if (bit(unset(condition.getUInt(each ? i : 0) ? 1 : 2), i)) to |= Lanes(1) << i;
                return result(to);
            }
            default:
                return result(any);  // lane by lane: arithmetic, comparisons, conversions
        }
    }

    // Zero decides a conjunction, ones a disjunction, whatever the other side is.
    Lanes unlessDecided(int64_t deciding) const {
        Lanes open = unset(0u) | unset(1);
        for (unsigned side = 0; side < 2; ++side) {
            const TypedValue value = operand(side);
            const int64_t decided =
                instruction_->getType()->getScalarSizeInBits() == 1 ? deciding & 1 : deciding;
            for (unsigned i = 0; i < value.num; ++i)
                if (!bit(unset(side), i) && value.getSInt(i) == decided) open &= ~(Lanes(1) << i);
        }
        return open;
    }

    void followReturn() {
        // By now the caller's instruction is the current one, unless it was the kernel that ended.
        const llvm::Instruction* call = item_->getCurrentInstruction();
        if (call == instruction_ || instruction_->getNumOperands() == 0) return;
        set(call, unset(0u));
    }

    void followCall(const llvm::CallInst& call) {
        const llvm::Function* function = call.getCalledFunction();
        const unsigned lanes = countLanes(call.getType());
        if (!function->isDeclaration()) {
            for (const llvm::Argument& argument : function->args()) {
                const llvm::Value* given = call.getArgOperand(argument.getArgNo());
                set(&argument, unset(given));
                if (!argument.hasByValAttr()) continue;
                const size_t size = getTypeSize(argument.getType()->getPointerElementType());
                const Memory* memory = item_->getPrivateMemory();
                const uint8_t* from = bytes(memory, item_->getOperand(given).getPointer(), size);
                uint8_t* to = bytes(memory, item_->getOperand(&argument).getPointer(), size);
                if (from && to) memcpy(to, from, size);
            }
            return;
        }
        std::string name = function->getName().str();
        const auto is = [&](const char* prefix) { return name.compare(0, strlen(prefix), prefix) == 0; };
        if (is("llvm.dbg") || is("llvm.lifetime")) return;
        if (is("_Z")) {
            size_t digits = 0;
            const int length = std::stoi(name.substr(2), &digits);
            name = name.substr(2 + digits, length);
        }
        Lanes any = 0;
        for (unsigned i = 0; i < call.arg_size(); ++i) {
            const Lanes open = unset(i);
            if (open && call.getArgOperand(i)->getType()->isPointerTy()) needs(open, "an address");
            any |= open;
        }
        if (is("llvm.mem")) {
            if (is("llvm.memset")) return stored(unset(1), 1);
            const size_t size = loads.empty() || stores.empty() ? 0 : loads[0].size;
            const uint8_t* from = size ? bytes(loads[0].memory, loads[0].address, size) : nullptr;
            uint8_t* to = size ? bytes(stores[0].memory, stores[0].address, size) : nullptr;
            if (from && to) memmove(to, from, size);
            return;
        }
        if (is("vload")) {
            needs(unset(0u), "an address that is read");
            return result(loaded(lanes));
        }
        if (is("vstore")) {
            needs(unset(1), "an address that is written");
            return stored(unset(0u), countLanes(call.getArgOperand(0)->getType()));
        }
        if (!loads.empty() || !stores.empty()) {  // atomics, and those with a second result in memory
            const Lanes read = loaded(1);
            stored(read | any ? everyLane(1) : 0, 1);
            return result(is("atom") ? read : any ? everyLane(lanes) : 0);
        }
        if (call.getType()->isVoidTy() || (!any && name != "shuffle" && name != "shuffle2")) return result(0);
        if (name == "select") return result(selected());
        if (name == "shuffle" || name == "shuffle2") return result(shuffled(name == "shuffle" ? 1 : 2));
        Lanes to = 0;
        for (unsigned i = 0; i < call.arg_size(); ++i)
            to |= countLanes(call.getArgOperand(i)->getType()) == lanes ? unset(i)
                  : unset(i)                                            ? everyLane(lanes)
                                                                        : 0;
        const bool mixes = name == "cross" || name == "normalize" || name == "fast_normalize";
        result(mixes && to ? everyLane(lanes) : to);
    }

    Lanes selected() const {
        const TypedValue condition = operand(2);
        Lanes to = unset(2);
        for (unsigned i = 0; i < condition.num; ++i) {
            const bool second = condition.num > 1 ? condition.getSInt(i) < 0 : condition.getUInt() != 0;
            if (bit(unset(second ? 1 : 0), i)) to |= Lanes(1) << i;
        }
        return to;
    }
    Lanes shuffled(unsigned sources) const {
        const TypedValue mask = operand(sources);
        const unsigned half = countLanes(instruction_->getOperand(0)->getType());
        Lanes to = unset(sources);
        for (unsigned i = 0; i < mask.num; ++i) {
            const unsigned lane = mask.getUInt(i) % (sources * half);
            if (bit(unset(lane / half), lane % half)) to |= Lanes(1) << i;
        }
        return to;
    }
};

std::map<const Context*, Defined*>& plugins() {
    static auto& all = *new std::map<const Context*, Defined*>;
    return all;
}

}  // namespace

extern "C" void initializePlugins(Context* context) {
    context->registerPlugin(plugins()[context] = new Defined(context));
}

extern "C" void releasePlugins(Context* context) {
    const auto found = plugins().find(context);
    if (found == plugins().end()) return;
    context->unregisterPlugin(found->second);
    delete found->second;
    plugins().erase(found);
}
