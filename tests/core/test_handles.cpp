// Handles of every type, used wrongly: released twice, used after their release, invented, of another
// type. Each is an error that says so, and no object suffers.
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>

#include "core/handle_kinds.h"

using handles::Handle;
using handles::Kind;
using handles::kinds;
using pellucid::check;
using pellucid::Device;
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
    // Whether exactly one error came since the last question, and says all of `parts`.
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

TEST_P(EachKind, CountsItsHolders) {
    Handle made = kind().create();
    for (int i = 0; i < 3; ++i) kind().retain(made);
    for (int i = 0; i < 3; ++i) {
        kind().release(made);
        EXPECT_EQ(kind().use(made), PEL_SUCCESS) << pelGetErrorMessage();
    }
    kind().release(made);
    EXPECT_EQ(kind().use(made), PEL_ERROR_INVALID_ARGUMENT);
}

TEST_P(EachKind, ReleasedTwiceIsAnError) {
    const Handle made = kind().create(), other = kind().create();
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
    const Handle made = kind().create();
    const std::function<bool()> works = kind().hold(made);
    for (int i = 0; i < 5; ++i) kind().release(made);
    EXPECT_TRUE(works());
    EXPECT_EQ(kind().use(made), PEL_ERROR_INVALID_ARGUMENT);
    EXPECT_TRUE(works());
}

TEST_P(EachKind, NoHandleIsGivenOutTwice) {
    std::set<Handle> seen;
    for (int i = 0; i < 300; ++i) {
        const Handle made = kind().create();
        EXPECT_TRUE(seen.insert(made).second);
        kind().release(made);
    }
    const Handle alive = kind().create();
    for (const Handle old : seen) EXPECT_EQ(kind().use(old), PEL_ERROR_INVALID_ARGUMENT);
    for (const Handle old : seen) kind().release(old);
    EXPECT_EQ(kind().use(alive), PEL_SUCCESS);
    kind().release(alive);
}

TEST_P(EachKind, OtherTypesAreNamed) {
    for (const Kind& other : kinds()) {
        const Handle made = other.create();
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
    const Handle made = kind().create();
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
                  [](uintptr_t v) { return v == 0 || handles::isLive(reinterpret_cast<Handle>(v)); });
    ASSERT_GT(invented.size(), 2000u);
    Heard heard;
    for (const uintptr_t v : invented) {
        const auto forged = reinterpret_cast<Handle>(v);
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

// More at a time than one piece of the table holds.
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

}  // namespace
