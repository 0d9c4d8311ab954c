// The one exception of host/io: a file that cannot be read or written.
#pragma once
#include <stdexcept>
#include <utility>

#include "io/concat.h"

namespace pellucid::io {

// what() reads "FILE:LINE: message"; the message says what was wrong, where, and what would be right.
class FileError : public std::runtime_error {
  public:
    explicit FileError(std::string file, const std::string& message, int line = 0)
        : std::runtime_error(printable(place(file, line).append(": ").append(message))),
          file_(std::move(file)),
          line_(line) {}

    const std::string& file() const { return file_; }
    int line() const { return line_; }  // 1-based; 0 if no line is to blame

  private:
    static std::string place(std::string file, int line) {
        if (line > 0) file.append(":").append(std::to_string(line));
        return file;
    }

    std::string file_;
    int line_;
};

}  // namespace pellucid::io
