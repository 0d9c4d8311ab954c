// Lines and words of a text file, with line numbers for errors.
#pragma once
#include <cmath>
#include <vector>

#include "io/file_error.h"

namespace pellucid::io {

class TextScan {
  public:
    // `comment`: the character that begins a comment, or a line break if there are none. `linesBefore`:
    // lines of the file before `text`.
    TextScan(std::string path, std::string_view text, char comment = '#', int linesBefore = 0)
        : path_(std::move(path)), rest_(text), comment_(comment), line_(linesBefore) {
        if (constexpr std::string_view byteOrderMark = "\xEF\xBB\xBF"; rest_.starts_with(byteOrderMark))
            rest_.remove_prefix(byteOrderMark.size());
    }

    // The next line that has words, split at blanks, without comments. False at the end.
    bool nextLine() {
        while (!rest_.empty()) {
            ++line_;
            const size_t end = rest_.find('\n');
            const std::string_view text = rest_.substr(0, end);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
            split(text.substr(0, text.find(comment_)));
            if (!words_.empty()) return true;
        }
        return false;
    }

    const std::vector<std::string_view>& words() const { return words_; }
    int line() const { return line_; }
    [[noreturn]] void fail(const std::string& message) const { throw FileError(path_, message, line_); }

    // Word i of the line as a finite number. `what` names it in the error.
    float number(size_t i, std::string_view what) const {
        if (i >= words_.size())
            fail(concat(what, " is missing: the line has ", words_.size(), " entries, not ", i + 1));
        float value = 0;
        double wide = 1;  // what is too small for a float is 0
        if (!parse(words_[i], value) && !(parse(words_[i], wide) && std::abs(wide) < 1))
            fail(std::string(what) + " '" + std::string(words_[i]) + "' is not a number that fits a float");
        if (!std::isfinite(value))
            fail(std::string(what) + " is '" + std::string(words_[i]) +
                 "'; a finite number is needed (the mesh cannot be measured there)");
        return value;
    }

    long long integer(std::string_view word, std::string_view what) const {
        long long value = 0;
        if (!parse(word, value))
            fail(std::string(what) + " '" + std::string(word) + "' is not a whole number");
        return value;
    }

  private:
    template <class T>
    static bool parse(std::string_view word, T& value) {
        if (!word.empty() && word.front() == '+') word.remove_prefix(1);
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        return error == std::errc() && end == word.data() + word.size();
    }

    void split(std::string_view text) {
        words_.clear();
        constexpr std::string_view blanks = " \t\r\v\f";
        for (size_t at = text.find_first_not_of(blanks); at != std::string_view::npos;) {
            const size_t end = std::min(text.find_first_of(blanks, at), text.size());
            words_.push_back(text.substr(at, end - at));
            at = text.find_first_not_of(blanks, end);
        }
    }

    std::string path_;
    std::string_view rest_;
    std::vector<std::string_view> words_;
    char comment_;
    int line_;
};

}  // namespace pellucid::io
