// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An executor that sets a stop flag when a loop of a given name has run for the k-th
/// time: a request to stop that comes at the same moment in every run.

#include <atomic>
#include <string>

namespace noli::test {

/// When to stop, for all executors of the program; `left` 0: never.
struct StopPlan {
    std::string loop;
    int left = 0;
    std::atomic<bool> stop{false};

    static StopPlan& get() {
        static StopPlan plan;
        return plan;
    }
    static void set(const std::string& loop, int count) {
        get().loop = loop;
        get().left = count;
        get().stop = false;
    }
    void ran(const char* name) {
        if (left > 0 && loop == name && --left == 0) stop = true;
    }
};

template <class Base>
class StoppingExec : public Base {
  public:
    template <class F>
    void for_each(const char* name, int n, F f, int grain = 128) {
        Base::for_each(name, n, f, grain);
        StopPlan::get().ran(name);
    }
};

}  // namespace noli::test
