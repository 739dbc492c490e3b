// The pins of the iCEBreaker: four bits a colour, taken where the clock of the Pmod rises.
#include "Vicebreaker.h"
#include "screen.h"
#include "verilated.h"

int main(int argc, char** argv) {
    Screen screen = Screen::of(argc, argv, 4);
    Vicebreaker board;
    bool was = true;
    while (!screen.done()) {
        board.clk_12mhz = !board.clk_12mhz;
        board.eval();
        if (!was && board.dvi_clk) {
            screen.clock(board.dvi_hsync, board.dvi_vsync, board.dvi_de, board.dvi_red, board.dvi_green,
                         board.dvi_blue);
        }
        was = board.dvi_clk;
    }
    return 0;
}
