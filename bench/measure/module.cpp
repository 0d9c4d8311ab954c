#include "measure/module.h"

using namespace pellucid::bench;

extern "C" __attribute__((visibility("default"))) const Measurements pellucidMeasurements = {
    PELLUCID_VERSION, measureDevice,  measureCases,       measureMethods, measureFirst, measureStability,
    keepPictures,     judgeFirst,     makeTruth,          tuneLaunches,   firstUse,     describeHost,
    parseReport,      compareReports, describeComparison, summarize,      tuningText,   pageOf};
