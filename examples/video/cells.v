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

module rPLL #(
    parameter FCLKIN = "27",
    parameter DEVICE = "GW2AR-18C",
    parameter DYN_IDIV_SEL = "false",
    parameter IDIV_SEL = 0,
    parameter DYN_FBDIV_SEL = "false",
    parameter FBDIV_SEL = 0,
    parameter DYN_ODIV_SEL = "false",
    parameter ODIV_SEL = 8,
    parameter PSDA_SEL = "0000",
    parameter DYN_DA_EN = "false",
    parameter DUTYDA_SEL = "1000",
    parameter CLKOUT_FT_DIR = 1'b1,
    parameter CLKOUTP_FT_DIR = 1'b1,
    parameter CLKOUT_DLY_STEP = 0,
    parameter CLKOUTP_DLY_STEP = 0,
    parameter CLKFB_SEL = "internal",
    parameter CLKOUT_BYPASS = "false",
    parameter CLKOUTP_BYPASS = "false",
    parameter CLKOUTD_BYPASS = "false",
    parameter DYN_SDIV_SEL = 2,
    parameter CLKOUTD_SRC = "CLKOUT",
    parameter CLKOUTD3_SRC = "CLKOUT"
) (
    input  wire       CLKIN,
    input  wire       CLKFB,
    input  wire       RESET,
    input  wire       RESET_P,
    input  wire [5:0] FBDSEL,
    input  wire [5:0] IDSEL,
    input  wire [5:0] ODSEL,
    input  wire [3:0] PSDA,
    input  wire [3:0] DUTYDA,
    input  wire [3:0] FDLY,
    output wire       CLKOUT,
    output wire       LOCK,
    output wire       CLKOUTP,
    output wire       CLKOUTD,
    output wire       CLKOUTD3
);
    assign CLKOUT = CLKIN;
    assign LOCK = 1'b1;
    assign CLKOUTP = 1'b0;
    assign CLKOUTD = 1'b0;
    assign CLKOUTD3 = 1'b0;
endmodule

module CLKDIV #(
    parameter DIV_MODE = "5",
    parameter GSREN = "false"
) (
    input  wire HCLKIN,
    input  wire RESETN,
    input  wire CALIB,
    output reg  CLKOUT
);
    // A fifth of the clock, which is all that the boards here want.
    integer count = 0;
    always @(posedge HCLKIN) begin
        count <= RESETN ? (count + 1) % 5 : 0;
        CLKOUT <= count < 2;
    end
endmodule

module OSER10 #(
    parameter GSREN = "false",
    parameter LSREN = "true"
) (
    input  wire PCLK,
    input  wire FCLK,
    input  wire RESET,
    input  wire D0,
    input  wire D1,
    input  wire D2,
    input  wire D3,
    input  wire D4,
    input  wire D5,
    input  wire D6,
    input  wire D7,
    input  wire D8,
    input  wire D9,
    output wire Q
);
    // Two bits for each period of FCLK, D0 first. The word is taken in the middle of a period of PCLK.
    reg [1:0] seen;
    reg [9:0] rest;
    reg [1:0] both;
    always @(posedge FCLK) begin
        seen <= {seen[0], PCLK};
        rest <= (seen == 2'b01) ? {D9, D8, D7, D6, D5, D4, D3, D2, D1, D0} : {2'b00, rest[9:2]};
        both <= RESET ? 2'b00 : rest[1:0];
    end
    assign Q = FCLK ? both[0] : both[1];
endmodule

module TLVDS_OBUF (
    input  wire I,
    output wire O,
    output wire OB
);
    assign O = I;
    assign OB = ~I;
endmodule

`default_nettype wire
