// Handles of every type, used wrongly: released twice, used after their release, invented, of another type,
// by many threads. Each use is an error that names the mistake, and no object is damaged.
#include "core/handle_kinds.h"
#include "core/on_threads.h"

using AnyHandle = handles::Handle;
using handles::Kind;
using handles::kinds;
using pellucid::check;
using pellucid::Profile;

namespace {

struct Heard {
    std::vector<std::pair<PelError, std::string>> errors;
    Heard() {
        pelSetErrorCallback(
            [](void* user, PelError error, const char* message) {
                static_cast<Heard*>(user)->errors.emplace_back(error, message);
            },
            this);
    }
    ~Heard() { pelSetErrorCallback(nullptr, nullptr); }
    // Whether exactly one error came since the last check, and its message has all of `parts`.
    testing::AssertionResult once(const std::vector<std::string>& parts) {
        const auto all = std::exchange(errors, {});
        if (all.size() != 1) return testing::AssertionFailure() << all.size() << " errors";
        if (all[0].first != PEL_ERROR_INVALID_ARGUMENT)
            return testing::AssertionFailure() << pelErrorName(all[0].first);
        for (const std::string& part : parts)
            if (all[0].second.find(part) == std::string::npos)
                return testing::AssertionFailure() << all[0].second << " does not say " << part;
        if (all[0].second != pelGetErrorMessage())
            return testing::AssertionFailure() << "another message: " << pelGetErrorMessage();
        return testing::AssertionSuccess();
    }
};

class EachKind : public testing::TestWithParam<size_t> {
  protected:
    const Kind& kind() const { return kinds()[GetParam()]; }
};

TEST_P(EachKind, ReleasedTwiceIsAnError) {
    const AnyHandle made = kind().create(), other = kind().create();
    kind().release(made);
    Heard heard;
    for (int i = 0; i < 3; ++i) {
        kind().release(made);
        EXPECT_TRUE(heard.once({kind().name, "released already"}));
        kind().retain(made);
        EXPECT_TRUE(heard.once({kind().name, "released already"}));
        EXPECT_EQ(kind().use(made), PEL_ERROR_INVALID_ARGUMENT);
        EXPECT_TRUE(heard.once({kind().name, "released already"}));
    }
    EXPECT_EQ(kind().use(other), PEL_SUCCESS);
    kind().release(other);
    EXPECT_EQ(heard.errors.size(), 0u);
}

// The library holds references of its own. However often the caller releases, these stay.
TEST_P(EachKind, InternalHoldersKeepTheirs) {
    const AnyHandle made = kind().create();
    const std::function<bool()> works = kind().hold(made);
    for (int i = 0; i < 5; ++i) kind().release(made);
    EXPECT_TRUE(works());
    EXPECT_EQ(kind().use(made), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_TRUE(works());
}

TEST_P(EachKind, NoHandleIsGivenOutTwice) {
    std::set<AnyHandle> seen;
    for (int i = 0; i < 300; ++i) {
        const AnyHandle made = kind().create();
        EXPECT_TRUE(seen.insert(made).second);
        kind().release(made);
    }
    const AnyHandle alive = kind().create();
    for (const AnyHandle old : seen) EXPECT_EQ(kind().use(old), PEL_ERROR_INVALID_ARGUMENT);
    for (const AnyHandle old : seen) kind().release(old);
    EXPECT_EQ(kind().use(alive), PEL_SUCCESS);
    kind().release(alive);
}

TEST_P(EachKind, OtherTypesAreNamed) {
    for (const Kind& other : kinds()) {
        const AnyHandle made = other.create();
        Heard heard;
        if (other.name != kind().name) {
            EXPECT_EQ(kind().use(made), PEL_ERROR_INVALID_ARGUMENT);
            EXPECT_TRUE(heard.once({"a " + kind().name, "not a " + other.name}));
            kind().retain(made);
            EXPECT_TRUE(heard.once({"a " + kind().name, "not a " + other.name}));
            for (int i = 0; i < 3; ++i) kind().release(made);
            EXPECT_EQ(heard.errors.size(), 3u);
        }
        EXPECT_EQ(other.use(made), PEL_SUCCESS);
        other.release(made);
        EXPECT_NE(other.use(made), PEL_SUCCESS) << "a refused retain left something behind";
    }
}

TEST_P(EachKind, InventedOnesAreRefused) {
    const AnyHandle made = kind().create();
    const auto value = reinterpret_cast<uintptr_t>(made);
    std::vector<uintptr_t> invented{
        1, 2, 7, 8, 4096, UINTPTR_MAX, UINTPTR_MAX >> 1, reinterpret_cast<uintptr_t>(&value)};
    for (uintptr_t near = 1; near <= 256; ++near) {
        invented.push_back(value + near);
        invented.push_back(value - near);
    }
    for (size_t bit = 0; bit < 8 * sizeof value; ++bit) invented.push_back(value ^ uintptr_t(1) << bit);
    std::mt19937_64 random(17);
    for (int i = 0; i < 1000; ++i) invented.push_back(uintptr_t(random()));
    for (int i = 0; i < 1000; ++i)
        invented.push_back(value ^ (uintptr_t(random()) >> random() % 60 << random() % 60));
    std::erase_if(invented,
                  [](uintptr_t v) { return v == 0 || handles::isLive(reinterpret_cast<AnyHandle>(v)); });
    ASSERT_GT(invented.size(), 2000u);
    Heard heard;
    for (const uintptr_t v : invented) {
        const auto forged = reinterpret_cast<AnyHandle>(v);
        ASSERT_EQ(kind().use(forged), PEL_ERROR_INVALID_ARGUMENT) << std::hex << v;
        kind().retain(forged);
        kind().release(forged);
    }
    EXPECT_EQ(heard.errors.size(), 3 * invented.size());
    EXPECT_EQ(kind().use(made), PEL_SUCCESS);
    kind().release(made);
    EXPECT_NE(kind().use(made), PEL_SUCCESS);
}

INSTANTIATE_TEST_SUITE_P(All, EachKind, testing::Range(size_t(0), kinds().size()),
                         [](const auto& info) { return kinds()[info.param].name; });

TEST(Handles, NullIsNoError) {
    Heard heard;
    for (const Kind& kind : kinds()) {
        kind.retain(nullptr);
        kind.release(nullptr);
    }
    EXPECT_EQ(heard.errors.size(), 0u);
}

// More handles at a time than one block of the table holds.
TEST(Handles, ManyAtATime) {
    std::vector<Profile> all;
    std::set<PelProfile> seen;
    for (int i = 0; i < 10000; ++i) {
        all.push_back(Profile::gaussians({{0.5f + float(i), {1, 1, 1}}}));
        seen.insert(all.back().get());
    }
    EXPECT_EQ(seen.size(), all.size());
    for (size_t i = 0; i < all.size(); i += 97) {
        double distance = 0.5, value[3], other[3];
        check(pelProfileEvaluate(all[i].get(), &distance, 1, value, nullptr));
        const Profile same = Profile::gaussians({{0.5f + float(i), {1, 1, 1}}});
        check(pelProfileEvaluate(same.get(), &distance, 1, other, nullptr));
        EXPECT_EQ(value[0], other[0]) << i;
    }
}

// --- that many threads make, use, retain and release at a time, rightly and wrongly ---

// PELLUCID_STRESS_SECONDS: for how long (./run check tsan); 2 by default.
constexpr int threadCount = 6;

std::chrono::steady_clock::time_point deadline(int parts) {
    const char* text = std::getenv("PELLUCID_STRESS_SECONDS");
    return std::chrono::steady_clock::now() +
           std::chrono::milliseconds(long((text ? std::atof(text) : 2) * 1000 / parts));
}

// Each place holds a handle. Every thread takes handles out, uses them and puts new ones in. A handle is
// released once, by whoever took it out; all else that is done to it meanwhile may be an error, or not.
TEST(HandleThreads, SharedPlaces) {
    const auto end = deadline(2);
    const size_t types = kinds().size(), each = 3;
    std::vector<std::atomic<void*>> places(types * each);
    for (size_t i = 0; i < places.size(); ++i) places[i] = kinds()[i % types].create();
    std::atomic<uint64_t> right{0}, refused{0}, lost{0};
    onThreads(threadCount, [&](unsigned t) {
        std::mt19937 random(t);
        // Longer where other programs keep the machine busy.
        while (std::chrono::steady_clock::now() < end || (right == 0 && refused < 1000000)) {
            const size_t at = random() % places.size();
            const Kind &kind = kinds()[at % types], &other = kinds()[random() % types];
            void* const h = places[at];
            switch (random() % 8) {
                case 0: {  // replaced: only now released by its one holder
                    void* const old = places[at].exchange(kind.create());
                    if (kind.use(old) != PEL_SUCCESS) ++lost;
                    kind.release(old);
                    break;
                }
                case 1:  // another type's call, or its own
                    other.use(h);
                    if (other.name != kind.name) other.release(h), other.retain(h);
                    break;
                case 2:  // long gone, or never there
                    kind.use(static_cast<char*>(h) + 2 * (random() % 64) - 64);
                    break;
                case 3: {  // one of its own beside
                    void* const own = kind.create();
                    kind.retain(own);
                    kind.release(own);
                    if (kind.use(own) != PEL_SUCCESS) ++lost;
                    kind.release(own);
                    if (kind.use(own) == PEL_SUCCESS) ++lost;
                    break;
                }
                default:
                    ++(kind.use(h) == PEL_SUCCESS ? right : refused);
            }
        }
    });
    EXPECT_EQ(lost, 0u);
    EXPECT_GT(right, 0u);
    for (size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(kinds()[i % types].use(places[i]), PEL_SUCCESS) << pelGetErrorMessage();
        kinds()[i % types].release(places[i]);
        EXPECT_NE(kinds()[i % types].use(places[i]), PEL_SUCCESS);
    }
}

// All threads release one handle that was retained once for each of them, and some release it again.
TEST(HandleThreads, OneReleaseTooMany) {
    const auto end = deadline(2);
    while (std::chrono::steady_clock::now() < end)
        for (const Kind& kind : kinds()) {
            void *const h = kind.create(), *const next = kind.create();
            for (int t = 1; t < threadCount; ++t) kind.retain(h);
            onThreads(threadCount, [&](unsigned t) {
                EXPECT_EQ(kind.use(h), PEL_SUCCESS);
                kind.release(h);
                if (t % 2) kind.use(h);
            });
            EXPECT_NE(kind.use(h), PEL_SUCCESS);
            void* const after = kind.create();  // where the other was
            onThreads(threadCount, [&](unsigned) { kind.release(h); });
            EXPECT_EQ(kind.use(next), PEL_SUCCESS);
            EXPECT_EQ(kind.use(after), PEL_SUCCESS);
            kind.release(next);
            kind.release(after);
        }
}

}  // namespace
