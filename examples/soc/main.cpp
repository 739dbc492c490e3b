// Runs the system until its program ends: the picture goes to the file that is named, as PPM.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "Vsoc.h"
#include "verilated.h"

// The numbers that the program prints: highlights, and clocks by the core, the model and the code by hand.
static void report(const std::vector<uint32_t>& numbers, uint64_t clocks) {
    const double points = numbers[0], core = numbers[1] / points;
    std::printf("%u highlights, %llu clocks in all\n", numbers[0], (unsigned long long)clocks);
    std::printf("the core:          %6.1f clocks a pixel\n", core);
    const char* const names[] = {"C by hand:", "the model in C:"};
    for (unsigned way : {0u, 1u}) {
        const double software = numbers[way == 0 ? 3 : 2] / points;
        std::printf("%-18s %6.1f clocks a pixel, %.1f times those of the core\n", names[way],
                    software, software / core);
    }
}

int main(int argc, char** argv) {
    constexpr unsigned WIDTH = 48, HEIGHT = 48;
    constexpr uint64_t MOST = 4'000'000'000;
    std::FILE* picture = argc == 2 ? std::fopen(argv[1], "wb") : nullptr;
    if (!picture) {
        std::fprintf(stderr, "usage: Vsoc PICTURE.ppm, a file that can be written\n");
        return 2;
    }
    std::fprintf(picture, "P6\n%u %u\n255\n", WIDTH, HEIGHT);
    Vsoc soc;
    std::vector<uint32_t> numbers;
    for (uint64_t clock = 0; clock < MOST; clock++) {
        soc.rst_n = clock >= 4;
        soc.clk = 0;
        soc.eval();
        soc.clk = 1;
        soc.eval();
        if (!soc.rst_n) continue;
        if (soc.picture_write) std::fputc((int)soc.written, picture);
        if (soc.number_write) numbers.push_back(soc.written);
        if (soc.failed) {
            std::fprintf(stderr, "the processor trapped, or the core refused an access\n");
            return 1;
        }
        if (soc.end_write) {
            const bool closed = std::fclose(picture) == 0;
            if (soc.written != 0 || numbers.size() != 4 || !closed) {
                std::fprintf(stderr, "the program ended with exit code %u\n", soc.written);
                return 1;
            }
            report(numbers, clock);
            return 0;
        }
    }
    std::fprintf(stderr, "the program does not end\n");
    return 1;
}
