// The pins of the Tang Nano 20K: TMDS as a receiver takes it.
#include "Vtangnano20k.h"
#include "tmds.h"
#include "verilated.h"

int main(int argc, char** argv) {
    Receiver receiver(Screen::of(argc, argv, 8));
    Vtangnano20k board;
    while (!receiver.done()) {
        // The model of the PLL takes the board's clock for the clock of pairs of bits.
        board.clk_27mhz = !board.clk_27mhz;
        board.eval();
        receiver.take(board.tmds_p);
    }
    return 0;
}
