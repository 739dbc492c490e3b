// Runs the system until its program ends: its pictures go to shade.ppm, grain.ppm and lit.ppm.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "Vsoc.h"
#include "verilated.h"

namespace {

[[noreturn]] void fail(const char* what) {
    std::fprintf(stderr, "%s\n", what);
    std::exit(1);
}

std::FILE* begin(const char* name) {
    constexpr unsigned WIDTH = 48, HEIGHT = 48;
    std::FILE* picture = std::fopen(name, "wb");
    if (!picture) fail("the pictures cannot be written");
    std::fprintf(picture, "P6\n%u %u\n255\n", WIDTH, HEIGHT);
    return picture;
}

constexpr unsigned SERIES = 4, WAYS = 4, BY_HAND = 2;
const char* const NAMES[WAYS] = {"span engine:", "registers:", "C by hand:", "model in C:"};

// A series of pixels: how many there are, and the clocks of each way.
void report(const char* series, const uint32_t* numbers) {
    const double pixels = numbers[0];
    const uint32_t* const clocks = numbers + 1;
    std::printf("%s, %u pixels\n", series, numbers[0]);
    for (unsigned way = 0; way < WAYS; way++) {
        if (clocks[way] == 0) continue;
        std::printf("  %-12s %6.1f clocks a pixel", NAMES[way], clocks[way] / pixels);
        if (way < BY_HAND) std::printf(", C by hand %.1f times as many", (double)clocks[BY_HAND] / clocks[way]);
        std::printf("\n");
    }
}

constexpr unsigned FUNCTIONS = 3, FUNCTION_WAYS = 3;
const char* const FUNCTION_NAMES[FUNCTIONS] = {"rcp", "rsqrt", "atan2"};

// The clocks of each way to a function of the unit: an instruction, C by hand, the model in C.
void report_functions(const uint32_t* numbers) {
    const double values = numbers[0];
    for (unsigned function = 0; function < FUNCTIONS; function++) {
        const uint32_t* const clocks = numbers + 1 + function * FUNCTION_WAYS;
        std::printf("%s, %u values: an instruction %.1f clocks, C by hand %.1f, %.1f times as many, model in C %.1f\n",
                    FUNCTION_NAMES[function], numbers[0], clocks[0] / values, clocks[1] / values,
                    (double)clocks[1] / clocks[0], clocks[2] / values);
    }
}

}  // namespace

int main() {
    constexpr uint64_t MOST = 4'000'000'000;
    std::FILE* const shade = begin("shade.ppm");
    std::FILE* const grain = begin("grain.ppm");
    std::FILE* const lit = begin("lit.ppm");
    Vsoc soc;
    std::vector<uint32_t> numbers;
    for (uint64_t clock = 0; clock < MOST; clock++) {
        soc.rst_n = clock >= 4;
        soc.clk = 0;
        soc.eval();
        soc.clk = 1;
        soc.eval();
        if (!soc.rst_n) continue;
        if (soc.shade_write) std::fputc((int)soc.written, shade);
        if (soc.grain_write) std::fputc((int)soc.written, grain);
        if (soc.lit_write) std::fputc((int)soc.written, lit);
        if (soc.number_write) numbers.push_back(soc.written);
        if (soc.failed) fail("the processor trapped, or a core refused an access");
        if (soc.end_write) {
            const bool has_error = std::fclose(shade) != 0 || std::fclose(grain) != 0 || std::fclose(lit) != 0;
            if (has_error) fail("the pictures cannot be written");
            if (soc.written != 0 || numbers.size() != SERIES * (1 + WAYS) + 1 + FUNCTIONS * FUNCTION_WAYS) {
                std::fprintf(stderr, "the program ended with exit code %u\n", soc.written);
                return 1;
            }
            std::printf("%llu clocks in all\n", (unsigned long long)clock);
            report("cosine-power", numbers.data());
            report("rough, where it is smooth", numbers.data() + 1 + WAYS);
            report("rough, where it is not", numbers.data() + 2 * (1 + WAYS));
            report("lit, from normals of any length", numbers.data() + 3 * (1 + WAYS));
            report_functions(numbers.data() + SERIES * (1 + WAYS));
            return 0;
        }
    }
    fail("the program does not end");
}
