// What simulation needs to know of the chips' cells: a PLL that divides or passes on, and registers in pins. The clocks that
// the PLLs take here are those that they make on a board.

`default_nettype none

module SB_PLL40_PAD #(
    parameter FEEDBACK_PATH = "SIMPLE",
    parameter DIVR = 4'd0,
    parameter DIVF = 7'd0,
    parameter DIVQ = 3'd0,
    parameter FILTER_RANGE = 3'd0
) (
    input  wire PACKAGEPIN,
    output wire PLLOUTGLOBAL,
    output wire LOCK,
    input  wire RESETB,
    input  wire BYPASS
);
    assign PLLOUTGLOBAL = PACKAGEPIN;
    assign LOCK = RESETB & ~BYPASS;
endmodule

module SB_IO #(
    parameter PIN_TYPE = 6'b000000
) (
    output wire PACKAGE_PIN,
    input  wire OUTPUT_CLK,
    input  wire D_OUT_0,
    input  wire D_OUT_1
);
    // 0101: a register; 0100: one for each edge.
    reg first;
    reg second;
    always @(posedge OUTPUT_CLK) first <= D_OUT_0;
    always @(negedge OUTPUT_CLK) second <= D_OUT_1;
    assign PACKAGE_PIN = (PIN_TYPE[5:2] == 4'b0101 || OUTPUT_CLK) ? first : second;
endmodule

module EHXPLLL #(
    parameter CLKI_DIV = 1,
    parameter CLKFB_DIV = 1,
    parameter CLKOP_DIV = 1,
    parameter CLKOP_CPHASE = 0,
    parameter CLKOS_ENABLE = "DISABLED",
    parameter CLKOS_DIV = 1,
    parameter CLKOS_CPHASE = 0,
    parameter FEEDBK_PATH = "CLKOP"
) (
    input  wire CLKI,
    input  wire CLKFB,
    output wire CLKOP,
    output reg  CLKOS,
    output wire LOCK,
    input  wire RST,
    input  wire STDBY,
    input  wire PHASESEL0,
    input  wire PHASESEL1,
    input  wire PHASEDIR,
    input  wire PHASESTEP,
    input  wire PHASELOADREG,
    input  wire ENCLKOP
);
    integer count = 0;
    always @(posedge CLKI) begin
        count <= (count + 1) % (CLKOS_DIV / CLKOP_DIV);
        CLKOS <= count == 0;
    end
    assign CLKOP = CLKI;
    assign LOCK = 1'b1;
endmodule

module ODDRX1F (
    input  wire SCLK,
    input  wire RST,
    input  wire D0,
    input  wire D1,
    output wire Q
);
    reg [1:0] both;
    always @(posedge SCLK) both <= RST ? 2'b00 : {D1, D0};
    assign Q = SCLK ? both[0] : both[1];
endmodule

`default_nettype wire
