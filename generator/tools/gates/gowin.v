// Models of the multipliers, the carry cell and the block memories of Gowin as Yosys uses them. The multipliers have no register
// inside, and read their operands from the inputs A and B. Any other use ends the simulation.

module MULT9X9 #(
    parameter AREG = 1'b0, BREG = 1'b0, OUT_REG = 1'b0, PIPE_REG = 1'b0, ASIGN_REG = 1'b0, BSIGN_REG = 1'b0, SOA_REG = 1'b0,
    parameter MULT_RESET_MODE = "SYNC"
) (
    input  wire        CLK, CE, RESET,
    input  wire [8:0]  A, B, SIA, SIB,
    input  wire        ASEL, BSEL, ASIGN, BSIGN,
    output wire [8:0]  SOA, SOB,
    output wire [17:0] DOUT
);
    glint_product #(.WIDTH(9)) product (.A(A), .B(B), .ASIGN(ASIGN), .BSIGN(BSIGN), .DOUT(DOUT));
    initial #1
        if (AREG !== 1'b0 || BREG !== 1'b0 || OUT_REG !== 1'b0 || PIPE_REG !== 1'b0 || ASEL !== 1'b0 || BSEL !== 1'b0)
            $fatal(1, "MULT9X9 in a mode that its model does not have");
endmodule

module MULT18X18 #(
    parameter AREG = 1'b0, BREG = 1'b0, OUT_REG = 1'b0, PIPE_REG = 1'b0, ASIGN_REG = 1'b0, BSIGN_REG = 1'b0, SOA_REG = 1'b0,
    parameter MULT_RESET_MODE = "SYNC"
) (
    input  wire        CLK, CE, RESET,
    input  wire [17:0] A, B, SIA, SIB,
    input  wire        ASEL, BSEL, ASIGN, BSIGN,
    output wire [17:0] SOA, SOB,
    output wire [35:0] DOUT
);
    glint_product #(.WIDTH(18)) product (.A(A), .B(B), .ASIGN(ASIGN), .BSIGN(BSIGN), .DOUT(DOUT));
    initial #1
        if (AREG !== 1'b0 || BREG !== 1'b0 || OUT_REG !== 1'b0 || PIPE_REG !== 1'b0 || ASEL !== 1'b0 || BSEL !== 1'b0)
            $fatal(1, "MULT18X18 in a mode that its model does not have");
endmodule

module MULT36X36 #(
    parameter AREG = 1'b0, BREG = 1'b0, OUT0_REG = 1'b0, OUT1_REG = 1'b0, PIPE_REG = 1'b0, ASIGN_REG = 1'b0, BSIGN_REG = 1'b0,
    parameter MULT_RESET_MODE = "SYNC"
) (
    input  wire        CLK, CE, RESET,
    input  wire [35:0] A, B,
    input  wire        ASIGN, BSIGN,
    output wire [71:0] DOUT
);
    glint_product #(.WIDTH(36)) product (.A(A), .B(B), .ASIGN(ASIGN), .BSIGN(BSIGN), .DOUT(DOUT));
    initial #1
        if (AREG !== 1'b0 || BREG !== 1'b0 || OUT0_REG !== 1'b0 || OUT1_REG !== 1'b0 || PIPE_REG !== 1'b0)
            $fatal(1, "MULT36X36 in a mode that its model does not have");
endmodule

// A product of operands that are signed where ASIGN and BSIGN are 1.
module glint_product #(parameter WIDTH = 18) (
    input  wire [WIDTH-1:0]   A, B,
    input  wire               ASIGN, BSIGN,
    output wire [2*WIDTH-1:0] DOUT
);
    wire signed [WIDTH:0] first = {ASIGN & A[WIDTH-1], A};
    wire signed [WIDTH:0] second = {BSIGN & B[WIDTH-1], B};
    wire signed [2*WIDTH+1:0] whole = first * second;
    assign DOUT = whole[2*WIDTH-1:0];
endmodule

