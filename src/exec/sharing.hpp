// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Whether short loops are faster on all threads or on one: nobody knows beforehand.
///
/// What a shared loop costs depends on how far apart the cores are (a word went there and
/// back in half a microsecond where it was measured) and on what else the machine does.
/// So a piece of work that is repeated is timed both ways, now and then, unless it takes
/// so long that its loops are no short ones. Results never depend on the choice.

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

}  // namespace noli
