// A program in a process of its own, read line by line, with a limit on waiting.
#pragma once
#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace pellucid::bench {

class ChildProcess {
  public:
    // `environment`: variables added to this process's own. Without `loud` its standard error is discarded.
    ChildProcess(std::vector<std::string> command,
                 const std::vector<std::pair<std::string, std::string>>& environment, bool loud);
    ~ChildProcess();  // ends it
    ChildProcess(const ChildProcess&) = delete;

    // The next line of its standard output: `heard`; `ended`: there are no more; `silent`: none within so
    // many seconds, or `cancelled` returned true.
    enum class Answer { heard, ended, silent };
    Answer next(std::string& line, double seconds, const std::function<bool()>& cancelled);

    // Waits for its end. "" if all went well, otherwise "ended by signal 11 (Segmentation fault)" and the
    // like.
    std::string ending();

  private:
    pid_t process_ = -1;
    int pipe_ = -1;
    std::string heard_;  // beyond the last line
};

}  // namespace pellucid::bench
