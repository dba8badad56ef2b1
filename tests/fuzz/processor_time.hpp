// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <cstdlib>
#include <sys/resource.h>

namespace shearwake::fuzz {

/// Aborts at the end of its life if this process and its children have used more than 2 s of
/// processor time since the beginning. Processor time, because the fuzzers also run on busy
/// machines; libFuzzer ends inputs that block without using the processor.
class ProcessorTimeLimit {
public:
    ProcessorTimeLimit() = default;
    ~ProcessorTimeLimit() {
        const double used_s = processor_time_s() - start_s_;
        if (used_s > limit_s) {
            std::fprintf(stderr, "this input took %.1f s of processor time\n", used_s);
            std::abort();
        }
    }
    ProcessorTimeLimit(const ProcessorTimeLimit&) = delete;
    ProcessorTimeLimit& operator=(const ProcessorTimeLimit&) = delete;

private:
    static constexpr double limit_s = 2.0;

    static double processor_time_s() {
        double total_s = 0.0;
        for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
            rusage usage{};
            ::getrusage(who, &usage);
            for (const timeval& time : {usage.ru_utime, usage.ru_stime})
                total_s +=
                    static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
        }
        return total_s;
    }

    double start_s_ = processor_time_s();
};

} // namespace shearwake::fuzz
