// The nesting depth of a TOML file, checked before toml++ parses it. toml++ makes and destroys a table for
// each part of a key by recursion, and a key may have any number of parts.
#include "io/toml_reader.h"

namespace pellucid::io {
namespace {

// The formats here nest three levels.
constexpr int mostParts = 16, mostBrackets = 16;

class Depth {
  public:
    Depth(const std::string& file, std::string_view text) : file_(file), text_(text) {}

    // Dots and brackets outside strings and comments. Numbers have a dot or two: far from the limit.
    void check() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') {
                skipString(c);
                continue;
            }
            if (c == '#') {
                at_ = std::min(text_.find('\n', at_), text_.size());
                continue;
            }
            if (c == '[' || c == '{') ++brackets_;
            if ((c == ']' || c == '}') && brackets_ > 0) --brackets_;
            if (c == '\n') ++line_;
            if (c == '.') ++dots_;
            if (std::string_view("[]{}=,\n").find(c) != std::string_view::npos) dots_ = 0;
            if (dots_ >= mostParts) fail(concat("a key has more than ", mostParts, " parts"));
            if (brackets_ > mostBrackets)
                fail(concat("arrays and tables are nested more than ", mostBrackets, " deep"));
            ++at_;
        }
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw FileError(file_, what + "; nothing that is read here goes so deep", line_);
    }

    void skipString(char quote) {
        const bool several = text_.substr(at_, 3) == std::string(3, quote);
        for (at_ += several ? 3 : 1; at_ < text_.size(); ++at_) {
            const char c = text_[at_];
            if (c == '\\' && quote == '"') {
                ++at_;
                if (at_ < text_.size() && text_[at_] == '\n') ++line_;
            } else if (c == '\n') {
                if (!several) return;  // toml++ will refuse it
                ++line_;
            } else if (c == quote && !several) {
                ++at_;
                return;
            } else if (c == quote && text_.substr(at_, 3) == std::string(3, quote)) {
                at_ += 3;
                // Up to two quotes before the closing three belong to the string.
                for (int more = 0; more < 2 && at_ < text_.size() && text_[at_] == quote; ++more) ++at_;
                return;
            }
        }
    }

    const std::string& file_;
    std::string_view text_;
    size_t at_ = 0;
    int line_ = 1, brackets_ = 0, dots_ = 0;
};

}  // namespace

void checkTomlDepth(const std::string& file, std::string_view text) {
    Depth(file, text).check();
}

}  // namespace pellucid::io
