// Compares results with kept ones, so that every change must be intended. PELLUCID_KEEP_PICTURES=1 keeps new
// ones, in tests/kept.
#pragma once
#include <gtest/gtest.h>

#include "tools.h"

class Draw {  // the same numbers everywhere
  public:
    explicit Draw(uint32_t seed) : random_(seed + 1) { random_.discard(20); }
    uint32_t below(uint32_t n) { return uint32_t(random_() % n); }
    float in(float low, float high) { return low + (high - low) * float(below(1000)) / 1000; }
    bool oneOf(uint32_t n) { return below(n) == 0; }
    std::vector<float> values(size_t count, float low, float high) {
        std::vector<float> all(count);
        for (float& value : all) value = in(low, high);
        return all;
    }

  private:
    std::minstd_rand random_;
};

class KeptSums {
  public:
    explicit KeptSums(const std::string& name) : name_(PELLUCID_SOURCE_DIR "/tests/kept/" + name) {
        if (std::getenv("PELLUCID_KEEP_PICTURES"))
            made_.open(name_);
        else
            kept_.open(name_);
    }
    ~KeptSums() {
        std::printf("largest difference from %s: %.2f of what is allowed\n", name_.c_str(), most_);
    }

    // Each of 24 sums takes a sixth of the values, of either sign, over the root of their number: one that
    // changed shows, and many that changed a little. `within`: the largest difference of a sum.
    template <class Values>
    void expect(const Values& values, double within, const std::string& what) {
        Draw draw(99);
        const double scale = std::sqrt(6.0 / double(std::max<size_t>(values.size(), 6)));
        double off = 0;
        for (int k = 0; k < 24; ++k) {
            double sum = 0, known = 0;
            for (const auto value : values)
                if (draw.oneOf(6)) sum += (draw.oneOf(2) ? scale : -scale) * double(value);
            char number[32];
            std::snprintf(number, sizeof number, "%.10g ", sum);
            if (made_.is_open()) {
                made_ << number;
                continue;
            }
            const bool comparable = (kept_ >> known) && !std::isnan(sum);
            off = std::max(off, comparable ? std::abs(sum - known) : double(INFINITY));
        }
        if (made_.is_open()) made_ << "\n";
        EXPECT_LT(off, within) << what << ", in " << name_;
        most_ = std::max(most_, off / within);
    }

    // Counts of work, where they were kept for such a device. `within`: by share, below 100 as of 100.
    void expectCounts(const std::vector<uint64_t>& counts, double within, const std::string& what) {
        if (!made_.is_open() && !kept_.is_open()) return;
        for (size_t i = 0; i < counts.size(); ++i) {
            uint64_t known = 0;
            if (made_.is_open()) {
                made_ << counts[i] << (i + 1 < counts.size() ? " " : "\n");
                continue;
            }
            ASSERT_TRUE(kept_ >> known) << what << ", in " << name_;
            const double off =
                std::abs(double(counts[i]) - double(known)) / double(std::max<uint64_t>(known, 100));
            EXPECT_LE(off, within) << what << ", count " << i << ": " << counts[i] << ", kept " << known
                                   << ", in " << name_;
            most_ = std::max(most_, off / within);
        }
    }

  private:
    std::string name_;
    std::ofstream made_;
    std::ifstream kept_;
    double most_ = 0;
};
