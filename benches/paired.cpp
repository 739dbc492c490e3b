// Replays recorded inputs through the verilated model: paired ROWS PASSES.
//
// ROWS is a file of 64-bit words, one per input and clock. Prints the seconds of processor time and of
// wall time that PASSES replays took, and the sum of one result over the clocks in which it is valid.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <vector>

#include "Vtop.h"

// `INPUTS`; `drive`, which takes a row to the inputs; and the outputs `valid` and `result`: written by paired.rs.
#include "ports.h"

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    std::ifstream file(argv[1], std::ios::binary);
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    const auto* words = reinterpret_cast<const uint64_t*>(bytes.data());
    const auto* end = words + bytes.size() / sizeof(uint64_t);
    const int passes = std::atoi(argv[2]);

    Vtop top;
    uint64_t sum = 0;
    const auto wall = std::chrono::steady_clock::now();
    const auto processor = std::clock();
    for (int pass = 0; pass < passes; pass++) {
        for (const auto* row = words; row != end; row += INPUTS) {
            drive(top, row);
            top.clk = 0;
            top.eval();
            top.clk = 1;
            top.eval();
            if (valid(top)) sum += result(top);
        }
    }
    const double used = double(std::clock() - processor) / CLOCKS_PER_SEC;
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - wall;
    std::printf("%.6f %.6f %llu\n", used, passed.count(), (unsigned long long)sum);
}
