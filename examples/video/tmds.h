// A receiver of TMDS: it takes the four pairs of a connector, ten bits per pixel, and shows the pixels on a screen.
#pragma once

#include <array>
#include <cstdlib>

#include "screen.h"

struct Symbol {
    bool control;
    unsigned value;  // two syncs, or a colour
};

// DVI 1.0, 3.2: what the encoder's figure does, backwards.
inline Symbol decoded(unsigned word) {
    constexpr std::array<unsigned, 4> CONTROL = {0x354, 0x0ab, 0x154, 0x2ab};
    for (unsigned value = 0; value < CONTROL.size(); value++) {
        if (word == CONTROL[value]) return {true, value};
    }
    const unsigned bits = (word >> 9 & 1 ? ~word : word) & 0xff;
    const unsigned edges = (bits ^ bits << 1) & 0xff;
    return {false, word >> 8 & 1 ? edges : edges ^ 0xfe};
}

// Ones less zeros since the latest control symbol stay small: lines are coupled by capacitors.
inline void keep_balance(int& balance, unsigned word, bool control) {
    balance = control ? 0 : balance + 2 * __builtin_popcount(word) - 10;
    if (std::abs(balance) > 10) fail("a pair is not balanced");
}

class Receiver {
public:
    explicit Receiver(Screen screen) : screen(std::move(screen)) {}

    bool done() const { return screen.done(); }

    // Takes one bit of each pair: blue, green, red and the clock from bit 0 on. The first bit of a pixel comes with the rising
    // edge of the clock pair.
    void take(unsigned pairs) {
        const bool clock = pairs >> 3 & 1;
        if (!was && clock) {
            if (aligned) pixel();
            aligned = true;
            bits = 0;
            words = {};
        }
        for (unsigned pair = 0; pair < 3; pair++) words[pair] |= (pairs >> pair & 1u) << bits;
        bits++;
        was = clock;
    }

private:
    // The words of a pixel are complete.
    void pixel() {
        if (bits != 10) fail("a pixel is not of ten bits");
        Symbol symbols[3];
        for (unsigned pair = 0; pair < 3; pair++) symbols[pair] = decoded(words[pair]);
        // What is sent before the encoders have begun is nothing.
        begun = begun || symbols[0].control;
        for (unsigned pair = 0; begun && pair < 3; pair++) {
            keep_balance(balance[pair], words[pair], symbols[pair].control);
            if (symbols[pair].control != symbols[0].control) fail("pairs differ in what is visible");
        }
        const bool visible = begun && !symbols[0].control;
        if (!visible) syncs = symbols[0].value;
        screen.clock(syncs & 1, syncs >> 1 & 1, visible, visible ? symbols[2].value : 0,
                     visible ? symbols[1].value : 0, visible ? symbols[0].value : 0);
    }

    Screen screen;
    std::array<unsigned, 3> words{};
    std::array<int, 3> balance{};
    unsigned bits = 0, syncs = 0;
    bool was = true, aligned = false, begun = false;
};
