// Shared by all tests, in addition to tools.h: tolerances and expected errors.
#pragma once
#include <gtest/gtest.h>

#include "tolerances.h"
#include "tools.h"

// `call` returns an error or throws one; its message holds all of `words`.
template <class Call>
void expectRefused(PelError expected, const std::vector<const char*>& words, const Call& call) {
    PelError code = PEL_SUCCESS;
    if constexpr (std::is_same_v<std::invoke_result_t<Call>, PelError>) {
        code = call();
    } else {
        try {
            call();
        } catch (const pellucid::Error& e) {
            code = e.code();
        }
    }
    const std::string message = code == PEL_SUCCESS ? "no error" : pelGetErrorMessage();
    EXPECT_EQ(code, expected) << message;
    for (const char* word : words)
        EXPECT_NE(message.find(word), std::string::npos) << '"' << word << "\" in: " << message;
}

template <class Call>
void expectRefused(const std::vector<const char*>& words, const Call& call) {
    expectRefused(PEL_ERROR_INVALID_ARGUMENT, words, call);
}
template <class Call>
void expectRefused(const char* word, const Call& call) {
    expectRefused(std::vector{word}, call);
}

// The results of two programs for one frame.
inline void expectSameBits(const pellucid::Device& device, const std::vector<float>& a,
                           const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    const double most = device.info().type == PEL_DEVICE_CPU ? 0 : tolerance::otherProgram;
    for (size_t i = 0; i < a.size(); ++i)
        ASSERT_LE(std::abs(a[i] - b[i]), most * std::max(1.0, std::abs(double(b[i])))) << i;
}
