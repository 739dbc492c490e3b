// A screen: it takes the signals of a clock at a time, checks their timing, and writes each frame to a file as PPM.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

[[noreturn]] inline void fail(const std::string& what) {
    std::fprintf(stderr, "%s\n", what.c_str());
    std::exit(1);
}

class Screen {
public:
    // frame1.ppm and so on go to the directory: frame 0 passes before the screen has seen a sync. Colours of so many
    // bits are widened to 8.
    Screen(std::string directory, unsigned frames, unsigned bits)
        : directory(std::move(directory)), frames(frames), scale(255 / ((1u << bits) - 1)) {}

    // The arguments of the simulation: a directory and a number of frames.
    static Screen of(int argc, char** argv, unsigned bits) {
        if (argc != 3) fail("usage: SIMULATION DIRECTORY FRAMES");
        return Screen(argv[1], (unsigned)std::strtoul(argv[2], nullptr, 10), bits);
    }

    // Whether all frames were seen; no clock after it is looked at.
    bool done() const { return written == frames; }

    void clock(bool hsync, bool vsync, bool visible, unsigned red, unsigned green, unsigned blue) {
        if (++now > (uint64_t)(frames + 3) * FRAME) fail("no frames are seen");
        if (was_hsync && !hsync) {
            if (line && now - line != LINE) fail("a line is not of 800 clocks");
            line = now;
        }
        if (was_vsync && !vsync) {
            if (frame && now - frame != FRAME) fail("a frame is not of 525 lines");
            if (frame) show();
            frame = now;
        }
        if (frame && visible) {
            // 96 clocks of sync and 48 of back porch before a line, 2 lines of sync and 33 of back porch before a frame. The
            // sync of a line comes before its row does.
            const uint64_t column = pixels.size() / 3 % COLUMNS, row = pixels.size() / 3 / COLUMNS;
            if (now - line != 96 + 48 + column || (now - frame) / LINE != 2 + 33 + row) {
                fail("a pixel is not in its place");
            }
            for (unsigned colour : {red, green, blue}) pixels.push_back((uint8_t)(colour * scale));
        } else if (frame && (red || green || blue)) {
            fail("a colour where nothing is visible");
        }
        was_hsync = hsync;
        was_vsync = vsync;
    }

private:
    static constexpr unsigned COLUMNS = 640, ROWS = 480, LINE = 800, FRAME = 800 * 525;

    // The frame that has ended.
    void show() {
        if (pixels.size() != (size_t)3 * COLUMNS * ROWS) fail("a frame is not of 640x480 pixels");
        const std::string name = directory + "/frame" + std::to_string(++written) + ".ppm";
        std::FILE* file = std::fopen(name.c_str(), "wb");
        if (!file) fail(name + " cannot be written");
        std::fprintf(file, "P6\n%u %u\n255\n", COLUMNS, ROWS);
        const bool whole = std::fwrite(pixels.data(), 1, pixels.size(), file) == pixels.size();
        if (std::fclose(file) != 0 || !whole) fail(name + " could not be written");
        pixels.clear();
    }

    const std::string directory;
    const unsigned frames, scale;
    std::vector<uint8_t> pixels;
    unsigned written = 0;
    uint64_t now = 0, line = 0, frame = 0;  // clocks: the latest, and those of the latest edges of the syncs
    bool was_hsync = false, was_vsync = false;
};
