// A model of the block memory of Nexus for which Yosys has none: PDPSC16K, with one port that reads and one that writes. A ROM of
// Glint only reads; any write ends the simulation.
//
// Written from Lattice's "Memory User Guide for Nexus Platform" (FPGA-TN-02094: ports, widths and address pins). How initial values are
// packed is stated by the cell library of Yosys, lattice/brams_map_nexus.v: rows of 32 bytes of 9 bits, 10 bits apart.

module PDPSC16K #(
    parameter DATA_WIDTH_W = "X36", DATA_WIDTH_R = "X36", OUTREG = "BYPASSED", RESETMODE = "SYNC", GSR = "ENABLED",
    parameter ECC = "DISABLED", CSDECODE_W = "000", CSDECODE_R = "000", ASYNC_RST_RELEASE = "SYNC", INIT_DATA = "STATIC",
    parameter [82*8-1:0]
    INITVAL_00 = 0, INITVAL_01 = 0, INITVAL_02 = 0, INITVAL_03 = 0, INITVAL_04 = 0, INITVAL_05 = 0, INITVAL_06 = 0, INITVAL_07 = 0,
    INITVAL_08 = 0, INITVAL_09 = 0, INITVAL_0A = 0, INITVAL_0B = 0, INITVAL_0C = 0, INITVAL_0D = 0, INITVAL_0E = 0, INITVAL_0F = 0,
    INITVAL_10 = 0, INITVAL_11 = 0, INITVAL_12 = 0, INITVAL_13 = 0, INITVAL_14 = 0, INITVAL_15 = 0, INITVAL_16 = 0, INITVAL_17 = 0,
    INITVAL_18 = 0, INITVAL_19 = 0, INITVAL_1A = 0, INITVAL_1B = 0, INITVAL_1C = 0, INITVAL_1D = 0, INITVAL_1E = 0, INITVAL_1F = 0,
    INITVAL_20 = 0, INITVAL_21 = 0, INITVAL_22 = 0, INITVAL_23 = 0, INITVAL_24 = 0, INITVAL_25 = 0, INITVAL_26 = 0, INITVAL_27 = 0,
    INITVAL_28 = 0, INITVAL_29 = 0, INITVAL_2A = 0, INITVAL_2B = 0, INITVAL_2C = 0, INITVAL_2D = 0, INITVAL_2E = 0, INITVAL_2F = 0,
    INITVAL_30 = 0, INITVAL_31 = 0, INITVAL_32 = 0, INITVAL_33 = 0, INITVAL_34 = 0, INITVAL_35 = 0, INITVAL_36 = 0, INITVAL_37 = 0,
    INITVAL_38 = 0, INITVAL_39 = 0, INITVAL_3A = 0, INITVAL_3B = 0, INITVAL_3C = 0, INITVAL_3D = 0, INITVAL_3E = 0, INITVAL_3F = 0
) (
    input  wire [35:0] DI,
    input  wire [13:0] ADW, ADR,
    input  wire        CLK, CER, CEW, RST,
    input  wire [2:0]  CSW, CSR,
    output wire [35:0] DO,
    output wire        ONEBITERR, TWOBITERR
);
    localparam WIDTH = DATA_WIDTH_R == "X36" ? 36 : DATA_WIDTH_R == "X18" ? 18 : DATA_WIDTH_R == "X9" ? 9
        : DATA_WIDTH_R == "X4" ? 4 : DATA_WIDTH_R == "X2" ? 2 : 1;

    // The value of a row from its text, which is `0x` and 80 hexadecimal digits.
    function [319:0] row_of(input [82*8-1:0] text);
        reg [7:0] digit;
        integer at;
        for (at = 0; at < 80; at = at + 1) begin
            digit = text[8*at +: 8];
            row_of[4*at +: 4] = digit >= "a" ? digit - "a" + 10 : digit >= "A" ? digit - "A" + 10 : digit - "0";
        end
    endfunction

    reg [319:0] rows [0:63];
    initial begin
        rows[0] = row_of(INITVAL_00); rows[1] = row_of(INITVAL_01);
        rows[2] = row_of(INITVAL_02); rows[3] = row_of(INITVAL_03);
        rows[4] = row_of(INITVAL_04); rows[5] = row_of(INITVAL_05);
        rows[6] = row_of(INITVAL_06); rows[7] = row_of(INITVAL_07);
        rows[8] = row_of(INITVAL_08); rows[9] = row_of(INITVAL_09);
        rows[10] = row_of(INITVAL_0A); rows[11] = row_of(INITVAL_0B);
        rows[12] = row_of(INITVAL_0C); rows[13] = row_of(INITVAL_0D);
        rows[14] = row_of(INITVAL_0E); rows[15] = row_of(INITVAL_0F);
        rows[16] = row_of(INITVAL_10); rows[17] = row_of(INITVAL_11);
        rows[18] = row_of(INITVAL_12); rows[19] = row_of(INITVAL_13);
        rows[20] = row_of(INITVAL_14); rows[21] = row_of(INITVAL_15);
        rows[22] = row_of(INITVAL_16); rows[23] = row_of(INITVAL_17);
        rows[24] = row_of(INITVAL_18); rows[25] = row_of(INITVAL_19);
        rows[26] = row_of(INITVAL_1A); rows[27] = row_of(INITVAL_1B);
        rows[28] = row_of(INITVAL_1C); rows[29] = row_of(INITVAL_1D);
        rows[30] = row_of(INITVAL_1E); rows[31] = row_of(INITVAL_1F);
        rows[32] = row_of(INITVAL_20); rows[33] = row_of(INITVAL_21);
        rows[34] = row_of(INITVAL_22); rows[35] = row_of(INITVAL_23);
        rows[36] = row_of(INITVAL_24); rows[37] = row_of(INITVAL_25);
        rows[38] = row_of(INITVAL_26); rows[39] = row_of(INITVAL_27);
        rows[40] = row_of(INITVAL_28); rows[41] = row_of(INITVAL_29);
        rows[42] = row_of(INITVAL_2A); rows[43] = row_of(INITVAL_2B);
        rows[44] = row_of(INITVAL_2C); rows[45] = row_of(INITVAL_2D);
        rows[46] = row_of(INITVAL_2E); rows[47] = row_of(INITVAL_2F);
        rows[48] = row_of(INITVAL_30); rows[49] = row_of(INITVAL_31);
        rows[50] = row_of(INITVAL_32); rows[51] = row_of(INITVAL_33);
        rows[52] = row_of(INITVAL_34); rows[53] = row_of(INITVAL_35);
        rows[54] = row_of(INITVAL_36); rows[55] = row_of(INITVAL_37);
        rows[56] = row_of(INITVAL_38); rows[57] = row_of(INITVAL_39);
        rows[58] = row_of(INITVAL_3A); rows[59] = row_of(INITVAL_3B);
        rows[60] = row_of(INITVAL_3C); rows[61] = row_of(INITVAL_3D);
        rows[62] = row_of(INITVAL_3E); rows[63] = row_of(INITVAL_3F);
    end

    // The byte of 9 bits with this number.
    function [8:0] byte_of(input [10:0] number);
        byte_of = rows[number / 32][10 * (number % 32) +: 9];
    endfunction

    wire [10:0] place = WIDTH == 36 ? {ADR[13:5], 2'b00} : WIDTH == 18 ? {ADR[13:4], 1'b0} : ADR[13:3];
    reg [35:0] data = 0;
    always @(posedge CLK) begin
        if (CEW !== 1'b0 || RST !== 1'b0) $fatal(1, "%m: a write or a reset in a ROM");
        if (CER === 1'b1)
            data <= WIDTH < 9 ? byte_of(place) >> (ADR[2:0] & ~(WIDTH - 1))
                : {byte_of(place + 3), byte_of(place + 2), byte_of(place + 1), byte_of(place)};
        else if (CER !== 1'b0) data <= 36'bx;
    end
    assign DO = data;
    assign ONEBITERR = 1'b0, TWOBITERR = 1'b0;

    initial #1
        if (OUTREG != "BYPASSED" || ECC != "DISABLED" || CSDECODE_R != "111" || CSR !== 3'b111)
            $fatal(1, "PDPSC16K in a mode that its model does not have");
endmodule
