// What reads the parsers themselves: help texts, `pellucid describe`, and messages about unknown options.
#pragma once
#include <CLI/CLI.hpp>

#include "command.h"

namespace pellucid::cli {

std::shared_ptr<CLI::FormatterBase> helpFormatter();

// After CLI::ExtrasError: which words are not expected, and what may have been meant.
std::string unknownOptions(const CLI::App& app);

}  // namespace pellucid::cli
