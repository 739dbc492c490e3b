// Models of the multipliers of Gowin as Yosys uses them: no register inside, operands from the inputs A and B.
// Any other use ends the simulation. Yosys declares these cells as black boxes.

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