// A carry cell that adds if I3 is 1 and subtracts if it is 0, or always one of both. Yosys's own model never computes anything in
// Icarus Verilog if all its inputs are constants. Written from Gowin's "Configurable Function Unit User Guide" (UG288).
module ALU #(parameter ALU_MODE = 0) (
    input  wire I0, I1, I3, CIN,
    output wire SUM, COUT
);
    localparam ADD = 0, SUB = 1, ADDSUB = 2;
    wire negative = ALU_MODE == SUB || (ALU_MODE == ADDSUB && I3 === 1'b0);
    wire second = I1 ^ negative;
    assign SUM = I0 ^ second ^ CIN;
    assign COUT = (I0 & second) | (I0 & CIN) | (second & CIN);
    initial #1
        if (ALU_MODE != ADD && ALU_MODE != SUB && ALU_MODE != ADDSUB)
            $fatal(1, "ALU in a mode that its model does not have");
endmodule

// Block memories of 2^14 bits, or of 2^11 bytes of 9 bits, of which a ROM reads a word with each clock. Any write ends the simulation.
// Written from Gowin's "Memory User Guide" (UG285): the initial contents are the words one after the other, and narrow words use the
// lower bits of the address.

module SP #(
    parameter READ_MODE = 1'b0, WRITE_MODE = 2'b00, BIT_WIDTH = 32, BLK_SEL = 3'b000, RESET_MODE = "SYNC",
    parameter [255:0]
    INIT_RAM_00 = 0, INIT_RAM_01 = 0, INIT_RAM_02 = 0, INIT_RAM_03 = 0, INIT_RAM_04 = 0, INIT_RAM_05 = 0, INIT_RAM_06 = 0, INIT_RAM_07 = 0,
    INIT_RAM_08 = 0, INIT_RAM_09 = 0, INIT_RAM_0A = 0, INIT_RAM_0B = 0, INIT_RAM_0C = 0, INIT_RAM_0D = 0, INIT_RAM_0E = 0, INIT_RAM_0F = 0,
    INIT_RAM_10 = 0, INIT_RAM_11 = 0, INIT_RAM_12 = 0, INIT_RAM_13 = 0, INIT_RAM_14 = 0, INIT_RAM_15 = 0, INIT_RAM_16 = 0, INIT_RAM_17 = 0,
    INIT_RAM_18 = 0, INIT_RAM_19 = 0, INIT_RAM_1A = 0, INIT_RAM_1B = 0, INIT_RAM_1C = 0, INIT_RAM_1D = 0, INIT_RAM_1E = 0, INIT_RAM_1F = 0,
    INIT_RAM_20 = 0, INIT_RAM_21 = 0, INIT_RAM_22 = 0, INIT_RAM_23 = 0, INIT_RAM_24 = 0, INIT_RAM_25 = 0, INIT_RAM_26 = 0, INIT_RAM_27 = 0,
    INIT_RAM_28 = 0, INIT_RAM_29 = 0, INIT_RAM_2A = 0, INIT_RAM_2B = 0, INIT_RAM_2C = 0, INIT_RAM_2D = 0, INIT_RAM_2E = 0, INIT_RAM_2F = 0,
    INIT_RAM_30 = 0, INIT_RAM_31 = 0, INIT_RAM_32 = 0, INIT_RAM_33 = 0, INIT_RAM_34 = 0, INIT_RAM_35 = 0, INIT_RAM_36 = 0, INIT_RAM_37 = 0,
    INIT_RAM_38 = 0, INIT_RAM_39 = 0, INIT_RAM_3A = 0, INIT_RAM_3B = 0, INIT_RAM_3C = 0, INIT_RAM_3D = 0, INIT_RAM_3E = 0, INIT_RAM_3F = 0
) (
    output wire [31:0] DO,
    input  wire [31:0] DI,
    input  wire [2:0]  BLKSEL,
    input  wire [13:0] AD,
    input  wire        WRE, CLK, CE, OCE, RESET
);
    glint_read_port #(.WIDTH(BIT_WIDTH), .OUTPUTS(32), .CONTENTS({
        INIT_RAM_3F, INIT_RAM_3E, INIT_RAM_3D, INIT_RAM_3C, INIT_RAM_3B, INIT_RAM_3A, INIT_RAM_39, INIT_RAM_38,
        INIT_RAM_37, INIT_RAM_36, INIT_RAM_35, INIT_RAM_34, INIT_RAM_33, INIT_RAM_32, INIT_RAM_31, INIT_RAM_30,
        INIT_RAM_2F, INIT_RAM_2E, INIT_RAM_2D, INIT_RAM_2C, INIT_RAM_2B, INIT_RAM_2A, INIT_RAM_29, INIT_RAM_28,
        INIT_RAM_27, INIT_RAM_26, INIT_RAM_25, INIT_RAM_24, INIT_RAM_23, INIT_RAM_22, INIT_RAM_21, INIT_RAM_20,
        INIT_RAM_1F, INIT_RAM_1E, INIT_RAM_1D, INIT_RAM_1C, INIT_RAM_1B, INIT_RAM_1A, INIT_RAM_19, INIT_RAM_18,
        INIT_RAM_17, INIT_RAM_16, INIT_RAM_15, INIT_RAM_14, INIT_RAM_13, INIT_RAM_12, INIT_RAM_11, INIT_RAM_10,
        INIT_RAM_0F, INIT_RAM_0E, INIT_RAM_0D, INIT_RAM_0C, INIT_RAM_0B, INIT_RAM_0A, INIT_RAM_09, INIT_RAM_08,
        INIT_RAM_07, INIT_RAM_06, INIT_RAM_05, INIT_RAM_04, INIT_RAM_03, INIT_RAM_02, INIT_RAM_01, INIT_RAM_00
    })) port (
        .clk(CLK), .enable(CE), .write(WRE), .reset(RESET), .out(DO),
        .word(BIT_WIDTH == 32 ? AD >> 5 : BIT_WIDTH == 16 ? AD >> 4 : BIT_WIDTH == 8 ? AD >> 3
            : BIT_WIDTH == 4 ? AD >> 2 : BIT_WIDTH == 2 ? AD >> 1 : AD)
    );
    initial #1
        if (READ_MODE !== 1'b0 || BLKSEL !== BLK_SEL) $fatal(1, "SP in a mode that its model does not have");
endmodule

module SPX9 #(
    parameter READ_MODE = 1'b0, WRITE_MODE = 2'b00, BIT_WIDTH = 36, BLK_SEL = 3'b000, RESET_MODE = "SYNC",
    parameter [287:0]
    INIT_RAM_00 = 0, INIT_RAM_01 = 0, INIT_RAM_02 = 0, INIT_RAM_03 = 0, INIT_RAM_04 = 0, INIT_RAM_05 = 0, INIT_RAM_06 = 0, INIT_RAM_07 = 0,
    INIT_RAM_08 = 0, INIT_RAM_09 = 0, INIT_RAM_0A = 0, INIT_RAM_0B = 0, INIT_RAM_0C = 0, INIT_RAM_0D = 0, INIT_RAM_0E = 0, INIT_RAM_0F = 0,
    INIT_RAM_10 = 0, INIT_RAM_11 = 0, INIT_RAM_12 = 0, INIT_RAM_13 = 0, INIT_RAM_14 = 0, INIT_RAM_15 = 0, INIT_RAM_16 = 0, INIT_RAM_17 = 0,
    INIT_RAM_18 = 0, INIT_RAM_19 = 0, INIT_RAM_1A = 0, INIT_RAM_1B = 0, INIT_RAM_1C = 0, INIT_RAM_1D = 0, INIT_RAM_1E = 0, INIT_RAM_1F = 0,
    INIT_RAM_20 = 0, INIT_RAM_21 = 0, INIT_RAM_22 = 0, INIT_RAM_23 = 0, INIT_RAM_24 = 0, INIT_RAM_25 = 0, INIT_RAM_26 = 0, INIT_RAM_27 = 0,
    INIT_RAM_28 = 0, INIT_RAM_29 = 0, INIT_RAM_2A = 0, INIT_RAM_2B = 0, INIT_RAM_2C = 0, INIT_RAM_2D = 0, INIT_RAM_2E = 0, INIT_RAM_2F = 0,
    INIT_RAM_30 = 0, INIT_RAM_31 = 0, INIT_RAM_32 = 0, INIT_RAM_33 = 0, INIT_RAM_34 = 0, INIT_RAM_35 = 0, INIT_RAM_36 = 0, INIT_RAM_37 = 0,
    INIT_RAM_38 = 0, INIT_RAM_39 = 0, INIT_RAM_3A = 0, INIT_RAM_3B = 0, INIT_RAM_3C = 0, INIT_RAM_3D = 0, INIT_RAM_3E = 0, INIT_RAM_3F = 0
) (
    output wire [35:0] DO,
    input  wire [35:0] DI,
    input  wire [2:0]  BLKSEL,
    input  wire [13:0] AD,
    input  wire        WRE, CLK, CE, OCE, RESET
);
    glint_read_port #(.WIDTH(BIT_WIDTH), .OUTPUTS(36), .CONTENTS({
        INIT_RAM_3F, INIT_RAM_3E, INIT_RAM_3D, INIT_RAM_3C, INIT_RAM_3B, INIT_RAM_3A, INIT_RAM_39, INIT_RAM_38,
        INIT_RAM_37, INIT_RAM_36, INIT_RAM_35, INIT_RAM_34, INIT_RAM_33, INIT_RAM_32, INIT_RAM_31, INIT_RAM_30,
        INIT_RAM_2F, INIT_RAM_2E, INIT_RAM_2D, INIT_RAM_2C, INIT_RAM_2B, INIT_RAM_2A, INIT_RAM_29, INIT_RAM_28,
        INIT_RAM_27, INIT_RAM_26, INIT_RAM_25, INIT_RAM_24, INIT_RAM_23, INIT_RAM_22, INIT_RAM_21, INIT_RAM_20,
        INIT_RAM_1F, INIT_RAM_1E, INIT_RAM_1D, INIT_RAM_1C, INIT_RAM_1B, INIT_RAM_1A, INIT_RAM_19, INIT_RAM_18,
        INIT_RAM_17, INIT_RAM_16, INIT_RAM_15, INIT_RAM_14, INIT_RAM_13, INIT_RAM_12, INIT_RAM_11, INIT_RAM_10,
        INIT_RAM_0F, INIT_RAM_0E, INIT_RAM_0D, INIT_RAM_0C, INIT_RAM_0B, INIT_RAM_0A, INIT_RAM_09, INIT_RAM_08,
        INIT_RAM_07, INIT_RAM_06, INIT_RAM_05, INIT_RAM_04, INIT_RAM_03, INIT_RAM_02, INIT_RAM_01, INIT_RAM_00
    })) port (
        .clk(CLK), .enable(CE), .write(WRE), .reset(RESET), .out(DO),
        .word(BIT_WIDTH == 36 ? AD >> 5 : BIT_WIDTH == 18 ? AD >> 4 : AD >> 3)
    );
    initial #1
        if (READ_MODE !== 1'b0 || BLKSEL !== BLK_SEL) $fatal(1, "SPX9 in a mode that its model does not have");
endmodule

// Reads a word of a block memory with each clock on which `enable` is 1.
module glint_read_port #(
    parameter WIDTH = 36, OUTPUTS = 36,
    parameter [64*8*OUTPUTS-1:0] CONTENTS = 0
) (
    input  wire               clk, enable, write, reset,
    input  wire [13:0]        word,
    output wire [OUTPUTS-1:0] out
);
    reg [WIDTH-1:0] data = 0;
    always @(posedge clk) begin
        if (write !== 1'b0 || reset !== 1'b0) $fatal(1, "%m: a write or a reset in a ROM");
        if (enable === 1'b1) data <= CONTENTS[word * WIDTH +: WIDTH];
        else if (enable !== 1'b0) data <= {WIDTH{1'bx}};
    end
    assign out = data;
endmodule
