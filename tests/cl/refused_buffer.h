// A call for whose nth buffer there is no memory.
#pragma once
#include <pellucid/pellucid.hpp>

#include "cl/cl_spy.h"

struct RefusedBuffer {
    bool struck = false;  // the call made so many
    PelError code = PEL_SUCCESS;
};

template <class Call>
RefusedBuffer refuseBuffer(int nth, const Call& call) {
    RefusedBuffer refused;
    spy::failAt(spy::Call::createBuffer, nth);
    try {
        call();
    } catch (const pellucid::Error& e) {
        refused.code = e.code();
    }
    refused.struck = spy::callsUntilFailure() <= 0;
    spy::failAt(spy::Call::none, 0);
    return refused;
}
