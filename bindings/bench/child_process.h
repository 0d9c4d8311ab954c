// A program in a process of its own, heard line by line, for as long as one is willing to wait.
#pragma once
#include <sys/types.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace pellucid::bench {

class ChildProcess {
  public:
    // `environment`: set there beside this process's own. Not `loud`: what it says on standard error is thrown away.
    ChildProcess(std::vector<std::string> command,
                 const std::vector<std::pair<std::string, std::string>>& environment, bool loud);
    ~ChildProcess();  // ends it
    ChildProcess(const ChildProcess&) = delete;

    // The next line of its standard output: `heard`; `ended`: there is no more; `silent`: none within so many seconds, or
    // `cancelled` returned true.
    enum class Answer { heard, ended, silent };
    Answer next(std::string& line, double seconds, const std::function<bool()>& cancelled);

    // Waits for its end. "" when all went well, else "ended by signal 11 (Segmentation fault)" and the like.
    std::string ending();

  private:
    pid_t process_ = -1;
    int pipe_ = -1;
    std::string heard_;  // beyond the last line
};

}  // namespace pellucid::bench
