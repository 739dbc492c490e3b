// The Tang Nano 20K and its HDMI connector: 126 MHz for pairs of bits from the board's 27 MHz, and a fifth of it for the pixels.

`default_nettype none

module tangnano20k (
    input  wire       clk_27mhz,
    output wire [3:0] tmds_p,     // blue, green, red, clock
    output wire [3:0] tmds_n
);

    wire clk;
    wire bit_clk;
    wire locked;
    // 27 MHz / 3 · 14 = 126 MHz; its oscillator runs at 8 · 126 MHz.
    rPLL #(
        .FCLKIN("27"),
        .DEVICE("GW2AR-18C"),
        .DYN_IDIV_SEL("false"),
        .IDIV_SEL(2),
        .DYN_FBDIV_SEL("false"),
        .FBDIV_SEL(13),
        .DYN_ODIV_SEL("false"),
        .ODIV_SEL(8),
        .PSDA_SEL("0000"),
        .DYN_DA_EN("false"),
        .DUTYDA_SEL("1000"),
        .CLKOUT_FT_DIR(1'b1),
        .CLKOUTP_FT_DIR(1'b1),
        .CLKOUT_DLY_STEP(0),
        .CLKOUTP_DLY_STEP(0),
        .CLKFB_SEL("internal"),
        .CLKOUT_BYPASS("false"),
        .CLKOUTP_BYPASS("false"),
        .CLKOUTD_BYPASS("false"),
        .DYN_SDIV_SEL(2),
        .CLKOUTD_SRC("CLKOUT"),
        .CLKOUTD3_SRC("CLKOUT")
    ) pll (
        .CLKIN(clk_27mhz),
        .CLKFB(1'b0),
        .RESET(1'b0),
        .RESET_P(1'b0),
        .FBDSEL(6'd0),
        .IDSEL(6'd0),
        .ODSEL(6'd0),
        .PSDA(4'd0),
        .DUTYDA(4'd0),
        .FDLY(4'd0),
        .CLKOUT(bit_clk),
        .LOCK(locked),
        .CLKOUTP(),
        .CLKOUTD(),
        .CLKOUTD3()
    );
    CLKDIV #(
        .DIV_MODE("5"),
        .GSREN("false")
    ) pixels (
        .HCLKIN(bit_clk),
        .RESETN(locked),
        .CALIB(1'b0),
        .CLKOUT(clk)
    );

    reg [3:0] reset = 4'd0;
    always @(posedge clk) if (!(&reset)) reset <= reset + {3'd0, locked};

    wire       hsync;
    wire       vsync;
    wire       visible;
    wire [7:0] red;
    wire [7:0] green;
    wire [7:0] blue;
    video video (
        .clk(clk),
        .rst_n(&reset),
        .hsync(hsync),
        .vsync(vsync),
        .visible(visible),
        .red(red),
        .green(green),
        .blue(blue)
    );

    wire [29:0] words;
    tmds encoders [2:0] (
        .clk(clk),
        .visible(visible),
        .colour({red, green, blue}),
        .control({4'b0000, vsync, hsync}),
        .word(words)
    );

    genvar pair;
    generate
        for (pair = 0; pair < 4; pair = pair + 1) begin : pairs
            wire [9:0] word;
            wire       serial;
            if (pair < 3) assign word = words[10*pair +: 10];
            else assign word = 10'b0000011111;
            OSER10 #(
                .GSREN("false"),
                .LSREN("true")
            ) serialiser (
                .PCLK(clk),
                .FCLK(bit_clk),
                .RESET(~locked),
                .D0(word[0]),
                .D1(word[1]),
                .D2(word[2]),
                .D3(word[3]),
                .D4(word[4]),
                .D5(word[5]),
                .D6(word[6]),
                .D7(word[7]),
                .D8(word[8]),
                .D9(word[9]),
                .Q(serial)
            );
            TLVDS_OBUF driver (
                .I(serial),
                .O(tmds_p[pair]),
                .OB(tmds_n[pair])
            );
        end
    endgenerate
endmodule

`default_nettype wire
