// Where a long computation has to stop.
#pragma once

#include <chrono>
#include <functional>
#include <utility>

namespace bifurc {

// The moment ``seconds`` after it was made, which may be infinitely many. About every 50 ms in
// which somebody asks, ``pause`` is called: it may throw, for Ctrl-C.
class Deadline {
public:
    explicit Deadline(
        double seconds, std::function<void()> pause = [] {})
        : seconds_(seconds), pause_(std::move(pause)), began_(Clock::now()), last_pause_(began_) {}

    bool has_passed() {
        const auto now = Clock::now();
        if (now - last_pause_ > std::chrono::milliseconds(50)) {
            last_pause_ = now;
            pause_();
        }
        return std::chrono::duration<double>(now - began_).count() >= seconds_;
    }

private:
    using Clock = std::chrono::steady_clock;

    double seconds_;
    std::function<void()> pause_;
    Clock::time_point began_;
    Clock::time_point last_pause_;
};

}  // namespace bifurc
