// Models of the ECP5 cells that Yosys maps to and ships no behaviour for: DP16KD and MULT18X18D
// (Yosys issue 1358). The others are in its ecp5/cells_sim.v.
//
// Only what a ROM and a product of Glint become; any other mode, or a level on a pin that would
// matter, ends the simulation.
//
// Written from Lattice's "ECP5 and ECP5-5G Memory Usage Guide" (FPGA-TN-02204: ports, widths,
// address pins, initial contents) and "sysDSP Usage Guide" (FPGA-TN-02205: the multiplier's pins and
// bypassed registers). How initial values are packed is stated by the cell library of Yosys,
// ecp5/brams.txt and brams_map.v: rows of 16 words of 18 bits, 20 bits apart.

`default_nettype none

// A port of a DP16KD that only reads, output register bypassed: on the clock, if enabled.
module ecp5_read_port #(
    parameter WIDTH = 18,
    parameter [64*320-1:0] CONTENTS = 0
) (
    input  wire        clk,
    input  wire        enable,
    input  wire        write,
    input  wire        reset,
    input  wire [2:0]  select,
    input  wire [13:0] address,
    output wire [35:0] out
);
    initial if (WIDTH != 1 && WIDTH != 2 && WIDTH != 4 && WIDTH != 9 && WIDTH != 18
            && WIDTH != 36) begin
        $display("FAIL %m: no data width %0d", WIDTH);
        $fatal;
    end

    // Words of 36 bits are two of 18, and those two bytes of nine, the last bit of which narrow words
    // leave out.
    wire [9:0]  row = WIDTH == 36 ? {address[13:5], 1'b0} : address[13:4];
    wire [14:0] start = row * 20 + (WIDTH >= 18 ? 0
                                   : WIDTH == 9 ? 9 * address[3]
                                   : 9 * address[3] + (address[2:0] & ~(WIDTH - 1)));
    wire [35:0] pair = {CONTENTS[start + 20 +: 18], CONTENTS[start +: 18]};

    reg [WIDTH-1:0] data = 0;
    always @(posedge clk) begin
        if (write !== 1'b0 || reset !== 1'b0 || select !== 3'b000) begin
            $display("FAIL %m: a write, reset or chip select in a ROM");
            $fatal;
        end
        if (enable === 1'b1) data <= pair[WIDTH-1:0];
        else if (enable !== 1'b0) data <= {WIDTH{1'bx}};
    end
    assign out = data;
endmodule

module DP16KD #(
    parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18,
    parameter REGMODE_A = "NOREG", REGMODE_B = "NOREG",
    parameter CLKAMUX = "CLKA", CLKBMUX = "CLKB",
    parameter CSDECODE_A = "0b000", CSDECODE_B = "0b000",
    // Of writes and resets, which a ROM has not.
    parameter WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL",
    parameter RESETMODE = "SYNC", ASYNC_RESET_RELEASE = "SYNC", GSR = "AUTO",
    parameter [319:0]
    INITVAL_00 = 0, INITVAL_01 = 0, INITVAL_02 = 0, INITVAL_03 = 0,
    INITVAL_04 = 0, INITVAL_05 = 0, INITVAL_06 = 0, INITVAL_07 = 0,
    INITVAL_08 = 0, INITVAL_09 = 0, INITVAL_0A = 0, INITVAL_0B = 0,
    INITVAL_0C = 0, INITVAL_0D = 0, INITVAL_0E = 0, INITVAL_0F = 0,
    INITVAL_10 = 0, INITVAL_11 = 0, INITVAL_12 = 0, INITVAL_13 = 0,
    INITVAL_14 = 0, INITVAL_15 = 0, INITVAL_16 = 0, INITVAL_17 = 0,
    INITVAL_18 = 0, INITVAL_19 = 0, INITVAL_1A = 0, INITVAL_1B = 0,
    INITVAL_1C = 0, INITVAL_1D = 0, INITVAL_1E = 0, INITVAL_1F = 0,
    INITVAL_20 = 0, INITVAL_21 = 0, INITVAL_22 = 0, INITVAL_23 = 0,
    INITVAL_24 = 0, INITVAL_25 = 0, INITVAL_26 = 0, INITVAL_27 = 0,
    INITVAL_28 = 0, INITVAL_29 = 0, INITVAL_2A = 0, INITVAL_2B = 0,
    INITVAL_2C = 0, INITVAL_2D = 0, INITVAL_2E = 0, INITVAL_2F = 0,
    INITVAL_30 = 0, INITVAL_31 = 0, INITVAL_32 = 0, INITVAL_33 = 0,
    INITVAL_34 = 0, INITVAL_35 = 0, INITVAL_36 = 0, INITVAL_37 = 0,
    INITVAL_38 = 0, INITVAL_39 = 0, INITVAL_3A = 0, INITVAL_3B = 0,
    INITVAL_3C = 0, INITVAL_3D = 0, INITVAL_3E = 0, INITVAL_3F = 0
) (
    input wire
        DIA17, DIA16, DIA15, DIA14, DIA13, DIA12, DIA11, DIA10, DIA9, DIA8, DIA7, DIA6, DIA5,
        DIA4, DIA3, DIA2, DIA1, DIA0,
        ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1, ADA0,
        CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
    output wire
        DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5,
        DOA4, DOA3, DOA2, DOA1, DOA0,
    input wire
        DIB17, DIB16, DIB15, DIB14, DIB13, DIB12, DIB11, DIB10, DIB9, DIB8, DIB7, DIB6, DIB5,
        DIB4, DIB3, DIB2, DIB1, DIB0,
        ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1, ADB0,
        CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0,
    output wire
        DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5,
        DOB4, DOB3, DOB2, DOB1, DOB0
);
    localparam [64*320-1:0] CONTENTS = {
        INITVAL_3F, INITVAL_3E, INITVAL_3D, INITVAL_3C, INITVAL_3B, INITVAL_3A, INITVAL_39, INITVAL_38,
        INITVAL_37, INITVAL_36, INITVAL_35, INITVAL_34, INITVAL_33, INITVAL_32, INITVAL_31, INITVAL_30,
        INITVAL_2F, INITVAL_2E, INITVAL_2D, INITVAL_2C, INITVAL_2B, INITVAL_2A, INITVAL_29, INITVAL_28,
        INITVAL_27, INITVAL_26, INITVAL_25, INITVAL_24, INITVAL_23, INITVAL_22, INITVAL_21, INITVAL_20,
        INITVAL_1F, INITVAL_1E, INITVAL_1D, INITVAL_1C, INITVAL_1B, INITVAL_1A, INITVAL_19, INITVAL_18,
        INITVAL_17, INITVAL_16, INITVAL_15, INITVAL_14, INITVAL_13, INITVAL_12, INITVAL_11, INITVAL_10,
        INITVAL_0F, INITVAL_0E, INITVAL_0D, INITVAL_0C, INITVAL_0B, INITVAL_0A, INITVAL_09, INITVAL_08,
        INITVAL_07, INITVAL_06, INITVAL_05, INITVAL_04, INITVAL_03, INITVAL_02, INITVAL_01, INITVAL_00
    };

    initial if (REGMODE_A != "NOREG" || REGMODE_B != "NOREG" || CLKAMUX != "CLKA"
            || CLKBMUX != "CLKB" || CSDECODE_A != "0b000" || CSDECODE_B != "0b000"
            || (DATA_WIDTH_A == 36) != (DATA_WIDTH_B == 36)) begin
        $display("FAIL %m: a mode that has no model");
        $fatal;
    end

    // With 36 bits port A only writes and port B only reads, onto the outputs of both.
    localparam PAIRED = DATA_WIDTH_B == 36;
    wire [35:0] out_a, out_b;

    ecp5_read_port #(.WIDTH(DATA_WIDTH_A), .CONTENTS(CONTENTS)) a (
        .clk(CLKA), .enable(CEA), .write(WEA), .reset(RSTA), .select({CSA2, CSA1, CSA0}),
        .address({
            ADA13, ADA12, ADA11, ADA10, ADA9, ADA8, ADA7, ADA6, ADA5, ADA4, ADA3, ADA2, ADA1,
            ADA0
        }),
        .out(out_a)
    );
    ecp5_read_port #(.WIDTH(DATA_WIDTH_B), .CONTENTS(CONTENTS)) b (
        .clk(CLKB), .enable(CEB), .write(WEB), .reset(RSTB), .select({CSB2, CSB1, CSB0}),
        .address({
            ADB13, ADB12, ADB11, ADB10, ADB9, ADB8, ADB7, ADB6, ADB5, ADB4, ADB3, ADB2, ADB1,
            ADB0
        }),
        .out(out_b)
    );
    assign {
        DOA17, DOA16, DOA15, DOA14, DOA13, DOA12, DOA11, DOA10, DOA9, DOA8, DOA7, DOA6, DOA5,
        DOA4, DOA3, DOA2, DOA1, DOA0
    } = PAIRED ? out_b[17:0] : out_a[17:0];
    assign {
        DOB17, DOB16, DOB15, DOB14, DOB13, DOB12, DOB11, DOB10, DOB9, DOB8, DOB7, DOB6, DOB5,
        DOB4, DOB3, DOB2, DOB1, DOB0
    } = PAIRED ? out_b[35:18] : out_b[17:0];
endmodule

// A product, its registers bypassed but for that of the output, which is by the clock CLK0 and the enable CE0 if
// it is there; the C input has no part in it. The pins that say whether a factor is signed take part in the
// product: they extend it to 19 bits.
module MULT18X18D #(
    parameter REG_INPUTA_CLK = "NONE", REG_INPUTB_CLK = "NONE", REG_INPUTC_CLK = "NONE",
    parameter REG_PIPELINE_CLK = "NONE", REG_OUTPUT_CLK = "NONE", REG_OUTPUT_CE = "CE0",
    parameter REG_OUTPUT_RST = "RST0"
) (
    input wire
        A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0,
        B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0,
        C17, C16, C15, C14, C13, C12, C11, C10, C9, C8, C7, C6, C5, C4, C3, C2, C1, C0,
        SIGNEDA, SIGNEDB, SOURCEA, SOURCEB,
        CLK0, CLK1, CLK2, CLK3, CE0, CE1, CE2, CE3, RST0, RST1, RST2, RST3,
    output wire
        P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18,
        P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
);
    initial if (REG_INPUTA_CLK != "NONE" || REG_INPUTB_CLK != "NONE" || REG_INPUTC_CLK != "NONE"
            || REG_PIPELINE_CLK != "NONE"
            || (REG_OUTPUT_CLK != "NONE" && (REG_OUTPUT_CLK != "CLK0" || REG_OUTPUT_CE != "CE0"
            || REG_OUTPUT_RST != "RST0"))) begin
        $display("FAIL %m: a register that has no model");
        $fatal;
    end
    always @* if (SOURCEA !== 1'b0 || SOURCEB !== 1'b0) begin
        $display("FAIL %m: the shift chain has no model");
        $fatal;
    end

    wire signed [18:0] a = {SIGNEDA & A17,
        A17, A16, A15, A14, A13, A12, A11, A10, A9, A8, A7, A6, A5, A4, A3, A2, A1, A0
    };
    wire signed [18:0] b = {SIGNEDB & B17,
        B17, B16, B15, B14, B13, B12, B11, B10, B9, B8, B7, B6, B5, B4, B3, B2, B1, B0
    };
    wire signed [37:0] product = a * b;

    reg [35:0] held;
    always @(posedge CLK0) if (REG_OUTPUT_CLK != "NONE") begin
        if (RST0 !== 1'b0) begin
            $display("FAIL %m: the reset has no model");
            $fatal;
        end
        if (CE0 === 1'b1) held <= product[35:0];
        else if (CE0 !== 1'b0) held <= {36{1'bx}};
    end
    assign {
        P35, P34, P33, P32, P31, P30, P29, P28, P27, P26, P25, P24, P23, P22, P21, P20, P19, P18,
        P17, P16, P15, P14, P13, P12, P11, P10, P9, P8, P7, P6, P5, P4, P3, P2, P1, P0
    } = REG_OUTPUT_CLK != "NONE" ? held : product[35:0];
endmodule

`default_nettype wire
