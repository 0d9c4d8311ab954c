// A variable of the environment that is as before when this object ends.
#pragma once
#include "test.h"

class Variable {
  public:
    explicit Variable(const char* name) : name_(name) {
        if (const char* value = std::getenv(name)) before_ = value;
    }
    Variable(const char* name, const char* value) : Variable(name) { set(value); }
    Variable(const Variable&) = delete;
    ~Variable() { set(before_ ? before_->c_str() : nullptr); }
    // nullptr removes it.
    void set(const char* value) const { value ? ::setenv(name_, value, 1) : ::unsetenv(name_); }

  private:
    const char* name_;
    std::optional<std::string> before_;
};
