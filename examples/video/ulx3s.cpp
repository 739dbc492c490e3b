// The pins of the ULX3S: TMDS as a receiver takes it.
#include "Vulx3s.h"
#include "tmds.h"
#include "verilated.h"

int main(int argc, char** argv) {
    Receiver receiver(Screen::of(argc, argv, 8));
    Vulx3s board;
    while (!receiver.done()) {
        // The model of the PLL takes the board's clock for the clock of pairs of bits.
        board.clk_25mhz = !board.clk_25mhz;
        board.eval();
        receiver.take(board.gpdi_dp);
    }
    return 0;
}
