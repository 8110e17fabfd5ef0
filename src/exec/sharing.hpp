// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Whether short loops are faster on all threads or on one: nobody knows beforehand.
///
/// What a shared loop costs depends on how far apart the cores are (a word went there and
/// back in half a microsecond where it was measured) and on what else the machine does.
/// So a piece of work that is repeated is timed both ways, now and then, unless it takes
/// so long that its loops are no short ones. Results never depend on the choice.
/// `Sharing` is for pieces that are alike, `SharingOfSteps` for those that are not.

#include "core/timer.hpp"
#include "exec/team.hpp"

#include <algorithm>

namespace noli {

class Sharing {
  public:
    /// How the next piece of work is to be done.
    [[nodiscard]] bool shared() const {
        return trying_ ? !shared_is_best_ : shared_is_best_;
    }

    /// What that piece took.
    void took(double seconds) {
        // The first one moves data between the caches of the cores.
        if (count_ > 0) least_ = std::min(least_, seconds);
        if (++count_ < (trying_ ? kTrial : period_)) return;
        count_ = 0;
        const double least = least_;
        least_ = kNone;
        if (!trying_ && shared_is_best_ && least >= kLong) return;
        if (!trying_) {
            least_of_best_ = least;
            trying_ = true;
            return;
        }
        trying_ = false;
        if (least < least_of_best_) {
            shared_is_best_ = !shared_is_best_;
            period_ = kShortest;
        } else {
            period_ = std::min(2 * period_, kLongest);
        }
    }

  private:
    static constexpr int kTrial = 4;
    static constexpr int kShortest = 32;
    static constexpr int kLongest = 2048;
    static constexpr double kNone = 1e300;
    static constexpr double kLong = 1e-3;  ///< seconds, of a piece that is always shared
    bool shared_is_best_ = true;
    bool trying_ = false;
    int count_ = 0;
    int period_ = kTrial;  ///< pieces between trials
    double least_ = kNone, least_of_best_ = kNone;
};

/// The same for pieces that differ: time steps, which come with a measure of what there
/// was to do. In a trial one step goes the other way and is compared with the two beside
/// it, so that costs which grow from step to step decide nothing. Two trials that agree
/// change the way.
class SharingOfSteps {
  public:
    /// `small`: begins with one thread. What takes `long_time` seconds per work on all
    /// threads always has them.
    SharingOfSteps(bool small, double long_time)
        : long_time_(long_time), shared_is_best_(!small) {}

    /// How the next step is to be done.
    [[nodiscard]] bool shared() const {
        return others_turn() ? !shared_is_best_ : shared_is_best_;
    }

    /// What that step took, and its work.
    void took(double seconds, double work) {
        if (left_ == 0) {
            const bool long_loops = shared_is_best_ && seconds >= long_time_ * work;
            if (!long_loops && (++count_ >= period_ || is_another(seconds, work)))
                begin_trial();
            return;
        }
        Way& way = others_turn() ? other_ : best_;
        way.seconds += seconds;
        way.work += work;
        if (--left_ == 0) decide();
    }

  private:
    struct Way {
        double seconds = 0.0, work = 0.0;
    };

    [[nodiscard]] bool others_turn() const { return left_ == 2; }
    /// True if that work takes clearly more or less time than it took in the last trial.
    [[nodiscard]] bool is_another(double seconds, double work) const {
        if (count_ < kShortest / 2 || best_.work == 0.0) return false;
        const double now = seconds * best_.work;
        const double then = best_.seconds * work;
        return now > kAnother * then || then > kAnother * now;
    }
    void begin_trial() {
        count_ = 0;
        best_ = other_ = {};
        left_ = kTrial;
    }
    void decide() {
        const double best = best_.seconds * other_.work;
        const double other = other_.seconds * best_.work;
        if (other >= kClearly * best) {
            agreeing_ = 0;
            period_ =
                std::clamp((other > kFar * best ? 4 : 2) * period_, kShortest, kLongest);
        } else if (++agreeing_ < kTrials) {
            period_ = 1;
        } else {
            agreeing_ = 0;
            shared_is_best_ = !shared_is_best_;
            best_ = other_;
            period_ = kShortest;
        }
    }

    static constexpr int kTrial = 3;     ///< steps
    static constexpr int kTrials = 2;    ///< that agree
    static constexpr int kShortest = 8;  ///< steps between trials
    static constexpr int kLongest = 256;
    static constexpr double kClearly = 0.95;
    static constexpr double kFar = 1.2;
    static constexpr double kAnother = 1.4;
    double long_time_;
    bool shared_is_best_;
    int left_ = 0;               ///< steps of a trial
    int count_ = kShortest - 2;  ///< the first trial comes early
    int period_ = kShortest;
    int agreeing_ = 0;
    Way best_, other_;  ///< in the last trial
};

/// Runs f, a time step, with its loops on all threads or on this one. f takes the number
/// of threads and returns how much work there was, in any unit. A device, whose number is
/// 0, has no such choice.
template <class Exec, class F>
void share_if_faster(SharingOfSteps& sharing, const F& f) {
    if constexpr (Exec::kIsDevice) {
        f(0);
    } else if (Exec::threads() == 1) {
        f(1);
    } else {
        const bool shared = sharing.shared();
        double seconds = 0.0;
        double work = 0.0;
        {
            const AloneScope scope(!shared);
            const PhaseTimer timer(seconds);
            work = f(shared ? Exec::threads() : 1);
        }
        sharing.took(seconds, work);
    }
}

}  // namespace noli
