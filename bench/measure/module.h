// What `pellucid bench` and `pellucid tune` measure, as a module that these commands load. It is a quarter of
// what there is to compile for the command, and the others need none of it.
#pragma once
#include "measure/measure.h"
#include "measure/report.h"

namespace pellucid::bench {

// The functions of measure.h and report.h. Exceptions pass through.
struct Measurements {
    const char* version;  // of Pellucid
    decltype(&bench::measureDevice) measureDevice;
    decltype(&bench::measureCases) measureCases;
    decltype(&bench::measureMethods) measureMethods;
    decltype(&bench::measureFirst) measureFirst;
    decltype(&bench::measureStability) measureStability;
    decltype(&bench::keepPictures) keepPictures;
    decltype(&bench::judgeFirst) judgeFirst;
    decltype(&bench::makeTruth) makeTruth;
    decltype(&bench::tuneLaunches) tuneLaunches;
    decltype(&bench::firstUse) firstUse;
    decltype(&bench::describeHost) describeHost;
    decltype(&bench::parseReport) parseReport;
    decltype(&bench::compareReports) compareReports;
    decltype(&bench::describeComparison) describeComparison;
    decltype(&bench::summarize) summarize;
    decltype(&bench::tuningText) tuningText;
    decltype(&bench::pageOf) pageOf;
};

}  // namespace pellucid::bench
